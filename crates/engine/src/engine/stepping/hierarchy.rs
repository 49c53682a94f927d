//! Hierarchy states: they run one child after the other and follow transitions.

use crate::engine::state::frames::EndedChild;
use crate::engine::state::phase::{Cause, Phase};
use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::StopPoint;
use crate::program::{ABORTED, Body, Exit, Inside, PREEMPTED};
use crate::{Datum, Event, WaitReason};

impl<'s, D: Datum> Step<'s, D> {
    /// Follows the transition of the child that ended last, or the start transition.
    pub(in crate::engine) fn advance_hierarchy(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get(slot);
        if frame.children.any_active() || !self.passes_end(slot) {
            return;
        }
        match self.view().next_exit(slot, inside) {
            Exit::Outcome(outcome) => self.leave_container(slot, inside, outcome),
            Exit::Child(child) => self.go_to(slot, inside, child),
            Exit::Nowhere => self.nowhere(slot, inside),
        }
    }

    /// True if nothing holds the container after the child that ended last.
    pub(in crate::engine) fn passes_end(&mut self, slot: u32) -> bool {
        let frame = self.run.frames.get_mut(slot);
        let (branch, last) = (frame.branch, frame.last);
        if !std::mem::take(&mut frame.after) {
            return true;
        }
        last.is_none_or(|(child, _)| self.passes(StopPoint::after(slot, child), branch))
    }

    /// Enters the next child, unless the hierarchy is held or preempted. After a preemption only a handler runs, which
    /// follows the outcome *preempted*; after a second stop, not even that.
    fn go_to(&mut self, slot: u32, inside: &'s Inside<D>, child: u32) {
        let frame = self.run.frames.get_mut(slot);
        let is_handler = frame.last.is_some_and(|(_, outcome)| outcome == PREEMPTED);
        let pass = frame.pass.take();
        if frame.preempted && (!is_handler || self.run.stopped_twice) {
            self.leave_container(slot, inside, PREEMPTED);
        } else if self.passes_to(slot, child, pass) {
            self.run.frames.get_mut(slot).phase = Phase::Child;
            self.enter(slot, child);
        }
    }

    /// True if nothing holds the frame before this child. A hold that was released there does not apply again.
    pub(in crate::engine) fn passes_to(
        &mut self,
        slot: u32,
        child: u32,
        pass: Option<u32>,
    ) -> bool {
        let branch = self.run.frames.get(slot).branch;
        let stop_point = StopPoint::before(slot, child);
        match pass {
            None => self.passes(stop_point, branch),
            Some(passed) => passed == child || self.passes_breakpoints(stop_point, branch),
        }
    }

    /// Handles an outcome without a transition: *aborted* and *preempted* propagate, any other outcome waits.
    pub(in crate::engine) fn nowhere(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get(slot);
        match frame.last {
            _ if frame.preempted => self.leave_container(slot, inside, PREEMPTED),
            Some((_, ABORTED)) => self.leave_container(slot, inside, ABORTED),
            Some((_, PREEMPTED)) => self.leave_container(slot, inside, PREEMPTED),
            Some((child, outcome)) => {
                let id = self.program.node(inside.child(child)).outcome_id(outcome);
                let child = self.child_path(slot, child);
                self.wait(slot, WaitReason::NoTransition { child, outcome: id });
            }
            None => self.wait(slot, WaitReason::NoStart),
        }
    }

    pub(in crate::engine) fn wait(&mut self, slot: u32, reason: WaitReason) {
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Waiting(reason.clone());
        self.out.events.push(Event::Waiting { path: frame.path, reason });
        if self.run.control.stop_next {
            self.stop();
        }
    }

    /// Records the end of a hierarchy's child.
    pub(in crate::engine) fn child_of_hierarchy_ended(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        child: u32,
        end: EndedChild<D>,
    ) {
        let EndedChild { ended, run } = end;
        let children = self.run.frames.get(slot).children.in_turn();
        let first = children.map_or(0, |children| children.undo_log.undo.len());
        self.store_outputs(slot, inside, child, &ended);
        if let Some(run) = run {
            self.log_end(slot, child, run, first);
        }
        let frame = self.run.frames.get_mut(slot);
        frame.children.set_active(child, None);
        frame.after = true;
        frame.last = Some((child, ended.outcome));
        frame.last_error = ended.error.filter(|_| ended.outcome == ABORTED);
        if self.runs_in_a_circle(slot, inside) {
            self.run.frames.get_mut(slot).last_error.clone_from(&self.program.circle);
            return self.leave_container_later(slot, inside, ABORTED);
        }
        self.wake(&[slot], Cause::ChildEnded);
    }

    /// True if more children ended in one call than the children have outcomes. Then no script runs between them,
    /// nothing can change, and the circle would never end.
    fn runs_in_a_circle(&mut self, slot: u32, inside: &Inside<D>) -> bool {
        let Some(children) = self.run.frames.get_mut(slot).children.in_turn_mut() else {
            return false;
        };
        if children.turn != self.run.turn {
            (children.turn, children.steps) = (self.run.turn, 0);
        }
        children.steps += 1;
        children.steps > inside.exits
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The exit that a hierarchy takes now.
    pub(in crate::engine) fn next_exit(&self, slot: u32, inside: &Inside<D>) -> Exit {
        let frame = self.run.frames.get(slot);
        match (frame.last, self.leads_to(slot)) {
            (Some((child, outcome)), _) => self.exit(inside, child, outcome),
            (None, Some(child)) => Exit::Child(child),
            (None, None) => inside.start,
        }
    }

    /// The next child of a hierarchy.
    pub(in crate::engine) fn upcoming(&self, slot: u32) -> Option<u32> {
        let Body::Hierarchy(inside) = self.body(slot) else { return None };
        match self.next_exit(slot, inside) {
            Exit::Child(child) => Some(child),
            Exit::Outcome(_) | Exit::Nowhere => None,
        }
    }

    pub(in crate::engine) fn exit(&self, inside: &Inside<D>, child: u32, outcome: u32) -> Exit {
        self.program.tables.exit(self.program.node(inside.child(child)).exits, outcome)
    }
}
