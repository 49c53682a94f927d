//! Releases held branches: resume, steps forward, and the end of a step.

use crate::engine::state::frames::{Marker, NONE};
use crate::engine::state::phase::Cause;
use crate::engine::state::step::{Step, View, Work};
use crate::engine::state::suspended::{StopPoint, SuspendReason, SuspendedBranch};
use crate::engine::{Refusal, Status};
use crate::program::Body;
use crate::{BranchId, Datum, PathId, Stride, When};
use rafcon_model::StatePath;
use std::collections::BTreeMap;

impl<D: Datum> Step<'_, D> {
    /// Passes a stop point, after a hold there or because no breakpoint held the branch.
    pub(in crate::engine) fn go_past(
        &mut self,
        stop_point: StopPoint,
        branch: BranchId,
        was_held: bool,
    ) {
        let StopPoint { parent, child, when } = stop_point;
        match when {
            When::Before if stop_point.is_root() => self.enter_root(),
            When::After if stop_point.is_root() => self.finish(),
            When::Before if self.view().is_branch(stop_point) => {
                self.begin_branch(parent, child, branch);
            }
            When::After if self.view().is_branch(stop_point) => {
                self.branch_done(parent, child, branch);
            }
            When::Before | When::After => {
                let frame = self.run.frames.get_mut(parent);
                frame.pass = match when {
                    When::Before => Some(child),
                    When::After => was_held.then_some(NONE),
                };
                self.wake(&[parent], Cause::LetGo);
            }
        }
    }

    /// Passes the hold planned with [`Work::Pass`], if it still exists.
    pub(in crate::engine) fn pass(&mut self, id: u64) {
        if let Some(hold) = self.run.control.take(id) {
            self.go_past(hold.stop_point, hold.branch, true);
        }
    }

    fn pass_later(&mut self, holds: &[SuspendedBranch<D>]) {
        self.run.work.extend(holds.iter().rev().map(|hold| Work::Pass(hold.id)));
    }

    /// Ends a pause and all steps, or resumes one branch.
    pub(in crate::engine) fn resume(&mut self, branch: Option<&StatePath>) -> Result<(), Refusal> {
        let place = self.view().branch_place(branch)?;
        self.end_pause();
        match place {
            None => self.step_all(false),
            Some(place) => self.free_within(place),
        }
        if place.is_none() {
            self.run.control.run_to = None;
        }
        let held = self.view().held(place);
        for hold in &held {
            self.run.branches.set(hold.branch, false);
        }
        self.pass_later(&held);
        Ok(())
    }

    /// Resumes one branch and everything in it. If the run was paused, the other branches go step by step.
    fn free_within(&mut self, place: PathId) {
        for slot in self.view().active() {
            let frame = self.run.frames.get(slot);
            if self.run.is_below(frame.path, place) {
                self.run.branches.set(frame.branch, false);
            }
        }
    }

    /// Turns a pause into step mode.
    pub(in crate::engine) fn end_pause(&mut self) {
        if self.run.status == Status::Paused {
            self.pause(false);
            self.step_all(true);
        }
    }

    /// Holds each branch before its next state.
    pub(in crate::engine) fn step_mode(&mut self) {
        self.end_pause();
        self.step_all(true);
    }

    pub(in crate::engine) fn step_all(&mut self, steps: bool) {
        self.run.branches.set_all(steps);
        for slot in self.view().active() {
            self.run.frames.get_mut(slot).marker = None;
        }
    }

    /// Resumes all branches until one reaches this state.
    pub(in crate::engine) fn run_to(&mut self, path: StatePath) -> Result<(), Refusal> {
        self.program.find(&path)?;
        self.resume(None)?;
        self.run.control.run_to = Some(path);
        Ok(())
    }

    /// One step forward of all held branches, or of one.
    pub(in crate::engine) fn forward(
        &mut self,
        stride: Stride,
        branch: Option<&StatePath>,
    ) -> Result<(), Refusal> {
        let place = self.view().branch_place(branch)?;
        let held = self.view().held(place);
        if held.is_empty() {
            return Err(Refusal::NothingHeld { branch: branch.cloned() });
        }
        self.end_pause();
        self.run.control.run_to = None;
        for hold in &held {
            self.mark(hold, stride);
        }
        self.pass_later(&held);
        Ok(())
    }

    /// Marks the frame in which the step of this hold ends, and sets the mode of its branch.
    fn mark(&mut self, hold: &SuspendedBranch<D>, stride: Stride) {
        let stop_point = hold.stop_point;
        let runs_through = match stride {
            Stride::Into | Stride::Back => false,
            Stride::Over => stop_point.is_root() || self.view().is_branch(stop_point),
            Stride::Out => self.view().leads_out_of_all(stop_point),
        };
        self.run.branches.set(hold.branch, !runs_through);
        if stop_point.is_root() || self.view().is_branch(stop_point) {
            return;
        }
        self.run.frames.get_mut(stop_point.parent).marker = match stride {
            Stride::Over => Some(Marker::Over),
            Stride::Out => Some(Marker::Out),
            Stride::Into | Stride::Back => None,
        };
    }

    /// Releases what is held in a frame that is asked to end. Branches that have not begun never begin; ended branches
    /// count as done.
    pub(in crate::engine) fn release(&mut self, slot: u32) {
        for SuspendedBranch { stop_point, branch, .. } in self.run.control.take_in(slot) {
            match stop_point.when {
                _ if !self.view().is_branch(stop_point) => {}
                When::Before => self.branch_never_begins(slot, branch),
                When::After => self.branch_done(slot, stop_point.child, branch),
            }
        }
    }

    /// Notes whether a viewer is connected.
    pub(in crate::engine) fn attend(&mut self, attended: bool) {
        self.run.control.attended = attended;
        if !attended {
            self.leave_alone();
        }
    }

    /// Continues or stops what unattended breakpoints hold, as each breakpoint specifies.
    pub(in crate::engine) fn leave_alone(&mut self) {
        use crate::Unattended::{Continue, Stop};
        if !matches!(self.run.status, Status::Running | Status::Paused) {
            return;
        }
        let control = &self.run.control;
        let alone = |id| control.breakpoints.get(id).map(|found| control.unattended(found));
        let of = |hold: &SuspendedBranch<D>| match hold.why {
            SuspendReason::Held { by: crate::HeldBy::Breakpoint(id), .. } => alone(id),
            SuspendReason::Held { .. } | SuspendReason::Checking { .. } => None,
        };
        let paused_by = control.paused_by.and_then(alone);
        let held = self.view().held(None);
        if paused_by == Some(Stop) || held.iter().any(|hold| of(hold) == Some(Stop)) {
            return self.stop();
        }
        let go_on = held.into_iter().filter(|hold| of(hold) == Some(Continue)).collect::<Vec<_>>();
        if paused_by == Some(Continue) {
            self.go_on();
        }
        for hold in &go_on {
            self.run.branches.set(hold.branch, false);
        }
        self.pass_later(&go_on);
    }

    /// Ends a pause and releases what it held. Steps and breakpoints keep their holds.
    fn go_on(&mut self) {
        self.pause(false);
        let held = self.view().held(None);
        let by_pause = held.into_iter().filter(|hold| hold.by() == Some(crate::HeldBy::Pause));
        let by_pause = by_pause.collect::<Vec<_>>();
        self.pass_later(&by_pause);
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The held branches, all or those at and below a place, in the order of the machine.
    pub(in crate::engine) fn held(&self, within: Option<PathId>) -> Vec<SuspendedBranch<D>> {
        let active = self.active();
        let order: BTreeMap<u32, usize> = active.iter().copied().zip(1..).collect();
        let holds = self.run.control.holds.iter().filter(|hold| hold.by().is_some());
        let here = |hold: &&SuspendedBranch<D>| {
            within.is_none_or(|top| self.is_within(hold.stop_point, top))
        };
        let mut held: Vec<_> = holds.filter(here).cloned().collect();
        held.sort_by_key(|hold| {
            (order.get(&hold.stop_point.parent).copied(), hold.stop_point.child)
        });
        held
    }

    fn is_within(&self, stop_point: StopPoint, top: PathId) -> bool {
        if stop_point.is_root() {
            return false;
        }
        let around = self.run.frames.get(stop_point.parent).path;
        let begins = self.is_branch(stop_point)
            && self.run.places.child(around, stop_point.child as usize, self.program) == Some(top);
        begins || self.run.is_below(around, top)
    }

    /// The place of a branch, given by the path of an active child of a concurrency state.
    pub(in crate::engine) fn branch_place(
        &self,
        branch: Option<&StatePath>,
    ) -> Result<Option<PathId>, Refusal> {
        let Some(path) = branch else { return Ok(None) };
        let refusal = || Refusal::NoSuchBranch { path: path.clone() };
        let steps = self.program.descend(path)?.1;
        let (child, above) = steps.split_last().ok_or_else(refusal)?;
        let place = self.run.place(self.program, above).ok_or_else(refusal)?;
        let slot = self.frame_at(place).ok_or_else(refusal)?;
        if !self.is_branch(StopPoint::before(slot, *child)) {
            return Err(refusal());
        }
        Ok(self.run.places.child(place, *child as usize, self.program))
    }

    /// The frame of the active state at a place.
    pub(in crate::engine) fn frame_at(&self, place: PathId) -> Option<u32> {
        self.active().into_iter().find(|&slot| self.run.frames.get(slot).path == place)
    }

    /// True if nothing after the end of this container can hold the branch.
    fn leads_out_of_all(&self, stop_point: StopPoint) -> bool {
        if stop_point.is_root() || self.is_branch(stop_point) {
            return true;
        }
        let parent = self.run.frames.get(stop_point.parent).parent;
        parent == NONE
            || matches!(self.body(parent), Body::Library(_))
                && self.leads_out_of_all(StopPoint::before(parent, 0))
    }

    /// True if a step over or out is under way that holds before no child of this frame.
    pub(in crate::engine) fn is_passed_over(&self, slot: u32) -> bool {
        let frame = self.run.frames.get(slot);
        frame.marker == Some(Marker::Out) || self.is_inside_of_step(frame.parent, frame.branch)
    }

    /// True if a step over or out of this frame, or of one around it on its branch, is under way.
    pub(in crate::engine) fn is_inside_of_step(&self, slot: u32, branch: BranchId) -> bool {
        let mut next = slot;
        while next != NONE {
            let frame = self.run.frames.get(next);
            if frame.branch != branch {
                return false;
            }
            if frame.marker.is_some() {
                return true;
            }
            next = frame.parent;
        }
        false
    }
}

impl<D: Datum> crate::engine::Run<D> {
    /// True if a place is `top` or inside it.
    pub(in crate::engine) fn is_below(&self, place: PathId, top: PathId) -> bool {
        let mut next = Some(place);
        while let Some(place) = next {
            if place == top {
                return true;
            }
            next = self.places.parent(place);
        }
        false
    }
}
