//! Where the run stands still between two states, and why. Knows the list, not what a hold does.

use crate::engine::state::breakpoints::Breakpoints;
use crate::engine::state::frames::NONE;
use crate::{BranchId, Breakpoint, Datum, HeldBy, PathId, Silence, Then, Unattended, When};
use rafcon_model::{OutcomeId, StatePath};
use std::sync::Arc;

/// A moment between two states: before or after a child of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) struct StopPoint {
    /// The frame around the child; [`NONE`] for the root.
    pub(in crate::engine) parent: u32,
    /// The index of the child; [`NONE`] at the end of a hierarchy, where no child is next.
    pub(in crate::engine) child: u32,
    pub(in crate::engine) when: When,
}

impl StopPoint {
    pub(in crate::engine) fn before(parent: u32, child: u32) -> Self {
        Self { parent, child, when: When::Before }
    }

    pub(in crate::engine) fn after(parent: u32, child: u32) -> Self {
        Self { parent, child, when: When::After }
    }

    pub(in crate::engine) fn root(when: When) -> Self {
        Self { parent: NONE, child: 0, when }
    }

    pub(in crate::engine) fn is_root(&self) -> bool {
        self.parent == NONE
    }
}

/// What a state got and gave that has just been left.
#[derive(Debug, Clone)]
pub(in crate::engine) struct LeftState<D> {
    pub(in crate::engine) inputs: Arc<[D]>,
    pub(in crate::engine) outputs: Arc<[D]>,
    pub(in crate::engine) outcome: OutcomeId,
}

/// The breakpoints of a spot, on the way through them.
#[derive(Debug, Clone)]
pub(in crate::engine) struct BreakpointScan<D> {
    pub(in crate::engine) spot: StopPoint,
    pub(in crate::engine) branch: BranchId,
    /// Whether a pause and steps hold here too.
    pub(in crate::engine) modes: bool,
    /// Those that have not been looked at, the next one last.
    pub(in crate::engine) rest: Vec<u64>,
    /// What holds, as far as they have been looked at.
    pub(in crate::engine) held: Option<HeldBy>,
    /// Whether one of them stops the run.
    pub(in crate::engine) stops: bool,
    /// After a state: what it got and gave.
    pub(in crate::engine) was: Option<LeftState<D>>,
}

#[derive(Debug, Clone)]
pub(in crate::engine) enum SuspendReason<D> {
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
pub(in crate::engine) struct SuspendedBranch<D> {
    pub(in crate::engine) id: u64,
    pub(in crate::engine) spot: StopPoint,
    pub(in crate::engine) branch: BranchId,
    pub(in crate::engine) why: SuspendReason<D>,
}

impl<D> SuspendedBranch<D> {
    pub(in crate::engine) fn by(&self) -> Option<HeldBy> {
        match self.why {
            SuspendReason::Held { by, .. } => Some(by),
            SuspendReason::Checking { .. } => None,
        }
    }

    pub(in crate::engine) fn check(&self) -> Option<u64> {
        match self.why {
            SuspendReason::Checking { check, .. } => Some(check),
            SuspendReason::Held { .. } => None,
        }
    }
}

/// What could hold a run, and what holds it.
#[derive(Debug)]
pub(in crate::engine) struct Control<D> {
    pub(in crate::engine) breakpoints: Breakpoints,
    /// The state that the run is to come to.
    pub(in crate::engine) run_to: Option<StatePath>,
    pub(in crate::engine) attended: bool,
    /// For how long nobody on the ground was heard.
    pub(in crate::engine) silence: Silence,
    /// The run was begun in this answer, and is held where it begins.
    pub(in crate::engine) starting: bool,
    /// The place that the run was begun at, and what happens once it was left.
    pub(in crate::engine) then: Option<(PathId, Then)>,
    /// The run stops before its next state.
    pub(in crate::engine) stop_next: bool,
    /// The breakpoint by which the run was paused.
    pub(in crate::engine) paused_by: Option<u64>,
    pub(in crate::engine) holds: Vec<SuspendedBranch<D>>,
    /// What was left last, while there are breakpoints.
    pub(in crate::engine) was: Option<LeftState<D>>,
    next_hold: u64,
    next_check: u64,
}

impl<D: Datum> Control<D> {
    pub(in crate::engine) fn new() -> Self {
        Self {
            breakpoints: Breakpoints::default(),
            run_to: None,
            attended: true,
            silence: Silence::default(),
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
    pub(in crate::engine) fn is_quiet(&self) -> bool {
        self.breakpoints.is_empty()
            && self.run_to.is_none()
            && self.then.is_none()
            && !self.starting
            && !self.stop_next
            && self.silence.is_over()
    }

    /// What a breakpoint does now: it holds while someone attends to it.
    pub(in crate::engine) fn unattended(&self, breakpoint: &Breakpoint) -> Unattended {
        let silent_ms = self.silence.link_ms;
        let is_lost = breakpoint.lost_link_ms.is_some_and(|ms| silent_ms > 0 && silent_ms >= ms);
        if self.attended && !is_lost { Unattended::Hold } else { breakpoint.unattended }
    }

    /// The run begins again: nothing is left of where it was to go.
    pub(in crate::engine) fn forget(&mut self) {
        self.run_to = None;
        self.then = None;
        self.stop_next = false;
        self.was = None;
    }

    pub(in crate::engine) fn put(
        &mut self,
        spot: StopPoint,
        branch: BranchId,
        why: SuspendReason<D>,
    ) {
        self.next_hold += 1;
        self.holds.push(SuspendedBranch { id: self.next_hold, spot, branch, why });
    }

    /// The number of the hold that was put here last.
    pub(in crate::engine) fn newest(&self) -> u64 {
        self.next_hold
    }

    pub(in crate::engine) fn next_check(&mut self) -> u64 {
        self.next_check += 1;
        self.next_check
    }

    pub(in crate::engine) fn take(&mut self, id: u64) -> Option<SuspendedBranch<D>> {
        let place = self.holds.iter().position(|hold| hold.id == id)?;
        Some(self.holds.remove(place))
    }

    /// The hold whose condition is being evaluated under this number.
    pub(in crate::engine) fn take_check(&mut self, check: u64) -> Option<SuspendedBranch<D>> {
        let place = self.holds.iter().position(|hold| hold.check() == Some(check))?;
        Some(self.holds.remove(place))
    }

    /// Takes away all holds in a frame, in the order of children.
    pub(in crate::engine) fn take_in(&mut self, parent: u32) -> Vec<SuspendedBranch<D>> {
        let mut taken = Vec::new();
        if self.holds.iter().any(|hold| hold.spot.parent == parent) {
            taken = self.holds.extract_if(.., |hold| hold.spot.parent == parent).collect();
            taken.sort_by_key(|hold| hold.spot.child);
        }
        taken
    }
}
