//! What is active right now, for those who look at a run.

use crate::engine::Engine;
use crate::engine::state::frames::NONE;
use crate::engine::state::phase::Phase;
use crate::engine::state::suspended::SuspendReason;
use crate::{BranchId, Datum, HeldBy, NodeId, PathId, WaitReason};

/// An active state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActiveState {
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
    /// The place of the child of a concurrency state whose branch it belongs to; `None` on the branch of the root.
    pub top: Option<PathId>,
    /// What is held in it: one for a hierarchy or library state that is held, one for each branch of a concurrency state
    /// that is held before it begins or after it ended.
    pub holds: Vec<Hold>,
}

/// Where a state is held between two of its children.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hold {
    /// By what.
    pub by: HeldBy,
    /// The state before which it is held, if there is one.
    pub next: Option<PathId>,
}

/// What an active state does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Activity {
    /// Its script runs.
    Script,
    /// States inside it are active.
    Inside,
    /// It is held before its next child, or after its last.
    Held,
    /// The condition of a breakpoint is being evaluated before its next child, or after its last.
    Checking,
    /// It cannot continue until the machine is changed or stopped.
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

    /// What holds the run before its root begins, or after it ended.
    pub fn held_outside(&self) -> Option<HeldBy> {
        let outside = self.run.control.holds.iter().find(|hold| hold.spot.is_root());
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
        let holds = self.run.control.holds.iter().filter(|hold| hold.spot.parent == slot);
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
