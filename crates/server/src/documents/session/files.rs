//! What lies on disk of an open machine: written, read again, and looked at. Knows when nothing may be written over.

use super::{FileLocation, Files, MachineSession, Tools, unwritten};
use crate::Failure;
use crate::documents::disk::{self, OnDisk};
use crate::documents::draft::{self, Draft, DraftHeader, DraftLine};
use crate::documents::operation::{EditRequest, Operation, RecordedOperation};
use crate::log;
use rafcon_protocol::api::DiskState;
use rafcon_storage::{Libraries, Saved};
use std::path::Path;

/// A save in another folder that is free for it, or in its own.
#[derive(Debug)]
pub(in crate::documents) struct Saving {
    /// Elsewhere, from now on.
    pub(in crate::documents) to: Option<FileLocation>,
    /// Also over what another program wrote there.
    pub(in crate::documents) overwrite: bool,
}

impl MachineSession {
    /// Writes the machine to its folder, or to another where it lies from then on.
    pub(in crate::documents) fn save(
        &self,
        saving: &Saving,
        tools: &Tools,
    ) -> Result<u64, Failure> {
        let _files = self.files.lock();
        self.must_be_open()?;
        let (revision, machine) = self.machine();
        let previous = self.previous(saving, tools)?;
        let folder = saving.to.as_ref().map_or_else(|| self.folder(), |spot| spot.folder.clone());
        let saved = disk::write(&machine, &folder, previous.as_ref(), tools.naming)?;
        let written = disk::read(&folder, &tools.libraries)?.ok_or_else(|| vanished(&folder))?;
        let mut draft = self.draft.lock();
        self.must_be_open()?;
        if let Some(spot) = &saving.to {
            self.move_to(&mut draft, spot)?;
        }
        let files = Files {
            saved,
            machine,
            revision,
            hash: written.hash,
            problems: written.problems,
            state: DiskState::Same,
        };
        self.on_disk(&mut draft, files);
        self.tell();
        Ok(revision)
    }

    /// Writes the machine to another folder, and nothing else; the revision that lies there.
    pub(in crate::documents) fn copy(
        &self,
        spot: &FileLocation,
        tools: &Tools,
    ) -> Result<u64, Failure> {
        let _files = self.files.lock();
        self.must_be_open()?;
        let (revision, machine) = self.machine();
        let saved = self.open.read().files.saved.clone();
        disk::write(&machine, &spot.folder, Some(&saved), tools.naming)?;
        Ok(revision)
    }

    /// What a save compares with; refused where it would write over what somebody else wrote.
    fn previous(&self, saving: &Saving, tools: &Tools) -> Result<Option<Saved>, Failure> {
        let (saved, hash, folder) = {
            let open = self.open.read();
            (open.files.saved.clone(), open.files.hash.clone(), open.folder.clone())
        };
        if saving.to.is_some() {
            return Ok(Some(saved));
        }
        let Some(now) = disk::read(&folder, &tools.libraries)? else { return Ok(None) };
        if now.hash == hash {
            return Ok(Some(saved));
        }
        if saving.overwrite {
            return Ok(None);
        }
        self.compared(now);
        Err(changed_on_disk(&folder))
    }

    /// The machine becomes what lies on disk: a step like any other.
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

    /// Looks at the files: whether another program changed them.
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

    /// What was read is what was read or written before, what is open, or something else.
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

    /// The files hold this now.
    fn on_disk(&self, draft: &mut Draft, files: Files) {
        let (revision, hash) = (files.revision, files.hash.clone());
        if !draft.is_begun() {
            let open = self.open.read();
            let head = DraftHeader::new(&open.folder, &hash, open.machine.revision());
            *draft = Draft::new(draft.place().to_owned(), head);
        } else if let Err(error) = draft.append(&DraftLine::Saved { revision, hash }) {
            // It is saved; a server that takes over from this one finds its edits once more.
            log::say(&error.to_string());
        }
        let mut open = self.open.write();
        open.files = files;
        open.is_recovered = false;
    }

    fn move_to(&self, draft: &mut Draft, spot: &FileLocation) -> Result<(), Failure> {
        draft.move_to(spot.draft.clone()).map_err(|error| unwritten(&error))?;
        let mut open = self.open.write();
        (open.folder, open.file) = (spot.folder.clone(), spot.file.clone());
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
