//! The places where the run is suspended between two states, and the reasons. This module keeps the list; it does not
//! know the effects of a hold.

use crate::engine::state::breakpoints::Breakpoints;
use crate::engine::state::frames::NONE;
use crate::{BranchId, Breakpoint, Datum, HeldBy, PathId, Silence, Then, Unattended, When};
use rafcon_model::{OutcomeId, StatePath};
use std::sync::Arc;

/// A point between two states: before or after a child of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) struct StopPoint {
    /// Frame around the child; [`NONE`] for the root.
    pub(in crate::engine) parent: u32,
    /// Index of the child; [`NONE`] at the end of a hierarchy, where no child is next.
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

/// The inputs, outputs and outcome of a state that was just left.
#[derive(Debug, Clone)]
pub(in crate::engine) struct LeftState<D> {
    pub(in crate::engine) inputs: Arc<[D]>,
    pub(in crate::engine) outputs: Arc<[D]>,
    pub(in crate::engine) outcome: OutcomeId,
}

/// The evaluation of a stop point's breakpoints, while it is in progress.
#[derive(Debug, Clone)]
pub(in crate::engine) struct BreakpointScan<D> {
    pub(in crate::engine) stop_point: StopPoint,
    pub(in crate::engine) branch: BranchId,
    /// True if a pause and steps also hold here.
    pub(in crate::engine) modes: bool,
    /// Breakpoints that are not yet evaluated, the next one last.
    pub(in crate::engine) rest: Vec<u64>,
    /// The hold by the breakpoints evaluated until now.
    pub(in crate::engine) held: Option<HeldBy>,
    /// True if a breakpoint stops the run.
    pub(in crate::engine) stops: bool,
    /// After a state: its inputs and outputs.
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
        scan: Box<BreakpointScan<D>>,
    },
}

#[derive(Debug, Clone)]
pub(in crate::engine) struct SuspendedBranch<D> {
    pub(in crate::engine) id: u64,
    pub(in crate::engine) stop_point: StopPoint,
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

/// Everything that can hold a run, and the current holds.
#[derive(Debug)]
pub(in crate::engine) struct Control<D> {
    pub(in crate::engine) breakpoints: Breakpoints,
    /// The state that the run continues to.
    pub(in crate::engine) run_to: Option<StatePath>,
    pub(in crate::engine) attended: bool,
    /// Duration of the ground's silence.
    pub(in crate::engine) silence: Silence,
    /// True during the call that starts the run, if it is held at its beginning.
    pub(in crate::engine) starting: bool,
    /// Place at which the run was started, and the action after its end.
    pub(in crate::engine) then: Option<(PathId, Then)>,
    /// True if the run stops before its next state.
    pub(in crate::engine) stop_next: bool,
    /// The breakpoint that paused the run.
    pub(in crate::engine) paused_by: Option<u64>,
    pub(in crate::engine) holds: Vec<SuspendedBranch<D>>,
    /// The state that was left last, while breakpoints exist.
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

    /// True if nothing here can hold the run.
    pub(in crate::engine) fn is_quiet(&self) -> bool {
        self.breakpoints.is_empty()
            && self.run_to.is_none()
            && self.then.is_none()
            && !self.starting
            && !self.stop_next
            && self.silence.is_over()
    }

    /// The current action of a breakpoint. An attended one holds.
    pub(in crate::engine) fn unattended(&self, breakpoint: &Breakpoint) -> Unattended {
        let silent_ms = self.silence.link_ms;
        let is_lost = breakpoint.lost_link_ms.is_some_and(|ms| silent_ms > 0 && silent_ms >= ms);
        if self.attended && !is_lost { Unattended::Hold } else { breakpoint.unattended }
    }

    /// Clears the targets and actions of the previous start.
    pub(in crate::engine) fn forget(&mut self) {
        self.run_to = None;
        self.then = None;
        self.stop_next = false;
        self.was = None;
    }

    pub(in crate::engine) fn put(
        &mut self,
        stop_point: StopPoint,
        branch: BranchId,
        why: SuspendReason<D>,
    ) {
        self.next_hold += 1;
        self.holds.push(SuspendedBranch { id: self.next_hold, stop_point, branch, why });
    }

    /// The number of the newest hold.
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

    /// Removes and returns the hold whose condition has this check number.
    pub(in crate::engine) fn take_check(&mut self, check: u64) -> Option<SuspendedBranch<D>> {
        let place = self.holds.iter().position(|hold| hold.check() == Some(check))?;
        Some(self.holds.remove(place))
    }

    /// Removes and returns all holds in a frame, in the order of children.
    pub(in crate::engine) fn take_in(&mut self, parent: u32) -> Vec<SuspendedBranch<D>> {
        let mut taken = Vec::new();
        if self.holds.iter().any(|hold| hold.stop_point.parent == parent) {
            taken = self.holds.extract_if(.., |hold| hold.stop_point.parent == parent).collect();
            taken.sort_by_key(|hold| hold.stop_point.child);
        }
        taken
    }
}
