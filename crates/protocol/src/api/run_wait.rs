//! Cause of a run's wait, derived from its snapshot. All lists of runs use this function.

use crate::{ActiveState, Phase, RunStatus, Snapshot};
use serde::{Deserialize, Serialize};

/// Cause of a run's wait.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum RunWait {
    /// A question needs an answer.
    Answer,
    /// A script that a crash interrupted needs a decision.
    Decision,
    /// The run is paused or in step mode and needs a command.
    Paused,
    /// Something else, such as a time or another branch.
    Other,
}

impl RunWait {
    /// Returns the cause of the wait. `None` while a branch is at work, and for a run that is stopping or over.
    pub fn of(snapshot: &Snapshot) -> Option<Self> {
        let is = |wanted| snapshot.active.iter().any(|state| state.phase == wanted);
        if snapshot.status != RunStatus::Stopping && is(Phase::Interrupted) {
            return Some(Self::Decision);
        }
        let asks = |path: &str| snapshot.questions.iter().any(|question| question.path == path);
        let is_inner = |path: &str| {
            let within =
                |other: &str| other.strip_prefix(path).is_some_and(|rest| rest.starts_with('/'));
            !snapshot.active.iter().any(|other| within(&other.path))
        };
        let is_at_work = |state: &ActiveState| match state.phase {
            Phase::Running => is_inner(&state.path) && !asks(&state.path),
            Phase::Preempted => is_inner(&state.path),
            Phase::Waiting | Phase::Held | Phase::Interrupted => false,
        };
        match snapshot.status {
            RunStatus::Paused | RunStatus::Stepping => Some(Self::Paused),
            RunStatus::Stopping | RunStatus::Finished => None,
            RunStatus::Running if snapshot.active.iter().any(is_at_work) => None,
            RunStatus::Running if !snapshot.questions.is_empty() => Some(Self::Answer),
            RunStatus::Running => is(Phase::Waiting).then_some(Self::Other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::RunWait;
    use crate::Snapshot;

    /// `active` holds words such as `R running`. `asks` holds paths.
    fn check(status: &str, active: &[&str], asks: &[&str], wanted: Option<RunWait>) {
        let states: Vec<_> = active.iter().map(|words| state(words)).collect();
        let questions: Vec<_> =
            asks.iter().enumerate().map(|(id, path)| question(id, path)).collect();
        let snapshot: Snapshot = serde_json::from_value(serde_json::json!({
            "status": status, "active": states, "states_run": 0, "elapsed_ms": 0, "sequence": 0, "disk_safe": 0,
            "journal_problem": null, "breakpoints": [], "questions": questions,
        }))
        .unwrap();
        assert_eq!(RunWait::of(&snapshot), wanted, "{status} {active:?} {asks:?}");
    }

    fn state(words: &str) -> serde_json::Value {
        let (path, phase) = words.split_once(' ').unwrap();
        serde_json::json!({
            "path": path, "name": "", "phase": phase, "since_ms": 0, "branch": "", "detail": null, "held": [],
        })
    }

    fn question(id: usize, path: &str) -> serde_json::Value {
        serde_json::json!({
            "id": id, "path": path, "message": "go?", "form": { "type": "buttons", "buttons": ["yes"] },
        })
    }

    #[test]
    fn a_run_waits_when_none_of_its_branches_is_at_work() {
        check("running", &["R running", "R/A running"], &[], None);
        check("running", &["R running", "R/A running"], &["R/A"], Some(RunWait::Answer));
        check("running", &["R running", "R/A running", "R/B running"], &["R/A"], None);
        check("running", &["R running", "R/A waiting"], &[], Some(RunWait::Other));
        check("paused", &["R running", "R/A held"], &[], Some(RunWait::Paused));
        check("running", &["R running", "R/A interrupted"], &[], Some(RunWait::Decision));
        check("stopping", &["R preempted", "R/A running"], &["R/A"], None);
    }
}
