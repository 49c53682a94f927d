//! A snapshot of the active states, for viewers of a run.

use crate::engine::Engine;
use crate::engine::state::frames::NONE;
use crate::engine::state::phase::Phase;
use crate::engine::state::suspended::SuspendReason;
use crate::{BranchId, Datum, HeldBy, NodeId, PathId, WaitReason};

/// An active state and its activity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActiveState {
    /// Place of the state.
    pub path: PathId,
    /// The node of the state.
    pub node: NodeId,
    /// The branch on which the state runs.
    pub branch: BranchId,
    /// Current activity of the state.
    pub activity: Activity,
    /// True if the state was asked to end.
    pub preempted: bool,
    /// Place of the concurrency state's child whose branch this is; `None` on the branch of the root.
    pub top: Option<PathId>,
    /// Holds in the state. A held hierarchy or library state has one. A concurrency state has one for each branch that
    /// is held before it begins or after it ended.
    pub holds: Vec<Hold>,
}

/// A hold between two children of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hold {
    /// The cause of the hold.
    pub by: HeldBy,
    /// The state before which the branch is held, if it is known.
    pub next: Option<PathId>,
}

/// The activity of an active state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Activity {
    /// The script of the state runs.
    Script,
    /// States inside this state are active.
    Inside,
    /// The state is held before its next child, or after its last.
    Held,
    /// The condition of a breakpoint is being evaluated before the next child, or after the last.
    Checking,
    /// The state cannot continue until the machine is changed or stopped.
    Waiting(WaitReason),
}

impl<D: Datum> Engine<D> {
    /// All active states: parents before children, children in their order.
    pub fn snapshot(&self) -> Vec<ActiveState> {
        let frames = self.run.root.map(|root| self.run.frames.below(root)).unwrap_or_default();
        let active = |slot| {
            let frame = self.run.frames.get(slot);
            ActiveState {
                path: frame.path,
                node: frame.node,
                branch: frame.branch,
                activity: activity(&frame.phase),
                preempted: frame.preempted,
                top: self.top(slot),
                holds: self.holds(slot),
            }
        };
        frames.into_iter().map(active).collect()
    }

    /// The hold of the run before its root begins, or after it ended.
    pub fn held_outside(&self) -> Option<HeldBy> {
        let outside = self.run.control.holds.iter().find(|hold| hold.stop_point.is_root());
        outside.and_then(crate::engine::state::suspended::SuspendedBranch::by)
    }

    fn top(&self, slot: u32) -> Option<PathId> {
        let branch = self.run.frames.get(slot).branch;
        let mut frame = self.run.frames.get(slot);
        while frame.parent != NONE {
            let parent = self.run.frames.get(frame.parent);
            if parent.branch != branch {
                return Some(frame.path);
            }
            frame = parent;
        }
        None
    }

    fn holds(&self, slot: u32) -> Vec<Hold> {
        let holds = self.run.control.holds.iter().filter(|hold| hold.stop_point.parent == slot);
        let hold = |hold: &crate::engine::state::suspended::SuspendedBranch<D>| match hold.why {
            SuspendReason::Held { by, next } => Some(Hold { by, next }),
            SuspendReason::Checking { .. } => None,
        };
        holds.filter_map(hold).collect()
    }
}

pub(in crate::engine) fn activity(phase: &Phase) -> Activity {
    match phase {
        Phase::Script => Activity::Script,
        Phase::Begun | Phase::Child | Phase::Branches | Phase::Deciding => Activity::Inside,
        Phase::Held => Activity::Held,
        Phase::Checking => Activity::Checking,
        Phase::Waiting(reason) => Activity::Waiting(reason.clone()),
    }
}
