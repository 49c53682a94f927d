//! Summary of a run's folder. Knows folders, requests and journals. Blocks.

use super::folder_files::RunRequest;
use super::leftovers::OUTPUT_FILE;
use crate::projects::Projects;
use rafcon_protocol::Keeping;
use rafcon_protocol::api::{RunPhase, RunSummary};
use rafcon_storage::journal::folder::ABOUT_FILE;
use rafcon_storage::journal::{About, RunState, Summary, has_begun};
use rafcon_supervisor::is_alive;
use std::path::Path;

/// Reason in the phase of a requested run that has not begun.
const NOT_BEGUN: &str = "its server or its runner ended before it had begun; send the request again with its id to start it";

/// Result of reading a folder.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FolderSummary {
    /// Summary of the run.
    pub(super) summary: RunSummary,
    /// The request that is recorded in the folder.
    pub(super) request: Option<RunRequest>,
}

/// Reads the folder of a run. `None` if it contains no run.
pub(super) fn look(folder: &Path, projects: &Projects) -> Option<FolderSummary> {
    let request = RunRequest::read(folder);
    if folder.join(ABOUT_FILE).is_file() {
        let summary = kept(folder, projects, request.as_ref());
        if !is_open(&summary, request.as_ref(), folder) {
            return Some(FolderSummary { summary, request });
        }
    }
    let asked = request?;
    let summary = asked_for(folder, &asked);
    Some(FolderSummary { summary, request: Some(asked) })
}

/// True if a requested run lost its runner before its first event.
fn is_open(summary: &RunSummary, request: Option<&RunRequest>, folder: &Path) -> bool {
    let is_asked_for = request.is_some_and(|request| request.start.is_some());
    is_asked_for && summary.phase == RunPhase::Crashed && !has_begun(folder)
}

/// Summary of a run with a journal.
fn kept(folder: &Path, projects: &Projects, request: Option<&RunRequest>) -> RunSummary {
    let Summary { id, name, started_ms, state, length_ms, events, bytes, received_ms, .. } =
        Summary::of(folder);
    let unheard_since_ms = received_ms.filter(|_| state == RunState::NotReceived);
    let about = About::read(folder).unwrap_or_default();
    let machine = request.and_then(|request| request.machine().cloned());
    RunSummary {
        id,
        name,
        machine: machine.or_else(|| projects.file_of(&about.machine)),
        author: request.map(|request| request.author.clone()),
        started_ms,
        phase: phase(state),
        length_ms,
        events,
        bytes,
        keeping: about.keeping,
        waits: None,
        unheard_since_ms,
        robot: about.robot,
    }
}

/// Summary of a requested run without a journal.
fn asked_for(folder: &Path, request: &RunRequest) -> RunSummary {
    let phase = if is_alive(&folder.join(OUTPUT_FILE)) {
        RunPhase::Starting
    } else {
        RunPhase::NotStarted { reason: NOT_BEGUN.to_owned() }
    };
    RunSummary {
        id: folder.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        name: String::new(),
        machine: request.machine().cloned(),
        author: Some(request.author.clone()),
        started_ms: 0,
        phase,
        length_ms: 0,
        events: 0,
        bytes: 0,
        keeping: request.start.as_ref().map_or(Keeping::default(), |start| start.keeping),
        waits: None,
        unheard_since_ms: None,
        robot: None,
    }
}

fn phase(state: RunState) -> RunPhase {
    match state {
        RunState::Live { process: _ } | RunState::NotReceived => RunPhase::Live,
        RunState::Finished { outcome, states_run } => RunPhase::Finished { outcome, states_run },
        RunState::Crashed => RunPhase::Crashed,
        RunState::Diverged { reason } => RunPhase::Diverged { reason },
        RunState::Unreadable { reason } => RunPhase::Unreadable { reason },
    }
}
