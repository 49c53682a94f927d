//! Hierarchy states: one child after the other, as transitions say.

use super::frames::Ended;
use super::phase::{Cause, Phase};
use super::step::Step;
use super::{Status, frames};
use crate::program::{ABORTED, Exit, Inside, PREEMPTED};
use crate::{Datum, Event, WaitReason};

impl<'s, D: Datum> Step<'s, D> {
    /// Follows the transition of the child that ended last, or the start transition.
    pub(super) fn advance_hierarchy(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get(slot);
        if !frame.children.is_empty() {
            return;
        }
        let exit = match (frame.last, frame.start_depth) {
            (Some((child, outcome)), _) => self.exit(inside, child, outcome),
            (None, Some(depth)) => Exit::Child(self.run.start_from[depth as usize]),
            (None, None) => inside.start,
        };
        match exit {
            Exit::Outcome(outcome) => self.leave_container(slot, inside, outcome),
            Exit::Child(child) => self.go_to(slot, inside, child),
            Exit::Nowhere => self.nowhere(slot, inside),
        }
    }

    pub(super) fn exit(&self, inside: &Inside<D>, child: u32, outcome: u32) -> Exit {
        self.program.tables.exit(self.program.node(inside.child(child)).exits, outcome)
    }

    /// The next child, unless the hierarchy was preempted (only a handler, behind the outcome preempted, runs then, and
    /// none after a second stop) or a pause holds it.
    fn go_to(&mut self, slot: u32, inside: &'s Inside<D>, child: u32) {
        let frame = self.run.frames.get_mut(slot);
        let is_handler = frame.last.is_some_and(|(_, outcome)| outcome == PREEMPTED);
        if frame.preempted && (!is_handler || self.run.stopped_twice) {
            self.leave_container(slot, inside, PREEMPTED);
        } else if self.run.status == Status::Paused {
            frame.phase = Phase::Held;
        } else {
            frame.phase = Phase::Child;
            self.enter(slot, child);
        }
    }

    /// There is no transition: aborted and preempted go up, anything else waits.
    pub(super) fn nowhere(&mut self, slot: u32, inside: &'s Inside<D>) {
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

    pub(super) fn wait(&mut self, slot: u32, reason: WaitReason) {
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Waiting(reason.clone());
        self.out.events.push(Event::Waiting { path: frame.path, reason });
    }

    /// A child of a hierarchy ended.
    pub(super) fn child_of_hierarchy_ended(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        child: u32,
        ended: Ended<D>,
    ) {
        self.store_outputs(slot, inside, child, &ended);
        let frame: &mut frames::Frame<D> = self.run.frames.get_mut(slot);
        frame.children.clear();
        frame.last = Some((child, ended.outcome));
        frame.last_error = ended.error.filter(|_| ended.outcome == ABORTED);
        if self.runs_in_a_circle(slot, inside) {
            self.run.frames.get_mut(slot).last_error.clone_from(&self.program.circle);
            return self.leave_container_later(slot, inside, ABORTED);
        }
        self.wake(&[slot], Cause::ChildEnded);
    }

    /// Whether more children ended within one answer than there are ways for a child to end: then no script runs between
    /// them, nothing can ever change, and the circle would go on for good.
    fn runs_in_a_circle(&mut self, slot: u32, inside: &Inside<D>) -> bool {
        let frame = self.run.frames.get_mut(slot);
        if frame.turn != self.run.turn {
            (frame.turn, frame.steps) = (self.run.turn, 0);
        }
        frame.steps += 1;
        frame.steps > inside.exits
    }
}
