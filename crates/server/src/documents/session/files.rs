//! The files of an open machine: writes, reads and watches them. Knows when nothing may be overwritten.

use super::{FileLocation, Files, MachineSession, Tools, unwritten};
use crate::Failure;
use crate::documents::disk::{self, OnDisk};
use crate::documents::draft::{self, Draft, DraftHeader, DraftLine};
use crate::documents::operation::{EditRequest, Operation, RecordedOperation};
use crate::documents::set_aside;
use crate::log;
use rafcon_model::{Kind, Machine};
use rafcon_protocol::api::DiskState;
use rafcon_storage::{Libraries, Saved};
use std::collections::BTreeSet;
use std::path::Path;

/// A save to the machine's own folder, or to another one that is free.
#[derive(Debug)]
pub(in crate::documents) struct Saving {
    /// Another folder, which becomes the machine's own.
    pub(in crate::documents) to: Option<FileLocation>,
    /// True to overwrite changes of other programs.
    pub(in crate::documents) overwrite: bool,
}

/// State of the target folder before a save.
struct BeforeSave {
    saved: Option<Saved>,
    /// True if the files are the last ones that were loaded or written, without faults: a save without edits would write them again.
    is_known: bool,
}

impl MachineSession {
    /// Writes the machine to its folder, or moves it to another one.
    pub(in crate::documents) fn save(
        &self,
        saving: &Saving,
        tools: &Tools,
    ) -> Result<u64, Failure> {
        let _files = self.files.lock();
        self.must_be_open()?;
        let (revision, machine) = self.machine();
        let before = self.before(saving, tools)?;
        let reads_back = !before.is_known || self.brings_libraries(&machine);
        let folder =
            saving.to.as_ref().map_or_else(|| self.folder(), |location| location.folder.clone());
        let content = disk::content(&machine)?.0;
        self.announce_save(revision, &content);
        let saved = disk::write(&machine, &folder, before.saved.as_ref(), tools.naming)?;
        let (hash, problems) = if reads_back {
            let written =
                disk::read(&folder, &tools.libraries)?.ok_or_else(|| vanished(&folder))?;
            (written.hash, written.problems)
        } else {
            (content, Vec::new())
        };
        let mut draft = self.draft.lock();
        self.must_be_open()?;
        if let Some(location) = &saving.to {
            self.move_to(&mut draft, location)?;
        }
        let files = Files { saved, machine, revision, hash, problems, state: DiskState::Same };
        self.on_disk(&mut draft, files);
        self.tell();
        Ok(revision)
    }

    /// Records that a save begins: after a crash in the middle, the next server recognizes the files.
    fn announce_save(&self, revision: u64, hash: &str) {
        let mut draft = self.draft.lock();
        let line = DraftLine::Saving { revision, hash: hash.to_owned() };
        if draft.is_begun()
            && let Err(error) = draft.append(&line)
        {
            // A save must also work if the disk has no room for this line.
            log::say(&error.to_string());
        }
    }

    /// True if the machine has a library that was not loaded with the files.
    fn brings_libraries(&self, machine: &Machine) -> bool {
        !libraries_of(machine).is_subset(&libraries_of(&self.open.read().files.machine))
    }

    /// Writes a copy of the machine to another folder and returns the written revision.
    pub(in crate::documents) fn copy(
        &self,
        location: &FileLocation,
        tools: &Tools,
    ) -> Result<u64, Failure> {
        let _files = self.files.lock();
        self.must_be_open()?;
        let (revision, machine) = self.machine();
        let saved = self.open.read().files.saved.clone();
        disk::write(&machine, &location.folder, Some(&saved), tools.naming)?;
        Ok(revision)
    }

    /// The state of the folder before a save. Refuses to overwrite changes of another program.
    fn before(&self, saving: &Saving, tools: &Tools) -> Result<BeforeSave, Failure> {
        let unknown = |saved| Ok(BeforeSave { saved, is_known: false });
        let (saved, hash, folder) = {
            let open = self.open.read();
            (open.files.saved.clone(), open.files.hash.clone(), open.folder.clone())
        };
        if saving.to.is_some() {
            return unknown(Some(saved));
        }
        let Some(now) = disk::read(&folder, &tools.libraries)? else { return unknown(None) };
        if now.hash == hash {
            return Ok(BeforeSave { saved: Some(saved), is_known: now.problems.is_empty() });
        }
        if saving.overwrite {
            return unknown(None);
        }
        self.compared(now);
        Err(changed_on_disk(&folder))
    }

    /// Replaces the machine by its files, as a step that can be undone.
    pub(in crate::documents) fn reload(
        &self,
        request: EditRequest,
        tools: &Tools,
        at_ms: u64,
    ) -> Result<u64, Failure> {
        let _files = self.files.lock();
        if let Some(revision) = self.answered(&request) {
            return Ok(revision);
        }
        let folder = self.folder();
        let now = disk::read(&folder, &tools.libraries)?.ok_or_else(|| vanished(&folder))?;
        if self.is_already(&now) {
            self.compared(now);
            return Ok(self.machine().0);
        }
        let place = self.draft.lock().place().to_owned();
        draft::keep(&place, &now.hash, &now.document).map_err(|error| unwritten(&error))?;
        let operation = Operation::Replace { document: now.hash.clone() };
        let record = RecordedOperation { request, at_ms, operation };
        let revision =
            self.perform(record, Operation::Replace { document: now.machine.clone() })?;
        let mut draft = self.draft.lock();
        self.on_disk(&mut draft, now.into_files(revision));
        self.tell();
        Ok(revision)
    }

    fn is_already(&self, now: &OnDisk) -> bool {
        *self.open.read().machine.machine() == now.machine
    }

    /// Checks whether another program changed the files.
    pub(in crate::documents) fn look(&self, libraries: &Libraries) -> Result<(), Failure> {
        let _files = self.files.lock();
        let folder = self.folder();
        if let Some(now) = disk::read(&folder, libraries)? {
            self.compared(now);
        } else {
            let _draft = self.draft.lock();
            self.open.write().files.state = DiskState::Missing;
            self.tell();
        }
        Ok(())
    }

    /// Compares loaded files with the last known ones and with the open machine, and updates the status.
    fn compared(&self, now: OnDisk) {
        let mut draft = self.draft.lock();
        let (revision, state, is_the_same, is_open) = {
            let open = self.open.read();
            let is_the_same = now.hash == open.files.hash;
            let is_open = !is_the_same && now.machine == *open.machine.machine();
            (open.machine.revision(), open.files.state, is_the_same, is_open)
        };
        let found = if is_the_same { DiskState::Same } else { DiskState::Changed };
        if is_open {
            self.on_disk(&mut draft, now.into_files(revision));
        } else if found == state {
            return;
        } else {
            self.open.write().files.state = found;
        }
        self.tell();
    }

    /// Records the current content of the files.
    fn on_disk(&self, draft: &mut Draft, files: Files) {
        let (revision, hash) = (files.revision, files.hash.clone());
        if !draft.is_begun() {
            let open = self.open.read();
            let head = DraftHeader::new(&open.folder, &hash, open.machine.revision());
            *draft = Draft::new(draft.place().to_owned(), head);
        } else if let Err(error) = draft.append(&DraftLine::Saved { revision, hash }) {
            // The machine is saved. Without this line, the next server only replays its edits again.
            log::say(&error.to_string());
        }
        let mut open = self.open.write();
        open.files = files;
        open.is_recovered = false;
    }

    fn move_to(&self, draft: &mut Draft, location: &FileLocation) -> Result<(), Failure> {
        draft.move_to(location.draft.clone()).map_err(|error| unwritten(&error))?;
        let set_aside = set_aside::count(&location.draft);
        let mut open = self.open.write();
        (open.folder, open.file) = (location.folder.clone(), location.file.clone());
        open.set_aside = set_aside;
        Ok(())
    }
}

impl OnDisk {
    fn into_files(self, revision: u64) -> Files {
        Files {
            saved: self.saved,
            machine: self.machine,
            revision,
            hash: self.hash,
            problems: self.problems,
            state: DiskState::Same,
        }
    }
}

/// Path and name of all libraries that the machine uses.
fn libraries_of(machine: &Machine) -> BTreeSet<(&str, &str)> {
    let mut found = BTreeSet::new();
    let mut open = vec![&*machine.root];
    while let Some(state) = open.pop() {
        if let Kind::Library(library) = &state.kind {
            found.insert((library.path.as_str(), library.name.as_str()));
        }
        let children = state.container().into_iter().flat_map(|inside| inside.states.values());
        open.extend(children.map(|child| &**child));
    }
    found
}

pub(in crate::documents) fn vanished(folder: &Path) -> Failure {
    let message =
        format!("there is no machine in {} any more: save it to write it again", folder.display());
    Failure::conflict("machine_gone", message)
}

fn changed_on_disk(folder: &Path) -> Failure {
    let message = format!(
        "another program has changed the files in {}: reload them (which can be taken back), or save with `overwrite`",
        folder.display()
    );
    Failure::conflict("changed_on_disk", message)
}
