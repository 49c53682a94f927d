//! One open machine with its folder, its draft and the people who look at it. Knows in which order things are done so that
//! nothing that was answered gets lost; must never know how requests arrive.
//!
//! Two locks: that of what is open is held for a moment only; that of the files is held while they are read or written, and
//! edits go on meanwhile.

use super::disk::{self, OnDisk};
use super::draft::{self, Draft, Head, Line, Operation, What};
use super::log::Page;
use super::machine::{Deed, OpenMachine, Request};
use super::recover::Recovered;
use crate::access::PrivateError;
use crate::{Failure, log};
use axum::body::Bytes;
use axum::http::StatusCode;
use parking_lot::Mutex;
use rafcon_model::Machine;
use rafcon_protocol::api::{
    DiskState, MachineFile, MachineProblem, MachineStatus, MachineSummary, Presence,
};
use rafcon_storage::config::Naming;
use rafcon_storage::{Libraries, LoadProblem, Saved};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::thread;
use tokio::sync::watch;

/// One open machine.
#[derive(Debug)]
pub(crate) struct Room {
    id: String,
    open: Mutex<Open>,
    /// Held while files are read or written.
    files: Mutex<()>,
    /// The document of a revision, for all who ask for it.
    document: Mutex<Option<(u64, Bytes)>>,
}

/// What is open.
#[derive(Debug)]
struct Open {
    machine: OpenMachine,
    folder: PathBuf,
    file: MachineFile,
    draft: Draft,
    files: Files,
    is_recovered: bool,
    people: BTreeMap<u64, Presence>,
    /// Nothing once it is closed.
    wires: Option<Wires>,
}

/// The files as they were read or written last.
#[derive(Debug)]
struct Files {
    saved: Saved,
    machine: Machine,
    revision: u64,
    hash: String,
    problems: Vec<LoadProblem>,
    state: DiskState,
}

/// Whom to wake.
#[derive(Debug)]
struct Wires {
    status: watch::Sender<MachineStatus>,
    revision: watch::Sender<u64>,
}

/// Where a machine lies.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    pub(super) folder: PathBuf,
    pub(super) file: MachineFile,
    /// Where its draft belongs.
    pub(super) draft: PathBuf,
}

/// What files are read and written with.
#[derive(Debug)]
pub(super) struct Tools {
    pub(super) libraries: std::sync::Arc<Libraries>,
    pub(super) naming: Naming,
}

/// A save in another folder, or in its own.
#[derive(Debug)]
pub(super) struct Saving {
    /// Elsewhere, from now on.
    pub(super) to: Option<Spot>,
    /// Also over what another program wrote there.
    pub(super) overwrite: bool,
}

impl Room {
    /// The machine that was read, with what a draft added to it.
    pub(super) fn new(id: String, spot: Spot, on_disk: OnDisk, recovered: Recovered) -> Self {
        let Recovered { machine, draft, saved_revision, has_edits, hash } = recovered;
        let is_changed = hash != on_disk.hash;
        let revision = machine.revision();
        // Who opens it asks for it next.
        let document = (!has_edits).then(|| (revision, whole(revision, &on_disk.document)));
        let files = Files {
            saved: on_disk.saved,
            machine: on_disk.machine,
            revision: saved_revision,
            hash,
            problems: on_disk.problems,
            state: if is_changed { DiskState::Changed } else { DiskState::Same },
        };
        let mut open = Open {
            machine,
            folder: spot.folder,
            file: spot.file,
            draft,
            files,
            is_recovered: has_edits,
            people: BTreeMap::new(),
            wires: None,
        };
        let status = watch::Sender::new(open.status(&id));
        let revision = watch::Sender::new(open.machine.revision());
        open.wires = Some(Wires { status, revision });
        let document = Mutex::new(document);
        Self { id, open: Mutex::new(open), files: Mutex::default(), document }
    }

    /// Where it lies.
    pub(super) fn folder(&self) -> PathBuf {
        self.open.lock().folder.clone()
    }

    /// In one line.
    pub(super) fn summary(&self) -> MachineSummary {
        self.open.lock().summary(&self.id)
    }

    /// The machine as it is now, and its revision.
    pub(super) fn machine(&self) -> (u64, Machine) {
        let open = self.open.lock();
        (open.machine.revision(), open.machine.machine().clone())
    }

    /// What a reader has not seen whose next revision is `from`.
    pub(crate) fn since(&self, from: u64) -> Page {
        self.open.lock().machine.since(from)
    }

    /// The latest truth, as long as it is open.
    pub(crate) fn status(&self) -> Result<watch::Receiver<MachineStatus>, Failure> {
        let open = self.open.lock();
        let wires = open.wires.as_ref().ok_or_else(|| closed(&self.id))?;
        Ok(wires.status.subscribe())
    }

    /// The number of the last revision, as long as it is open.
    pub(crate) fn revisions(&self) -> Result<watch::Receiver<u64>, Failure> {
        let open = self.open.lock();
        let wires = open.wires.as_ref().ok_or_else(|| closed(&self.id))?;
        Ok(wires.revision.subscribe())
    }

    /// Does it, once for each request, and only when it is written down.
    pub(super) fn perform(
        &self,
        request: Request,
        deed: Deed,
        what: What,
        at_ms: u64,
    ) -> Result<u64, Failure> {
        let mut open = self.open.lock();
        if let Some(revision) = open.machine.answered(&request) {
            return Ok(revision);
        }
        let prepared = open.open(&self.id)?.machine.prepare(&request.author, deed)?;
        let Request { author, id } = request.clone();
        let operation = Operation { author, id, at_ms, what };
        open.write_down(&Line::Done(Box::new(operation)))?;
        let revision = open.machine.commit(prepared, request, at_ms);
        open.tell(&self.id);
        Ok(revision)
    }

    /// Writes the machine to its folder, or to another where it lies from then on.
    pub(super) fn save(&self, saving: &Saving, tools: &Tools) -> Result<u64, Failure> {
        let _files = self.files.lock();
        let (revision, machine) = self.machine();
        let previous = self.previous(saving, tools)?;
        let folder = saving.to.as_ref().map_or_else(|| self.folder(), |spot| spot.folder.clone());
        let saved = disk::write(&machine, &folder, previous.as_ref(), tools.naming)?;
        let written = disk::read(&folder, &tools.libraries)?.ok_or_else(|| vanished(&folder))?;
        let mut open = self.open.lock();
        open.open(&self.id)?;
        if let Some(spot) = &saving.to {
            open.move_to(spot)?;
        }
        let files = Files {
            saved,
            machine,
            revision,
            hash: written.hash,
            problems: written.problems,
            state: DiskState::Same,
        };
        open.on_disk(files);
        open.tell(&self.id);
        Ok(revision)
    }

    /// What a save compares with; refused where it would write over what somebody else wrote.
    fn previous(&self, saving: &Saving, tools: &Tools) -> Result<Option<Saved>, Failure> {
        let (saved, hash, folder) = {
            let open = self.open.lock();
            (open.files.saved.clone(), open.files.hash.clone(), open.folder.clone())
        };
        if let Some(spot) = &saving.to {
            let is_free = saving.overwrite || !spot.folder.exists();
            return if is_free { Ok(Some(saved)) } else { Err(in_the_way(&spot.folder)) };
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
    pub(super) fn reload(
        &self,
        request: Request,
        tools: &Tools,
        at_ms: u64,
    ) -> Result<u64, Failure> {
        let _files = self.files.lock();
        if let Some(revision) = self.open.lock().machine.answered(&request) {
            return Ok(revision);
        }
        let folder = self.folder();
        let now = disk::read(&folder, &tools.libraries)?.ok_or_else(|| vanished(&folder))?;
        if self.is_already(&now) {
            self.compared(now);
            return Ok(self.machine().0);
        }
        let place = self.open.lock().draft.place().to_owned();
        draft::keep(&place, &now.hash, &now.document).map_err(|error| unwritten(&error))?;
        let what = What::Replace { document: now.hash.clone() };
        let revision =
            self.perform(request, Deed::Replace(Box::new(now.machine.clone())), what, at_ms)?;
        let mut open = self.open.lock();
        open.on_disk(now.into_files(revision));
        open.tell(&self.id);
        Ok(revision)
    }

    fn is_already(&self, now: &OnDisk) -> bool {
        *self.open.lock().machine.machine() == now.machine
    }

    /// Looks at the files: whether another program changed them.
    pub(super) fn look(&self, libraries: &Libraries) -> Result<(), Failure> {
        let _files = self.files.lock();
        let folder = self.folder();
        if let Some(now) = disk::read(&folder, libraries)? {
            self.compared(now);
        } else {
            let mut open = self.open.lock();
            open.files.state = DiskState::Missing;
            open.tell(&self.id);
        }
        Ok(())
    }

    /// What was read is what was read or written before, what is open, or something else.
    fn compared(&self, now: OnDisk) {
        let mut open = self.open.lock();
        let revision = open.machine.revision();
        let is_the_same = now.hash == open.files.hash;
        if !is_the_same && now.machine == *open.machine.machine() {
            open.on_disk(now.into_files(revision));
        } else {
            let state = if is_the_same { DiskState::Same } else { DiskState::Changed };
            if open.files.state == state {
                return;
            }
            open.files.state = state;
        }
        open.tell(&self.id);
    }

    /// Closes it, with its draft; refused if there is something to lose.
    pub(super) fn close(&self, discard: bool) -> Result<(), Failure> {
        let _files = self.files.lock();
        let mut open = self.open.lock();
        open.open(&self.id)?;
        if open.is_changed() && !discard {
            let message = format!(
                "{} has edits that do not lie on disk: save it first, or close it with `discard`",
                open.folder.display()
            );
            return Err(Failure::conflict("unsaved", message));
        }
        open.draft.discard().map_err(|error| unwritten(&error))?;
        open.wires = None;
        Ok(())
    }

    /// The whole machine and its revision, as JSON.
    pub(super) fn document(&self) -> Result<Bytes, Failure> {
        let (revision, machine) = self.machine();
        if let Some((kept, document)) = &*self.document.lock()
            && *kept == revision
        {
            return Ok(document.clone());
        }
        let (_, document) = disk::content(&machine)?;
        let text = whole(revision, &document);
        *self.document.lock() = Some((revision, text.clone()));
        Ok(text)
    }

    /// Faults of the files, as they were read last.
    pub(super) fn faults_of_files(&self) -> Vec<MachineProblem> {
        let open = self.open.lock();
        open.files.problems.iter().map(super::problems::of_file).collect()
    }

    /// Somebody looks at these states.
    pub(super) fn looks(&self, presence: Presence) {
        let mut open = self.open.lock();
        open.people.insert(presence.connection, presence);
        open.tell(&self.id);
    }

    /// Somebody looks elsewhere.
    pub(super) fn leaves(&self, connection: u64) {
        let mut open = self.open.lock();
        if open.people.remove(&connection).is_some() {
            open.tell(&self.id);
        }
    }
}

/// A [`rafcon_protocol::api::MachineDocument`] as JSON.
fn whole(revision: u64, document: &[u8]) -> Bytes {
    let head = format!(r#"{{"revision":{revision},"document":"#);
    [head.as_bytes(), document, b"}"].concat().into()
}

impl Open {
    fn open(&self, id: &str) -> Result<&Self, Failure> {
        if self.wires.is_some() { Ok(self) } else { Err(closed(id)) }
    }

    fn is_changed(&self) -> bool {
        self.machine.revision() != self.files.revision
            && *self.machine.machine() != self.files.machine
    }

    fn summary(&self, id: &str) -> MachineSummary {
        MachineSummary {
            id: id.to_owned(),
            file: Some(self.file.clone()),
            name: self.machine.machine().root.name.to_string(),
            revision: self.machine.revision(),
            saved_revision: self.files.revision,
            is_changed: self.is_changed(),
            disk: self.files.state,
            is_recovered: self.is_recovered,
        }
    }

    fn status(&self, id: &str) -> MachineStatus {
        let people = self.people.values().cloned().collect();
        MachineStatus { summary: self.summary(id), people }
    }

    /// Wakes whoever follows.
    fn tell(&self, id: &str) {
        if let Some(wires) = &self.wires {
            wires.status.send_replace(self.status(id));
            wires.revision.send_replace(self.machine.revision());
        }
    }

    /// A line of the draft. With the first one, what the draft begins with is kept as well; nobody waits for that: as long as
    /// the files are what they are, they do.
    fn write_down(&mut self, line: &Line) -> Result<(), Failure> {
        let is_first = !self.draft.is_begun();
        self.draft.append(line).map_err(|error| unwritten(&error))?;
        if is_first {
            self.keep_base();
        }
        Ok(())
    }

    fn keep_base(&self) {
        let (place, base) = (self.draft.place().to_owned(), self.draft.base().to_owned());
        let machine = self.files.machine.clone();
        let keep = move || {
            let kept = disk::content(&machine).map(|(_, document)| {
                draft::keep(&place, &base, &document).map_err(|error| log::say(&error.to_string()))
            });
            if let Err(failure) = kept {
                log::say(&failure.to_string());
            }
        };
        if let Err(error) = thread::Builder::new().name("draft".to_owned()).spawn(keep) {
            log::say(&format!("no thread to keep what a draft begins with: {error}"));
        }
    }

    /// The files hold this now.
    fn on_disk(&mut self, files: Files) {
        let (revision, hash) = (files.revision, files.hash.clone());
        self.files = files;
        self.is_recovered = false;
        if !self.draft.is_begun() {
            let head = Head::new(&self.folder, &hash, self.machine.revision());
            self.draft = Draft::new(self.draft.place().to_owned(), head);
        } else if let Err(error) = self.draft.append(&Line::Saved { revision, hash }) {
            // It is saved; a server that takes over from this one finds its edits once more.
            log::say(&error.to_string());
        }
    }

    fn move_to(&mut self, spot: &Spot) -> Result<(), Failure> {
        self.draft.move_to(spot.draft.clone()).map_err(|error| unwritten(&error))?;
        (self.folder, self.file) = (spot.folder.clone(), spot.file.clone());
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

/// No machine of this name is open.
pub(super) fn closed(id: &str) -> Failure {
    let message = format!("no machine `{id}` is open: POST /api/v1/machines/open opens one");
    Failure::not_found("no_such_machine", message)
}

fn unwritten(error: &PrivateError) -> Failure {
    let message =
        format!("nothing was done, for it could not be written down: {error}; make room there");
    Failure::new(StatusCode::SERVICE_UNAVAILABLE, "not_written_down", message)
}

fn vanished(folder: &Path) -> Failure {
    let message =
        format!("there is no machine in {} any more: save it to write it again", folder.display());
    Failure::conflict("machine_gone", message)
}

fn in_the_way(folder: &Path) -> Failure {
    let message =
        format!("{} exists: choose another folder, or save with `overwrite`", folder.display());
    Failure::conflict("folder_exists", message)
}

fn changed_on_disk(folder: &Path) -> Failure {
    let message = format!(
        "another program has changed the files in {}: reload them (which can be taken back), or save with `overwrite`",
        folder.display()
    );
    Failure::conflict("changed_on_disk", message)
}
