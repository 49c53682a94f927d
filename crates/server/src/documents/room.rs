//! One open machine with its folder, its draft and the people who look at it. Knows in which order things are done so that
//! nothing that was answered gets lost; must never know how requests arrive.
//!
//! Three locks, taken in this order. That of the files is held while they are read or written, and edits go on meanwhile; that
//! of the draft while an edit is made and written down; that of what is open for a moment only, so that whoever must not wait
//! for a disk may look.

use super::disk::{self, OnDisk};
use super::draft::{self, Draft, Head, Line, Operation, What};
use super::kept::Kept;
use super::log::Page;
use super::machine::{Deed, OpenMachine, Request};
use super::recover::Recovered;
use super::wires::Wires;
use crate::access::PrivateError;
use crate::{Failure, log};
use axum::body::Bytes;
use axum::http::StatusCode;
use parking_lot::{Mutex, RwLock};
use rafcon_model::Machine;
use rafcon_protocol::api::{
    DiskState, MachineFile, MachineProblem, MachineStatus, MachineSteps, MachineSummary, Presence,
};
use rafcon_storage::config::Naming;
use rafcon_storage::{Libraries, LoadProblem, Saved};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use tokio::sync::watch;

/// One open machine.
#[derive(Debug)]
pub(crate) struct Room {
    id: String,
    /// ms since 1970, UTC.
    opened: u64,
    /// Held while files are read or written.
    files: Mutex<()>,
    /// Held while something is done and written down: what is open changes under it only.
    draft: Mutex<Draft>,
    /// Held for writing only where nothing is waited for.
    open: RwLock<Open>,
    wires: Wires,
    document: Kept<Bytes>,
    problems: Kept<Arc<[MachineProblem]>>,
}

/// What is open.
#[derive(Debug)]
struct Open {
    machine: OpenMachine,
    folder: PathBuf,
    file: MachineFile,
    files: Files,
    is_recovered: bool,
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
    pub(super) libraries: Arc<Libraries>,
    pub(super) naming: Naming,
}

/// A save in another folder that is free for it, or in its own.
#[derive(Debug)]
pub(super) struct Saving {
    /// Elsewhere, from now on.
    pub(super) to: Option<Spot>,
    /// Also over what another program wrote there.
    pub(super) overwrite: bool,
}

impl Room {
    /// The machine that was read, with what a draft added to it.
    pub(super) fn new(
        id: String,
        spot: Spot,
        on_disk: OnDisk,
        recovered: Recovered,
        opened: u64,
    ) -> Self {
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
        let (folder, file) = (spot.folder, spot.file);
        let open = Open { machine, folder, file, files, is_recovered: has_edits };
        Self {
            opened,
            files: Mutex::default(),
            draft: Mutex::new(draft),
            wires: Wires::new(open.summary(&id)),
            open: RwLock::new(open),
            document: Kept::new(document),
            problems: Kept::new(None),
            id,
        }
    }

    /// Its name.
    pub(super) fn id(&self) -> &str {
        &self.id
    }

    /// Since when it is open: ms since 1970, UTC.
    pub(super) fn opened(&self) -> u64 {
        self.opened
    }

    /// Where it lies.
    pub(super) fn folder(&self) -> PathBuf {
        self.open.read().folder.clone()
    }

    /// In one line, as long as it is open.
    pub(super) fn summary(&self) -> Result<MachineSummary, Failure> {
        self.wires.summary().ok_or_else(|| closed(&self.id))
    }

    /// The machine as it is now, and its revision.
    pub(super) fn machine(&self) -> (u64, Machine) {
        let open = self.open.read();
        (open.machine.revision(), open.machine.machine().clone())
    }

    /// What a reader has not seen whose next revision is `from`.
    pub(crate) fn since(&self, from: u64) -> Page {
        self.open.read().machine.since(from)
    }

    /// What was done to it since it was read.
    pub(super) fn steps(&self) -> MachineSteps {
        self.open.read().machine.steps()
    }

    /// The latest truth, as long as it is open.
    pub(crate) fn status(&self) -> Result<watch::Receiver<MachineStatus>, Failure> {
        self.wires.status().ok_or_else(|| closed(&self.id))
    }

    /// The number of the last revision, as long as it is open.
    pub(crate) fn revisions(&self) -> Result<watch::Receiver<u64>, Failure> {
        self.wires.revisions().ok_or_else(|| closed(&self.id))
    }

    fn must_be_open(&self) -> Result<(), Failure> {
        if self.wires.is_open() { Ok(()) } else { Err(closed(&self.id)) }
    }

    /// Tells how it stands now. To be called before the draft is let go, so that what is told last is the latest.
    fn tell(&self) {
        let summary = self.open.read().summary(&self.id);
        self.wires.tell(summary);
    }

    /// Does it, once for each request, and only when it is written down.
    pub(super) fn perform(
        &self,
        request: Request,
        deed: Deed,
        what: What,
        at_ms: u64,
    ) -> Result<u64, Failure> {
        let mut draft = self.draft.lock();
        if let Some(revision) = self.answered(&request) {
            return Ok(revision);
        }
        self.must_be_open()?;
        let prepared = self.open.read().machine.prepare(&request.author, deed)?;
        let Request { author, id } = request.clone();
        let operation = Operation { author, id, at_ms, what };
        self.write_down(&mut draft, &Line::Done(Box::new(operation)))?;
        let revision = self.open.write().machine.commit(prepared, request, at_ms);
        self.tell();
        Ok(revision)
    }

    fn answered(&self, request: &Request) -> Option<u64> {
        self.open.read().machine.answered(request)
    }

    /// Writes the machine to its folder, or to another where it lies from then on.
    pub(super) fn save(&self, saving: &Saving, tools: &Tools) -> Result<u64, Failure> {
        let _files = self.files.lock();
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
    pub(super) fn copy(&self, spot: &Spot, tools: &Tools) -> Result<u64, Failure> {
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
    pub(super) fn reload(
        &self,
        request: Request,
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
        let what = What::Replace { document: now.hash.clone() };
        let revision =
            self.perform(request, Deed::Replace(Box::new(now.machine.clone())), what, at_ms)?;
        let mut draft = self.draft.lock();
        self.on_disk(&mut draft, now.into_files(revision));
        self.tell();
        Ok(revision)
    }

    fn is_already(&self, now: &OnDisk) -> bool {
        *self.open.read().machine.machine() == now.machine
    }

    /// Looks at the files: whether another program changed them.
    pub(super) fn look(&self, libraries: &Libraries) -> Result<(), Failure> {
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

    /// Closes it, with its draft; refused if there is something to lose.
    pub(super) fn close(&self, discard: bool) -> Result<(), Failure> {
        let _files = self.files.lock();
        let mut draft = self.draft.lock();
        self.must_be_open()?;
        if self.open.read().is_changed() && !discard {
            let message = format!(
                "{} has edits that do not lie on disk: save it first, or close it with `discard`",
                self.folder().display()
            );
            return Err(Failure::conflict("unsaved", message));
        }
        draft.discard().map_err(|error| unwritten(&error))?;
        self.wires.close();
        Ok(())
    }

    /// Closes it, if nobody is at work on it, follows it or would miss anything. What was answered stays known by its draft.
    pub(super) fn retire(&self) -> bool {
        let (Some(_files), Some(_draft)) = (self.files.try_lock(), self.draft.try_lock()) else {
            return false;
        };
        !self.open.read().is_changed() && self.wires.close_unless_followed()
    }

    /// The whole machine and its revision, as JSON.
    pub(super) fn document(&self) -> Result<Bytes, Failure> {
        let (revision, machine) = self.machine();
        self.document.of(revision, || Ok(whole(revision, &disk::content(&machine)?.1)))
    }

    /// Rules that it breaks, faults of its files as they were read last, and libraries that have changed.
    pub(super) fn problems(&self, libraries: &Libraries) -> Result<Vec<MachineProblem>, Failure> {
        let (revision, machine) = self.machine();
        let rules =
            self.problems.of(revision, || Ok(super::problems::of_machine(&machine).into()))?;
        let open = self.open.read();
        let files: Vec<_> =
            open.files.problems.iter().filter_map(super::problems::of_file).collect();
        drop(open);
        let changed = super::problems::of_libraries(&machine, libraries);
        Ok(files.into_iter().chain(rules.iter().cloned()).chain(changed).collect())
    }

    /// Somebody looks at these states.
    pub(super) fn looks(&self, presence: Presence) {
        self.wires.looks(presence);
    }

    /// Somebody looks elsewhere.
    pub(super) fn leaves(&self, connection: u64) {
        self.wires.leaves(connection);
    }

    /// A line of the draft. With the first one, what the draft begins with is kept as well; nobody waits for that: as long as
    /// the files are what they are, they do.
    fn write_down(&self, draft: &mut Draft, line: &Line) -> Result<(), Failure> {
        let is_first = !draft.is_begun();
        draft.append(line).map_err(|error| unwritten(&error))?;
        if is_first {
            self.keep_base(draft);
        }
        Ok(())
    }

    fn keep_base(&self, draft: &Draft) {
        let (place, base) = (draft.place().to_owned(), draft.base().to_owned());
        let machine = self.open.read().files.machine.clone();
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
    fn on_disk(&self, draft: &mut Draft, files: Files) {
        let (revision, hash) = (files.revision, files.hash.clone());
        if !draft.is_begun() {
            let open = self.open.read();
            let head = Head::new(&open.folder, &hash, open.machine.revision());
            *draft = Draft::new(draft.place().to_owned(), head);
        } else if let Err(error) = draft.append(&Line::Saved { revision, hash }) {
            // It is saved; a server that takes over from this one finds its edits once more.
            log::say(&error.to_string());
        }
        let mut open = self.open.write();
        open.files = files;
        open.is_recovered = false;
    }

    fn move_to(&self, draft: &mut Draft, spot: &Spot) -> Result<(), Failure> {
        draft.move_to(spot.draft.clone()).map_err(|error| unwritten(&error))?;
        let mut open = self.open.write();
        (open.folder, open.file) = (spot.folder.clone(), spot.file.clone());
        Ok(())
    }
}

/// A [`rafcon_protocol::api::MachineDocument`] as JSON.
fn whole(revision: u64, document: &[u8]) -> Bytes {
    let head = format!(r#"{{"revision":{revision},"document":"#);
    [head.as_bytes(), document, b"}"].concat().into()
}

impl Open {
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

pub(super) fn vanished(folder: &Path) -> Failure {
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
