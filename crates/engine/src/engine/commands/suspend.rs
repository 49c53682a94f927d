//! Decides whether the run passes a stop point between two states: breakpoints with conditions and hit counts, the state to
//! run to, steps and pauses.

use crate::engine::Status;
use crate::engine::state::frames::NONE;
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::{BreakpointScan, StopPoint, SuspendReason};
use crate::program::{Body, Concurrency};
use crate::{
    BranchId, Datum, Event, HeldBy, Level, Note, PathId, Program, Refusal, Scope, Unattended, When,
};
use rafcon_model::StatePath;
use smol_str::SmolStr;

impl<D: Datum> Step<'_, D> {
    /// True if the run passes this stop point now. Otherwise it is held there, or a condition is being evaluated.
    pub(in crate::engine) fn passes(&mut self, spot: StopPoint, branch: BranchId) -> bool {
        self.run.is_free() || self.passes_gates(spot, branch, true)
    }

    /// As [`Self::passes`], but only breakpoints count, because the branch was just released from a hold.
    pub(in crate::engine) fn passes_breakpoints(
        &mut self,
        spot: StopPoint,
        branch: BranchId,
    ) -> bool {
        self.run.is_free() || self.passes_gates(spot, branch, false)
    }

    /// As [`Self::passes`], for a state that had ended before the run was lost: its breakpoints were already counted.
    pub(in crate::engine) fn passes_again(&mut self, spot: StopPoint, branch: BranchId) -> bool {
        if self.run.is_free()
            || self.run.status == Status::Stopping
            || self.view().ends_anyway(spot)
        {
            return true;
        }
        let (rest, held) = (Vec::new(), None);
        self.ask(BreakpointScan { spot, branch, modes: true, rest, held, stops: false, was: None })
    }

    fn passes_gates(&mut self, spot: StopPoint, branch: BranchId, modes: bool) -> bool {
        if self.run.status == Status::Stopping || self.view().ends_anyway(spot) {
            return true;
        }
        let stops = spot.when == When::Before && self.run.control.stop_next;
        let rest = if stops { Vec::new() } else { self.breakpoints_at(spot) };
        let was = self.run.control.was.take().filter(|_| spot.when == When::After);
        self.ask(BreakpointScan { spot, branch, modes, rest, held: None, stops, was })
    }

    fn breakpoints_at(&mut self, spot: StopPoint) -> Vec<u64> {
        if self.run.control.breakpoints.is_empty() {
            return Vec::new();
        }
        let path = self.spot_path(spot);
        self.run
            .control
            .breakpoints
            .at(spot.when, |wanted| self.run.stands_at(self.program, path, wanted))
    }

    /// The place of a stop point's child.
    pub(in crate::engine) fn spot_path(&mut self, spot: StopPoint) -> PathId {
        if spot.is_root() { PathId(0) } else { self.child_path(spot.parent, spot.child) }
    }

    /// Evaluates the breakpoints of a stop point up to the first one with a condition. After the last breakpoint, it
    /// decides whether the branch is held.
    pub(in crate::engine) fn ask(&mut self, mut inquiry: BreakpointScan<D>) -> bool {
        while let Some(id) = inquiry.rest.pop() {
            let found = self.run.control.breakpoints.get(id).map(|found| found.condition.clone());
            match found {
                Some(Some(condition)) => {
                    self.inquire(inquiry, id, condition);
                    return false;
                }
                Some(None) => self.hit(&mut inquiry, id),
                None => {}
            }
        }
        self.ends_inquiry(&inquiry)
    }

    fn ends_inquiry(&mut self, inquiry: &BreakpointScan<D>) -> bool {
        let (spot, branch) = (inquiry.spot, inquiry.branch);
        if inquiry.stops {
            self.stand(spot, branch, HeldBy::Step);
            self.stop();
            return false;
        }
        let by = inquiry.held.or_else(|| self.held_otherwise(inquiry));
        let by = by.or_else(|| self.held_by_loss(inquiry));
        by.inspect(|by| self.hold(spot, branch, *by)).is_none()
    }

    /// Counts a hit of a breakpoint, and applies its effect.
    fn hit(&mut self, inquiry: &mut BreakpointScan<D>, id: u64) {
        let found = self.run.control.breakpoints.get(id);
        let Some(alone) = found.map(|found| self.run.control.unattended(found)) else { return };
        let Some((hits, breakpoint)) = self.run.control.breakpoints.hit(id) else { return };
        let (scope, counts) = (breakpoint.scope, hits >= breakpoint.hit_count);
        let held = counts && alone == Unattended::Hold;
        let path = self.spot_path(inquiry.spot);
        self.out.events.push(Event::Hit { breakpoint: id, path, hits, held });
        inquiry.stops |= counts && alone == Unattended::Stop;
        if held {
            inquiry.held = inquiry.held.or(Some(HeldBy::Breakpoint(id)));
            self.hold_more(inquiry.spot, inquiry.branch, scope, id);
        }
    }

    /// Makes the breakpoint's branch step, or pauses the run.
    fn hold_more(&mut self, spot: StopPoint, branch: BranchId, scope: Scope, id: u64) {
        match scope {
            Scope::Branch => self.step_from(spot.parent, branch),
            Scope::Run if self.run.status == Status::Running => {
                self.pause(true);
                self.run.control.paused_by = Some(id);
            }
            Scope::Run => {}
        }
    }

    /// Holds the branch if a lost-link policy requires it.
    fn held_by_loss(&mut self, inquiry: &BreakpointScan<D>) -> Option<HeldBy> {
        let loss = self.view().loss_at(inquiry.spot).filter(|_| inquiry.modes)?;
        self.step_from(inquiry.spot.parent, inquiry.branch);
        Some(HeldBy::Loss(loss))
    }

    /// Switches this branch to step mode, also inside a step over or out of a frame.
    fn step_from(&mut self, slot: u32, branch: BranchId) {
        self.run.branches.set(branch, true);
        let mut next = slot;
        while next != NONE && self.run.frames.get(next).branch == branch {
            let frame = self.run.frames.get_mut(next);
            frame.marker = None;
            next = frame.parent;
        }
    }

    /// The reason, besides breakpoints and policies, to hold at a stop point.
    fn held_otherwise(&mut self, inquiry: &BreakpointScan<D>) -> Option<HeldBy> {
        let spot = inquiry.spot;
        if spot.when == When::After {
            return None;
        }
        if self.reaches_run_to(spot) {
            self.run.control.run_to = None;
            self.step_all(true);
            return Some(HeldBy::RunTo);
        }
        if !inquiry.modes {
            return None;
        }
        if self.run.control.starting {
            return self.view().begins_at(spot).then_some(HeldBy::Start);
        }
        let is_decider = !spot.is_root() && self.view().is_decider(spot);
        match self.run.status {
            Status::Paused if !is_decider && !self.view().is_library_spot(spot) => {
                Some(HeldBy::Pause)
            }
            Status::Running if self.view().steps_at(spot, inquiry.branch) => Some(HeldBy::Step),
            Status::Idle
            | Status::Running
            | Status::Paused
            | Status::Stepping
            | Status::Stopping
            | Status::Finished => None,
        }
    }

    fn reaches_run_to(&mut self, spot: StopPoint) -> bool {
        if self.run.control.run_to.is_none() {
            return false;
        }
        let path = self.spot_path(spot);
        let wanted = self.run.control.run_to.as_ref();
        wanted.is_some_and(|wanted| self.run.stands_at(self.program, path, wanted))
    }

    /// Holds a branch at a stop point and reports it.
    pub(in crate::engine) fn hold(&mut self, spot: StopPoint, branch: BranchId, by: HeldBy) {
        let next = self.stand(spot, branch, by);
        let around = (!spot.is_root()).then(|| self.run.frames.get(spot.parent).path);
        let path = around.unwrap_or(PathId(0));
        self.out.events.push(Event::Held { path, next, by });
    }

    /// Holds a branch at a stop point and returns the next state, if it is known.
    fn stand(&mut self, spot: StopPoint, branch: BranchId, by: HeldBy) -> Option<PathId> {
        let next = self.next_at(spot);
        self.run.control.put(spot, branch, SuspendReason::Held { by, next });
        self.set_phase(spot, Phase::Held);
        next
    }

    fn set_phase(&mut self, spot: StopPoint, phase: Phase) {
        if !spot.is_root() && !self.view().is_branch(spot) {
            let frame = self.run.frames.get_mut(spot.parent);
            frame.phase = phase;
            frame.marker = None;
        }
    }

    fn next_at(&mut self, spot: StopPoint) -> Option<PathId> {
        let StopPoint { parent, child, when } = spot;
        match when {
            When::Before if child == NONE => None,
            When::Before => Some(self.spot_path(spot)),
            When::After if spot.is_root() => None,
            When::After => self.view().upcoming(parent).map(|child| self.child_path(parent, child)),
        }
    }

    fn inquire(&mut self, inquiry: BreakpointScan<D>, breakpoint: u64, condition: SmolStr) {
        let check = self.run.control.next_check();
        self.out_check(&inquiry, check, condition);
        let (spot, branch) = (inquiry.spot, inquiry.branch);
        let inquiry = Box::new(inquiry);
        self.run.control.put(spot, branch, SuspendReason::Checking { check, breakpoint, inquiry });
        self.set_phase(spot, Phase::Checking);
    }

    /// Accepts the result of a condition.
    pub(in crate::engine) fn checked(
        &mut self,
        check: u64,
        result: Result<bool, SmolStr>,
    ) -> Result<(), Refusal> {
        let refusal = Refusal::NoSuchCheck { check };
        let mut hold = self.run.control.take_check(check).ok_or(refusal)?;
        let SuspendReason::Checking { breakpoint, mut inquiry, .. } =
            std::mem::replace(&mut hold.why, SuspendReason::Held { by: HeldBy::Step, next: None })
        else {
            return Ok(());
        };
        if result.unwrap_or_else(|reason| self.bad_condition(hold.spot, breakpoint, reason)) {
            self.hit(&mut inquiry, breakpoint);
        }
        if self.ask(*inquiry) {
            self.go_past(hold.spot, hold.branch, false);
        }
        Ok(())
    }

    fn bad_condition(&mut self, spot: StopPoint, breakpoint: u64, reason: SmolStr) -> bool {
        let path = self.spot_path(spot);
        self.note(path, Level::Warning, Note::BadCondition { breakpoint, reason });
        true
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// True if the frame was asked to end, so that nothing is held there except before a handler.
    fn ends_anyway(&self, spot: StopPoint) -> bool {
        if spot.is_root() {
            return false;
        }
        let frame = self.run.frames.get(spot.parent);
        let is_handler = spot.when == When::Before && self.is_hierarchy(spot.parent);
        frame.children.winner().is_some() && spot.when == When::Before
            || frame.preempted && !is_handler
    }

    pub(in crate::engine) fn is_hierarchy(&self, slot: u32) -> bool {
        matches!(self.body(slot), Body::Hierarchy(_))
    }

    /// True if a run that begins held is held at this stop point. It is not held on the start path, nor before a
    /// library root that contains states, unless that root is the start itself.
    fn begins_at(&self, spot: StopPoint) -> bool {
        if spot.is_root() {
            return self.program.node(Program::<D>::ROOT).is_script();
        }
        let leads_on = self.start_depth(spot.parent, spot.child).is_some();
        let is_target = self.leads_to(spot.parent).is_some_and(|child| child == spot.child);
        !leads_on && (is_target || !self.is_library_spot(spot) || self.is_script_spot(spot))
    }

    fn is_script_spot(&self, spot: StopPoint) -> bool {
        let node = self.program.node(self.run.frames.get(spot.parent).node);
        let child = node.child(spot.child as usize);
        child.is_some_and(|child| self.program.node(child).is_script())
    }

    fn is_library_spot(&self, spot: StopPoint) -> bool {
        !spot.is_root() && matches!(self.body(spot.parent), Body::Library(_))
    }

    pub(in crate::engine) fn is_decider(&self, spot: StopPoint) -> bool {
        let Body::Concurrency(Concurrency::Barrier(decider), _) = self.body(spot.parent) else {
            return false;
        };
        *decider == Some(spot.child)
    }

    /// True if the child of this stop point has a branch of its own.
    pub(in crate::engine) fn is_branch(&self, spot: StopPoint) -> bool {
        let in_concurrency =
            !spot.is_root() && matches!(self.body(spot.parent), Body::Concurrency(..));
        in_concurrency && !self.is_decider(spot)
    }

    /// True if a branch in step mode is held here: in a hierarchy, outside of a step over or out.
    fn steps_at(&self, spot: StopPoint, branch: BranchId) -> bool {
        let in_hierarchy = !spot.is_root() && self.is_hierarchy(spot.parent);
        in_hierarchy && self.run.branches.steps(branch) && !self.is_passed_over(spot.parent)
    }
}

impl<D: Datum> crate::engine::Run<D> {
    /// The status of the run. It is stepping while any branch is in step mode.
    pub(in crate::engine) fn status(&self) -> Status {
        match self.status {
            Status::Running if self.branches.any_steps() => Status::Stepping,
            Status::Idle
            | Status::Running
            | Status::Paused
            | Status::Stepping
            | Status::Stopping
            | Status::Finished => self.status,
        }
    }

    /// True if nothing can hold the run anywhere.
    pub(in crate::engine) fn is_free(&self) -> bool {
        self.status == Status::Running && !self.branches.any_steps() && self.control.is_quiet()
    }

    /// True if the place has this path.
    fn stands_at(&self, program: &Program<D>, path: PathId, wanted: &StatePath) -> bool {
        let mut next = Some(path);
        for id in wanted.0.iter().rev() {
            let node = next.and_then(|path| self.places.node(path));
            if node.is_none_or(|node| program.node(node).id() != id) {
                return false;
            }
            next = next.and_then(|path| self.places.parent(path));
        }
        next.is_none()
    }
}
