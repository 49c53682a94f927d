//! One open machine with its folder, its draft and the people who look at it. Knows in which order things are done so that
//! nothing that was answered gets lost, but not how requests arrive.
//!
//! Three locks, taken in this order. That of the files is held while they are read or written, and edits continue meanwhile; that
//! of the draft while an edit is made and written down; that of what is open for a moment only, so that whoever must not wait
//! for a disk may look.

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

/// One open machine.
#[derive(Debug)]
pub(crate) struct MachineSession {
    id: String,
    /// ms since 1970, UTC.
    opened: u64,
    /// Held while files are read or written.
    files: Mutex<()>,
    /// Held while an operation is performed and written down: what is open changes under it only.
    draft: Mutex<Draft>,
    /// Held for writing only where nothing blocks.
    open: RwLock<OpenFiles>,
    wires: Broadcast,
    document: RevisionCache<Bytes>,
    problems: RevisionCache<Arc<[MachineProblem]>>,
}

/// What is open.
#[derive(Debug)]
struct OpenFiles {
    machine: OpenMachine,
    folder: PathBuf,
    file: MachineFile,
    files: Files,
    is_recovered: bool,
    /// Drafts of the folder that are set aside.
    set_aside: u64,
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
pub(super) struct FileLocation {
    pub(super) folder: PathBuf,
    pub(super) file: MachineFile,
    /// The folder of its draft.
    pub(super) draft: PathBuf,
}

/// What files are read and written with.
#[derive(Debug)]
pub(super) struct Tools {
    pub(super) libraries: Arc<Libraries>,
    pub(super) naming: Naming,
}

impl MachineSession {
    /// The machine that was read, with what a draft added to it.
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
        // The client that opens it requests it next.
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

    /// Its name.
    pub(super) fn id(&self) -> &str {
        &self.id
    }

    /// When it was opened: ms since 1970, UTC.
    pub(super) fn opened(&self) -> u64 {
        self.opened
    }

    /// Its folder.
    pub(super) fn folder(&self) -> PathBuf {
        self.open.read().folder.clone()
    }

    /// Its summary, as long as it is open.
    pub(super) fn summary(&self) -> Result<MachineSummary, Failure> {
        self.wires.summary().ok_or_else(|| closed(&self.id))
    }

    /// The machine as it is now, and its revision.
    pub(super) fn machine(&self) -> (u64, Machine) {
        let open = self.open.read();
        (open.machine.revision(), open.machine.machine().clone())
    }

    /// What a reader has not seen whose next revision is `from`.
    pub(crate) fn since(&self, from: u64) -> RevisionsPage {
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

    /// The folder of its draft.
    pub(super) fn draft_place(&self) -> PathBuf {
        self.draft.lock().place().to_owned()
    }

    /// Drafts that were set aside may have been removed.
    pub(super) fn count_set_aside(&self) {
        let draft = self.draft.lock();
        let count = set_aside::count(draft.place());
        self.open.write().set_aside = count;
        self.tell();
    }

    fn must_be_open(&self) -> Result<(), Failure> {
        if self.wires.is_open() { Ok(()) } else { Err(closed(&self.id)) }
    }

    /// Reports its current status. To be called before the draft is unlocked, so that the last report is the latest.
    fn tell(&self) {
        let mut summary = self.open.read().summary(&self.id);
        if summary.is_recovered && !summary.is_changed {
            // Recovered edits were taken back: later ones are not recovered.
            summary.is_recovered = false;
            self.open.write().is_recovered = false;
        }
        self.wires.tell(summary);
    }

    /// Performs it, once for each request, and only after it is written down. `read` is the operation with what it names.
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

    /// Closes it, if no one is at work on it, follows it or would miss anything. What was answered stays known by its draft.
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

    /// Faults of its files at the last read, rules that it breaks, scripts that do not fit, and libraries that have changed.
    pub(super) fn problems(&self, server: &ServerState) -> Result<Vec<MachineProblem>, Failure> {
        let (revision, machine) = self.machine();
        let rules = self.problems.of(revision, || Ok(super::problems::rules(&machine).into()))?;
        let files = super::problems::files(&self.open.read().files.problems);
        let scripts = super::problems::scripts(&machine, server);
        let changed = super::problems::of_libraries(&machine, &server.projects.libraries());
        let rules = rules.iter().cloned();
        Ok(files.into_iter().chain(rules).chain(scripts).chain(changed).collect())
    }

    /// Someone looks at these states.
    pub(super) fn looks(&self, presence: Presence) {
        self.wires.looks(presence);
    }

    /// Someone looks elsewhere.
    pub(super) fn leaves(&self, connection: u64) {
        self.wires.leaves(connection);
    }

    /// A line of the draft. Before the first one, what the draft begins with is written: the files may be others when the
    /// lines are read.
    fn write_down(&self, draft: &mut Draft, line: &DraftLine) -> Result<(), Failure> {
        if !draft.is_begun() {
            // Nothing was done yet, so that this is what was read; opening has made it JSON already.
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

/// The document in what [`whole`] made.
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

/// No machine of this name is open.
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
