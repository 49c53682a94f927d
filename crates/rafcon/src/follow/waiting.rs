//! Runs that can only wait: nothing happens in them until somebody changes the run or its machine. Pure.

use rafcon_protocol::{ActiveState, Phase, RunStatus, Snapshot};
use std::fmt;

/// True if everything that is active waits for something that the machine lacks.
pub(super) fn can_only_wait(snapshot: &Snapshot) -> bool {
    let active = &snapshot.active;
    let waits = |state: &ActiveState| state.phase == Phase::Waiting;
    let is_container = |state: &ActiveState| {
        let inside = format!("{}/", state.path);
        active.iter().any(|other| other.path.starts_with(&inside))
    };
    snapshot.status == RunStatus::Running
        && snapshot.questions.is_empty()
        && active.iter().any(waits)
        && active.iter().all(|state| waits(state) || is_container(state))
}

/// Returns whether a deadline or a lost-link policy ends the waiting of a machine.
type EndsItself = Box<dyn Fn() -> bool>;

/// A run that nobody watches.
pub(super) struct Unattended(pub(super) EndsItself);

impl fmt::Debug for Unattended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Unattended")
    }
}

/// Reports of waiting.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    /// Last reason that the run reported.
    pub(super) reason: String,
    is_reported: bool,
    /// Reason of our stop.
    pub(super) stopped_for: Option<String>,
}

impl Waiting {
    /// The reason, once each time that a run begins to wait for good.
    pub(super) fn begins(&mut self, snapshot: &Snapshot) -> Option<String> {
        let waits = can_only_wait(snapshot);
        let begins = waits && !self.is_reported;
        self.is_reported = waits;
        begins.then(|| self.reason.clone())
    }
}
