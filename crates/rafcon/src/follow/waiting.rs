//! Runs that can only wait until somebody changes the run or its machine. Pure.

use rafcon_protocol::{ActiveState, Phase, RunStatus, Snapshot};
use std::fmt;

/// True if every active state waits for something that the machine lacks.
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

/// Reports if a deadline or a lost-link policy ends the waiting of a machine.
type EndsItself = Box<dyn Fn() -> bool>;

/// A run that nobody watches.
pub(super) struct Unattended(pub(super) EndsItself);

impl fmt::Debug for Unattended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Unattended")
    }
}

/// Reports each permanent wait of a run once.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    is_reported: bool,
    /// Cause of our stop.
    pub(super) stopped_for: Option<String>,
}

impl Waiting {
    /// Description of what the run waits for; once each time that it starts to wait permanently.
    ///
    /// Reads the snapshot, which can overtake earlier events.
    pub(super) fn begins(&mut self, snapshot: &Snapshot) -> Option<String> {
        let waits = can_only_wait(snapshot);
        let begins = waits && !self.is_reported;
        self.is_reported = waits;
        begins.then(|| awaited(snapshot))
    }
}

/// Description of what the states of a snapshot wait for, without duplicates.
fn awaited(snapshot: &Snapshot) -> String {
    let waiting = snapshot.active.iter().filter(|state| state.phase == Phase::Waiting);
    let mut awaited: Vec<&str> = waiting.filter_map(|state| state.detail.as_deref()).collect();
    awaited.sort_unstable();
    awaited.dedup();
    awaited.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No earlier events are needed.
    #[test]
    fn a_snapshot_alone_says_what_is_awaited() {
        let state = |path: &str, phase, detail: Option<&str>| ActiveState {
            path: path.to_owned(),
            name: String::new(),
            phase,
            since_ms: 0,
            branch: String::new(),
            detail: detail.map(str::to_owned),
            held: Vec::new(),
        };
        let active = vec![
            state("A", Phase::Running, None),
            state("A/B", Phase::Waiting, Some("a start state")),
            state("A/C", Phase::Waiting, Some("a child")),
            state("A/D", Phase::Waiting, Some("a start state")),
        ];
        let snapshot = Snapshot {
            status: RunStatus::Running,
            active,
            states_run: 0,
            elapsed_ms: 0,
            sequence: 0,
            disk_safe: 0,
            journal_problem: None,
            breakpoints: Vec::new(),
            questions: Vec::new(),
        };
        let mut waiting = Waiting::default();
        assert_eq!(waiting.begins(&snapshot).as_deref(), Some("a child and a start state"));
        assert_eq!(waiting.begins(&snapshot), None);
    }
}
