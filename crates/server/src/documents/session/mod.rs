//! One open machine with its folder, its draft and its viewers. Knows the order of writes and replies that keeps acknowledged
//! edits safe, but not the origin of requests.
//!
//! Three locks, taken in this order: `files` during reads and writes of files, while edits continue; `draft` while an edit is
//! performed and recorded; `open` only briefly, so that readers never wait for a disk.

mod files;

pub(super) use files::{Saving, vanished};

use super::broadcast::Broadcast;
use super::disk::{self, OnDisk};
use super::draft::{Draft, DraftLine};
use super::machine::OpenMachine;
use super::operation::{EditRequest, ReadOperation, RecordedOperation};
use super::recover::Recovered;
use super::revision_log::RevisionCache;
use super::revision_log::RevisionsPage;
use super::set_aside;
use crate::access::PrivateError;
use crate::{Failure, ServerState};
use axum::body::Bytes;
use rafcon_locks::{Mutex, RwLock};
use rafcon_model::Machine;
use rafcon_protocol::api::{
    DiskState, MachineFile, MachineProblem, MachineStatus, MachineSteps, MachineSummary, Presence,
};
use rafcon_storage::config::Naming;
use rafcon_storage::{Libraries, LoadProblem, Saved};
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::watch;

/// Session of an open machine.
#[derive(Debug)]
pub(crate) struct MachineSession {
    id: String,
    /// Time of opening: ms since 1970, UTC.
    opened: u64,
    /// Held while files are read or written.
    files: Mutex<()>,
    /// Held while an operation is performed and recorded. `open` changes only under this lock.
    draft: Mutex<Draft>,
    /// Held for writing only around code that does not block.
    open: RwLock<OpenFiles>,
    wires: Broadcast,
    document: RevisionCache<Bytes>,
    problems: RevisionCache<Arc<[MachineProblem]>>,
}

/// State of the open machine.
#[derive(Debug)]
struct OpenFiles {
    machine: OpenMachine,
    folder: PathBuf,
    file: MachineFile,
    files: Files,
    is_recovered: bool,
    /// Number of the folder's drafts that are set aside.
    set_aside: u64,
}

/// The files when they were last read or written.
#[derive(Debug)]
struct Files {
    saved: Saved,
    machine: Machine,
    revision: u64,
    hash: String,
    problems: Vec<LoadProblem>,
    state: DiskState,
}

/// Location of a machine.
#[derive(Debug, Clone)]
pub(super) struct FileLocation {
    pub(super) folder: PathBuf,
    pub(super) file: MachineFile,
    /// Folder for the draft.
    pub(super) draft: PathBuf,
}

/// Libraries and naming for reading and writing files.
#[derive(Debug)]
pub(super) struct Tools {
    pub(super) libraries: Arc<Libraries>,
    pub(super) naming: Naming,
}

impl MachineSession {
    /// A session with a loaded machine and the edits of its draft.
    pub(super) fn new(
        id: String,
        location: FileLocation,
        on_disk: OnDisk,
        recovered: Recovered,
        opened: u64,
    ) -> Self {
        let Recovered { machine, draft, saved_revision, has_edits, hash } = recovered;
        let is_changed = hash != on_disk.hash;
        let revision = machine.revision();
        // The client that opens the machine requests the document next.
        let is_saved = !is_changed && revision == saved_revision;
        let is_on_disk = is_saved || *machine.machine() == on_disk.machine;
        let document = is_on_disk.then(|| (revision, whole(revision, &on_disk.document)));
        let files = Files {
            saved: on_disk.saved,
            machine: on_disk.machine,
            revision: saved_revision,
            hash,
            problems: on_disk.problems,
            state: if is_changed { DiskState::Changed } else { DiskState::Same },
        };
        let set_aside = set_aside::count(&location.draft);
        let (folder, file) = (location.folder, location.file);
        let open = OpenFiles { machine, folder, file, files, is_recovered: has_edits, set_aside };
        Self {
            opened,
            files: Mutex::default(),
            draft: Mutex::new(draft),
            wires: Broadcast::new(open.summary(&id)),
            open: RwLock::new(open),
            document: RevisionCache::new(document),
            problems: RevisionCache::new(None),
            id,
        }
    }

    /// Id of the session.
    pub(super) fn id(&self) -> &str {
        &self.id
    }

    /// Time of opening: ms since 1970, UTC.
    pub(super) fn opened(&self) -> u64 {
        self.opened
    }

    /// Folder of the machine.
    pub(super) fn folder(&self) -> PathBuf {
        self.open.read().folder.clone()
    }

    /// Its summary. Fails once the machine is closed.
    pub(super) fn summary(&self) -> Result<MachineSummary, Failure> {
        self.wires.summary().ok_or_else(|| closed(&self.id))
    }

    /// The current machine and its revision.
    pub(super) fn machine(&self) -> (u64, Machine) {
        let open = self.open.read();
        (open.machine.revision(), open.machine.machine().clone())
    }

    /// Revisions that a reader has not seen yet; `from` is the first.
    pub(crate) fn since(&self, from: u64) -> RevisionsPage {
        self.open.read().machine.since(from)
    }

    /// History since the load.
    pub(super) fn steps(&self) -> MachineSteps {
        self.open.read().machine.steps()
    }

    /// Receiver of its status. Fails once the machine is closed.
    pub(crate) fn status(&self) -> Result<watch::Receiver<MachineStatus>, Failure> {
        self.wires.status().ok_or_else(|| closed(&self.id))
    }

    /// Receiver of its last revision. Fails once the machine is closed.
    pub(crate) fn revisions(&self) -> Result<watch::Receiver<u64>, Failure> {
        self.wires.revisions().ok_or_else(|| closed(&self.id))
    }

    /// The folder for its draft.
    pub(super) fn draft_place(&self) -> PathBuf {
        self.draft.lock().place().to_owned()
    }

    /// Counts the drafts that are set aside.
    pub(super) fn count_set_aside(&self) {
        let draft = self.draft.lock();
        let count = set_aside::count(draft.place());
        self.open.write().set_aside = count;
        self.tell();
    }

    fn must_be_open(&self) -> Result<(), Failure> {
        if self.wires.is_open() { Ok(()) } else { Err(closed(&self.id)) }
    }

    /// Publishes the current status. Call it before the draft is unlocked, so that reports keep their order.
    fn tell(&self) {
        let mut summary = self.open.read().summary(&self.id);
        if summary.is_recovered && !summary.is_changed {
            // The recovered edits were undone, so later edits are not recovered ones.
            summary.is_recovered = false;
            self.open.write().is_recovered = false;
        }
        self.wires.tell(summary);
    }

    /// Records and performs an operation, once per request. `read` is the operation with its loaded contents.
    pub(super) fn perform(
        &self,
        record: RecordedOperation,
        read: ReadOperation,
    ) -> Result<u64, Failure> {
        let mut draft = self.draft.lock();
        if let Some(revision) = self.answered(&record.request) {
            return Ok(revision);
        }
        self.must_be_open()?;
        let (request, at_ms) = (record.request.clone(), record.at_ms);
        let prepared = self.open.read().machine.prepare(request, at_ms, read)?;
        self.write_down(&mut draft, &DraftLine::Done(Box::new(record)))?;
        let revision = self.open.write().machine.commit(prepared);
        self.tell();
        Ok(revision)
    }

    fn answered(&self, request: &EditRequest) -> Option<u64> {
        self.open.read().machine.answered(request)
    }

    /// Closes it and deletes its draft. Refuses to lose unsaved edits without `discard`.
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

    /// Closes it if it is saved, idle and without followers. Returns `true` if it did. Its draft keeps the acknowledged requests.
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

    /// Faults of its files at the last load, broken rules, problems of scripts, and changed libraries.
    pub(super) fn problems(&self, server: &ServerState) -> Result<Vec<MachineProblem>, Failure> {
        let (revision, machine) = self.machine();
        let rules = self.problems.of(revision, || Ok(super::problems::rules(&machine).into()))?;
        let files = super::problems::files(&self.open.read().files.problems);
        let scripts = super::problems::scripts(&machine, server);
        let changed = super::problems::of_libraries(&machine, &server.projects.libraries());
        let rules = rules.iter().cloned();
        Ok(files.into_iter().chain(rules).chain(scripts).chain(changed).collect())
    }

    /// Sets the states that a connection shows.
    pub(super) fn looks(&self, presence: Presence) {
        self.wires.looks(presence);
    }

    /// Removes a connection from the viewers.
    pub(super) fn leaves(&self, connection: u64) {
        self.wires.leaves(connection);
    }

    /// Appends a line to the draft. Writes the base document first, because the machine's files may change before the draft is replayed.
    fn write_down(&self, draft: &mut Draft, line: &DraftLine) -> Result<(), Failure> {
        if !draft.is_begun() {
            // No operation was performed yet, so this is the loaded document. Opening has cached its JSON.
            let whole = self.document()?;
            draft.begin(document_of(&whole)).map_err(|error| unwritten(&error))?;
        }
        draft.append(line).map_err(|error| unwritten(&error))
    }
}

/// A [`rafcon_protocol::api::MachineDocument`] as JSON.
fn whole(revision: u64, document: &[u8]) -> Bytes {
    let head = format!(r#"{{"revision":{revision},"document":"#);
    [head.as_bytes(), document, b"}"].concat().into()
}

/// The document part of the output of [`whole`].
fn document_of(whole: &[u8]) -> &[u8] {
    let key = b"\"document\":";
    let begin =
        whole.windows(key.len()).position(|part| part == key).map_or(0, |at| at + key.len());
    &whole[begin..whole.len().saturating_sub(1)]
}

impl OpenFiles {
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
            set_aside: self.set_aside,
        }
    }
}

/// Refusal: no machine with this id is open.
pub(super) fn closed(id: &str) -> Failure {
    let message = format!("no machine `{id}` is open: POST /api/v1/machines/open opens one");
    Failure::not_found("no_such_machine", message)
}

fn unwritten(error: &PrivateError) -> Failure {
    let message = format!(
        "nothing was done, because it could not be written down: {error}; {}",
        error.remedy()
    );
    Failure::unavailable("not_written_down", message)
}
