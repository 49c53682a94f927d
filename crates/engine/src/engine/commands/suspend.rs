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
    pub(in crate::engine) fn passes(&mut self, stop_point: StopPoint, branch: BranchId) -> bool {
        self.run.is_free() || self.passes_gates(stop_point, branch, true)
    }

    /// As [`Self::passes`], but only breakpoints count, because the branch was just released from a hold.
    pub(in crate::engine) fn passes_breakpoints(
        &mut self,
        stop_point: StopPoint,
        branch: BranchId,
    ) -> bool {
        self.run.is_free() || self.passes_gates(stop_point, branch, false)
    }

    /// As [`Self::passes`], for a state that had ended before the run was lost: its breakpoints were already counted.
    pub(in crate::engine) fn passes_again(
        &mut self,
        stop_point: StopPoint,
        branch: BranchId,
    ) -> bool {
        if self.run.is_free()
            || self.run.status == Status::Stopping
            || self.view().ends_anyway(stop_point)
        {
            return true;
        }
        let (rest, held) = (Vec::new(), None);
        self.continue_scan(BreakpointScan {
            stop_point,
            branch,
            modes: true,
            rest,
            held,
            stops: false,
            was: None,
        })
    }

    fn passes_gates(&mut self, stop_point: StopPoint, branch: BranchId, modes: bool) -> bool {
        if self.run.status == Status::Stopping || self.view().ends_anyway(stop_point) {
            return true;
        }
        let stops = stop_point.when == When::Before && self.run.control.stop_next;
        let rest = if stops { Vec::new() } else { self.breakpoints_at(stop_point) };
        let was = self.run.control.was.take().filter(|_| stop_point.when == When::After);
        self.continue_scan(BreakpointScan {
            stop_point,
            branch,
            modes,
            rest,
            held: None,
            stops,
            was,
        })
    }

    fn breakpoints_at(&mut self, stop_point: StopPoint) -> Vec<u64> {
        if self.run.control.breakpoints.is_empty() {
            return Vec::new();
        }
        let path = self.stop_point_path(stop_point);
        self.run
            .control
            .breakpoints
            .at(stop_point.when, |wanted| self.run.is_at(self.program, path, wanted))
    }

    /// The place of a stop point's child.
    pub(in crate::engine) fn stop_point_path(&mut self, stop_point: StopPoint) -> PathId {
        if stop_point.is_root() {
            PathId(0)
        } else {
            self.child_path(stop_point.parent, stop_point.child)
        }
    }

    /// Evaluates the breakpoints of a stop point up to the first one with a condition. After the last breakpoint, it
    /// decides whether the branch is held.
    pub(in crate::engine) fn continue_scan(&mut self, mut scan: BreakpointScan<D>) -> bool {
        while let Some(id) = scan.rest.pop() {
            let found = self.run.control.breakpoints.get(id).map(|found| found.condition.clone());
            match found {
                Some(Some(condition)) => {
                    self.start_check(scan, id, condition);
                    return false;
                }
                Some(None) => self.hit(&mut scan, id),
                None => {}
            }
        }
        self.finish_scan(&scan)
    }

    fn finish_scan(&mut self, scan: &BreakpointScan<D>) -> bool {
        let (stop_point, branch) = (scan.stop_point, scan.branch);
        if scan.stops {
            self.suspend(stop_point, branch, HeldBy::Step);
            self.stop();
            return false;
        }
        let by = scan.held.or_else(|| self.held_otherwise(scan));
        let by = by.or_else(|| self.held_by_loss(scan));
        by.inspect(|by| self.hold(stop_point, branch, *by)).is_none()
    }

    /// Counts a hit of a breakpoint, and applies its effect.
    fn hit(&mut self, scan: &mut BreakpointScan<D>, id: u64) {
        let found = self.run.control.breakpoints.get(id);
        let Some(alone) = found.map(|found| self.run.control.unattended(found)) else { return };
        let Some((hits, breakpoint)) = self.run.control.breakpoints.hit(id) else { return };
        let (scope, counts) = (breakpoint.scope, hits >= breakpoint.hit_count);
        let held = counts && alone == Unattended::Hold;
        let path = self.stop_point_path(scan.stop_point);
        self.out.events.push(Event::Hit { breakpoint: id, path, hits, held });
        scan.stops |= counts && alone == Unattended::Stop;
        if held {
            scan.held = scan.held.or(Some(HeldBy::Breakpoint(id)));
            self.hold_more(scan.stop_point, scan.branch, scope, id);
        }
    }

    /// Makes the breakpoint's branch step, or pauses the run.
    fn hold_more(&mut self, stop_point: StopPoint, branch: BranchId, scope: Scope, id: u64) {
        match scope {
            Scope::Branch => self.step_from(stop_point.parent, branch),
            Scope::Run if self.run.status == Status::Running => {
                self.pause(true);
                self.run.control.paused_by = Some(id);
            }
            Scope::Run => {}
        }
    }

    /// Holds the branch if a lost-link policy requires it.
    fn held_by_loss(&mut self, scan: &BreakpointScan<D>) -> Option<HeldBy> {
        let loss = self.view().loss_at(scan.stop_point).filter(|_| scan.modes)?;
        self.step_from(scan.stop_point.parent, scan.branch);
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
    fn held_otherwise(&mut self, scan: &BreakpointScan<D>) -> Option<HeldBy> {
        let stop_point = scan.stop_point;
        if stop_point.when == When::After {
            return None;
        }
        if self.reaches_run_to(stop_point) {
            self.run.control.run_to = None;
            self.step_all(true);
            return Some(HeldBy::RunTo);
        }
        if !scan.modes {
            return None;
        }
        if self.run.control.starting {
            return self.view().begins_at(stop_point).then_some(HeldBy::Start);
        }
        let is_decider = !stop_point.is_root() && self.view().is_decider(stop_point);
        match self.run.status {
            Status::Paused if !is_decider && !self.view().is_library_stop_point(stop_point) => {
                Some(HeldBy::Pause)
            }
            Status::Running if self.view().steps_at(stop_point, scan.branch) => Some(HeldBy::Step),
            Status::Idle
            | Status::Running
            | Status::Paused
            | Status::Stepping
            | Status::Stopping
            | Status::Finished => None,
        }
    }

    fn reaches_run_to(&mut self, stop_point: StopPoint) -> bool {
        if self.run.control.run_to.is_none() {
            return false;
        }
        let path = self.stop_point_path(stop_point);
        let wanted = self.run.control.run_to.as_ref();
        wanted.is_some_and(|wanted| self.run.is_at(self.program, path, wanted))
    }

    /// Holds a branch at a stop point and reports it.
    pub(in crate::engine) fn hold(&mut self, stop_point: StopPoint, branch: BranchId, by: HeldBy) {
        let next = self.suspend(stop_point, branch, by);
        let around = (!stop_point.is_root()).then(|| self.run.frames.get(stop_point.parent).path);
        let path = around.unwrap_or(PathId(0));
        self.out.events.push(Event::Held { path, next, by });
    }

    /// Holds a branch at a stop point and returns the next state, if it is known.
    fn suspend(&mut self, stop_point: StopPoint, branch: BranchId, by: HeldBy) -> Option<PathId> {
        let next = self.next_at(stop_point);
        self.run.control.put(stop_point, branch, SuspendReason::Held { by, next });
        self.set_phase(stop_point, Phase::Held);
        next
    }

    fn set_phase(&mut self, stop_point: StopPoint, phase: Phase) {
        if !stop_point.is_root() && !self.view().is_branch(stop_point) {
            let frame = self.run.frames.get_mut(stop_point.parent);
            frame.phase = phase;
            frame.marker = None;
        }
    }

    fn next_at(&mut self, stop_point: StopPoint) -> Option<PathId> {
        let StopPoint { parent, child, when } = stop_point;
        match when {
            When::Before if child == NONE => None,
            When::Before => Some(self.stop_point_path(stop_point)),
            When::After if stop_point.is_root() => None,
            When::After => self.view().upcoming(parent).map(|child| self.child_path(parent, child)),
        }
    }

    fn start_check(&mut self, scan: BreakpointScan<D>, breakpoint: u64, condition: SmolStr) {
        let check = self.run.control.next_check();
        self.out_check(&scan, check, condition);
        let (stop_point, branch) = (scan.stop_point, scan.branch);
        let scan = Box::new(scan);
        self.run.control.put(
            stop_point,
            branch,
            SuspendReason::Checking { check, breakpoint, scan },
        );
        self.set_phase(stop_point, Phase::Checking);
    }

    /// Accepts the result of a condition.
    pub(in crate::engine) fn checked(
        &mut self,
        check: u64,
        result: Result<bool, SmolStr>,
    ) -> Result<(), Refusal> {
        let refusal = Refusal::NoSuchCheck { check };
        let mut hold = self.run.control.take_check(check).ok_or(refusal)?;
        let SuspendReason::Checking { breakpoint, mut scan, .. } =
            std::mem::replace(&mut hold.why, SuspendReason::Held { by: HeldBy::Step, next: None })
        else {
            return Ok(());
        };
        if result.unwrap_or_else(|reason| self.bad_condition(hold.stop_point, breakpoint, reason)) {
            self.hit(&mut scan, breakpoint);
        }
        if self.continue_scan(*scan) {
            self.go_past(hold.stop_point, hold.branch, false);
        }
        Ok(())
    }

    fn bad_condition(&mut self, stop_point: StopPoint, breakpoint: u64, reason: SmolStr) -> bool {
        let path = self.stop_point_path(stop_point);
        self.note(path, Level::Warning, Note::BadCondition { breakpoint, reason });
        true
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// True if the frame was asked to end, so that nothing is held there except before a handler.
    fn ends_anyway(&self, stop_point: StopPoint) -> bool {
        if stop_point.is_root() {
            return false;
        }
        let frame = self.run.frames.get(stop_point.parent);
        let is_handler = stop_point.when == When::Before && self.is_hierarchy(stop_point.parent);
        frame.children.winner().is_some() && stop_point.when == When::Before
            || frame.preempted && !is_handler
    }

    pub(in crate::engine) fn is_hierarchy(&self, slot: u32) -> bool {
        matches!(self.body(slot), Body::Hierarchy(_))
    }

    /// True if a run that begins held is held at this stop point. It is not held on the start path, nor before a
    /// library root that contains states, unless that root is the start itself.
    fn begins_at(&self, stop_point: StopPoint) -> bool {
        if stop_point.is_root() {
            return self.program.node(Program::<D>::ROOT).is_script();
        }
        let leads_on = self.start_depth(stop_point.parent, stop_point.child).is_some();
        let is_target =
            self.leads_to(stop_point.parent).is_some_and(|child| child == stop_point.child);
        !leads_on
            && (is_target
                || !self.is_library_stop_point(stop_point)
                || self.is_script_stop_point(stop_point))
    }

    fn is_script_stop_point(&self, stop_point: StopPoint) -> bool {
        let node = self.program.node(self.run.frames.get(stop_point.parent).node);
        let child = node.child(stop_point.child as usize);
        child.is_some_and(|child| self.program.node(child).is_script())
    }

    fn is_library_stop_point(&self, stop_point: StopPoint) -> bool {
        !stop_point.is_root() && matches!(self.body(stop_point.parent), Body::Library(_))
    }

    pub(in crate::engine) fn is_decider(&self, stop_point: StopPoint) -> bool {
        let Body::Concurrency(Concurrency::Barrier(decider), _) = self.body(stop_point.parent)
        else {
            return false;
        };
        *decider == Some(stop_point.child)
    }

    /// True if the child of this stop point has a branch of its own.
    pub(in crate::engine) fn is_branch(&self, stop_point: StopPoint) -> bool {
        let in_concurrency =
            !stop_point.is_root() && matches!(self.body(stop_point.parent), Body::Concurrency(..));
        in_concurrency && !self.is_decider(stop_point)
    }

    /// True if a branch in step mode is held here: in a hierarchy, outside of a step over or out.
    fn steps_at(&self, stop_point: StopPoint, branch: BranchId) -> bool {
        let in_hierarchy = !stop_point.is_root() && self.is_hierarchy(stop_point.parent);
        in_hierarchy && self.run.branches.steps(branch) && !self.is_passed_over(stop_point.parent)
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
    fn is_at(&self, program: &Program<D>, path: PathId, wanted: &StatePath) -> bool {
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
