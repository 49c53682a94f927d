//! Where the run stands still between two states, and why. Knows the list, not what a hold does.

use super::breakpoints::Breakpoints;
use super::frames::NONE;
use crate::{BranchId, HeldBy, Then, When};
use crate::{PathId, datum::Datum};
use rafcon_model::{OutcomeId, StatePath};
use std::sync::Arc;

/// A moment between two states: before or after a child of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct StopPoint {
    /// The frame around the child; [`NONE`] for the root.
    pub(super) parent: u32,
    /// The index of the child; [`NONE`] at the end of a hierarchy, where no child is next.
    pub(super) child: u32,
    pub(super) when: When,
}

impl StopPoint {
    pub(super) fn before(parent: u32, child: u32) -> Self {
        Self { parent, child, when: When::Before }
    }

    pub(super) fn after(parent: u32, child: u32) -> Self {
        Self { parent, child, when: When::After }
    }

    pub(super) fn root(when: When) -> Self {
        Self { parent: NONE, child: 0, when }
    }

    pub(super) fn is_root(&self) -> bool {
        self.parent == NONE
    }
}

/// What a state got and gave that has just been left.
#[derive(Debug, Clone)]
pub(super) struct LeftState<D> {
    pub(super) inputs: Arc<[D]>,
    pub(super) outputs: Arc<[D]>,
    pub(super) outcome: OutcomeId,
}

/// The breakpoints of a spot, on the way through them.
#[derive(Debug, Clone)]
pub(super) struct BreakpointScan<D> {
    pub(super) spot: StopPoint,
    pub(super) branch: BranchId,
    /// Whether a pause and steps hold here too.
    pub(super) modes: bool,
    /// Those that have not been looked at, the next one last.
    pub(super) rest: Vec<u64>,
    /// What holds, as far as they have been looked at.
    pub(super) held: Option<HeldBy>,
    /// Whether one of them stops the run.
    pub(super) stops: bool,
    /// After a state: what it got and gave.
    pub(super) was: Option<LeftState<D>>,
}

#[derive(Debug, Clone)]
pub(super) enum SuspendReason<D> {
    Held {
        by: HeldBy,
        next: Option<PathId>,
    },
    /// The condition of this breakpoint is being evaluated.
    Checking {
        check: u64,
        breakpoint: u64,
        inquiry: Box<BreakpointScan<D>>,
    },
}

#[derive(Debug, Clone)]
pub(super) struct SuspendedBranch<D> {
    pub(super) id: u64,
    pub(super) spot: StopPoint,
    pub(super) branch: BranchId,
    pub(super) why: SuspendReason<D>,
}

impl<D> SuspendedBranch<D> {
    pub(super) fn by(&self) -> Option<HeldBy> {
        match self.why {
            SuspendReason::Held { by, .. } => Some(by),
            SuspendReason::Checking { .. } => None,
        }
    }

    pub(super) fn check(&self) -> Option<u64> {
        match self.why {
            SuspendReason::Checking { check, .. } => Some(check),
            SuspendReason::Held { .. } => None,
        }
    }
}

/// What could hold a run, and what holds it.
#[derive(Debug)]
pub(super) struct Control<D> {
    pub(super) breakpoints: Breakpoints,
    /// The state that the run is to come to.
    pub(super) run_to: Option<StatePath>,
    pub(super) attended: bool,
    /// The run was begun in this answer, and is held where it begins.
    pub(super) starting: bool,
    /// The place that the run was begun at, and what happens once it was left.
    pub(super) then: Option<(PathId, Then)>,
    /// The run stops before its next state.
    pub(super) stop_next: bool,
    /// The breakpoint by which the run was paused.
    pub(super) paused_by: Option<u64>,
    pub(super) holds: Vec<SuspendedBranch<D>>,
    /// What was left last, while there are breakpoints.
    pub(super) was: Option<LeftState<D>>,
    next_hold: u64,
    next_check: u64,
}

impl<D: Datum> Control<D> {
    pub(super) fn new() -> Self {
        Self {
            breakpoints: Breakpoints::default(),
            run_to: None,
            attended: true,
            starting: false,
            then: None,
            stop_next: false,
            paused_by: None,
            holds: Vec::new(),
            was: None,
            next_hold: 0,
            next_check: 0,
        }
    }

    /// Whether nothing here could hold the run.
    pub(super) fn is_quiet(&self) -> bool {
        self.breakpoints.is_empty()
            && self.run_to.is_none()
            && self.then.is_none()
            && !self.starting
            && !self.stop_next
    }

    /// The run begins again: nothing is left of where it was to go.
    pub(super) fn forget(&mut self) {
        self.run_to = None;
        self.then = None;
        self.stop_next = false;
        self.was = None;
    }

    pub(super) fn put(&mut self, spot: StopPoint, branch: BranchId, why: SuspendReason<D>) {
        self.next_hold += 1;
        self.holds.push(SuspendedBranch { id: self.next_hold, spot, branch, why });
    }

    pub(super) fn next_check(&mut self) -> u64 {
        self.next_check += 1;
        self.next_check
    }

    pub(super) fn take(&mut self, id: u64) -> Option<SuspendedBranch<D>> {
        let place = self.holds.iter().position(|hold| hold.id == id)?;
        Some(self.holds.remove(place))
    }

    /// The hold whose condition is being evaluated under this number.
    pub(super) fn take_check(&mut self, check: u64) -> Option<SuspendedBranch<D>> {
        let place = self.holds.iter().position(|hold| hold.check() == Some(check))?;
        Some(self.holds.remove(place))
    }

    /// Takes away all holds in a frame, in the order of children.
    pub(super) fn take_in(&mut self, parent: u32) -> Vec<SuspendedBranch<D>> {
        let mut taken = Vec::new();
        if self.holds.iter().any(|hold| hold.spot.parent == parent) {
            taken = self.holds.extract_if(.., |hold| hold.spot.parent == parent).collect();
            taken.sort_by_key(|hold| hold.spot.child);
        }
        taken
    }
}
