//! What is active right now, for those who look at a run.

use super::Engine;
use super::phase::Phase;
use crate::{BranchId, Datum, NodeId, PathId, WaitReason};

/// An active state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Active {
    /// Where it stands.
    pub path: PathId,
    /// Which state it is.
    pub node: NodeId,
    /// The line of execution that it belongs to.
    pub branch: BranchId,
    /// What it does.
    pub activity: Activity,
    /// Whether it was asked to end.
    pub preempted: bool,
}

/// What an active state does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Activity {
    /// Its script runs.
    Script,
    /// States inside it are active.
    Inside,
    /// A pause holds it before its next child.
    Held,
    /// It cannot go on until the machine is changed or stopped.
    Waiting(WaitReason),
}

impl<D: Datum> Engine<D> {
    /// All active states: parents before children, children in their order.
    pub fn snapshot(&self) -> Vec<Active> {
        let frames = self.run.root.map(|root| self.run.frames.below(root)).unwrap_or_default();
        let active = |slot| {
            let frame = self.run.frames.get(slot);
            Active {
                path: frame.path,
                node: frame.node,
                branch: frame.branch,
                activity: activity(&frame.phase),
                preempted: frame.preempted,
            }
        };
        frames.into_iter().map(active).collect()
    }
}

pub(super) fn activity(phase: &Phase) -> Activity {
    match phase {
        Phase::Script => Activity::Script,
        Phase::Begun | Phase::Child | Phase::Branches | Phase::Deciding => Activity::Inside,
        Phase::Held => Activity::Held,
        Phase::Waiting(reason) => Activity::Waiting(reason.clone()),
    }
}
