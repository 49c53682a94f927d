//! Leaving states backwards: the data around them is what it was before they began.

use crate::engine::Status;
use crate::engine::state::frames::NONE;
use crate::engine::state::phase::{Cause, Phase};
use crate::engine::state::step::Step;
use crate::engine::state::suspended::{StopPoint, SuspendedBranch};
use crate::engine::state::undo_log::ReplacedValues;
use crate::program::{Body, Concurrency, Inside};
use crate::{BranchId, Datum, Effect, Event, HeldBy, WaitReason};
use std::collections::BTreeSet;
use std::num::NonZeroU64;

impl<D: Datum> Step<'_, D> {
    /// Leaves a state backwards that is at its start. Whoever is outermost stays, and is held there.
    pub(in crate::engine) fn leave_back(&mut self, slot: u32) {
        let is_script = matches!(self.body(slot), Body::Script);
        if !is_script && self.is_outermost(slot) {
            return self.stand_at_start(slot);
        }
        self.end_held_branches(slot);
        self.say_left_back(slot);
        let frame = self.run.frames.get(slot);
        let (parent, branch) = (frame.parent, frame.branch);
        let child = self.program.node(frame.node).child_index;
        self.run.frames.remove(slot);
        match self.body(parent) {
            Body::Script => {}
            Body::Hierarchy(_) => {
                self.run.frames.get_mut(parent).children.clear();
                self.child_undone(parent);
            }
            Body::Library(_) => {
                self.run.frames.get_mut(parent).children.clear();
                self.leave_back_later(parent);
            }
            Body::Concurrency(..) => {
                self.run.frames.get_mut(parent).children[child as usize] = NONE;
                self.branch_undone(parent, child, branch);
            }
        }
    }

    fn stand_at_start(&mut self, slot: u32) {
        let branch = self.run.frames.get(slot).branch;
        match self.body(slot) {
            Body::Hierarchy(_) => {
                let child = self.upcoming(slot).unwrap_or(NONE);
                self.hold(StopPoint::before(slot, child), branch, HeldBy::Start);
            }
            Body::Library(_) => self.hold(StopPoint::before(slot, 0), branch, HeldBy::Start),
            Body::Concurrency(kind, _) => self.stand_without_branches(slot, *kind),
            Body::Script => {}
        }
    }

    /// Branches are held by themselves; where there are none, the state is.
    fn stand_without_branches(&mut self, slot: u32, kind: Concurrency) {
        let frame = self.run.frames.get(slot);
        match kind {
            _ if frame.open > 0 => {}
            Concurrency::Preemptive => self.wait(slot, WaitReason::NoChildren),
            Concurrency::Barrier(decider) => {
                let spot = StopPoint::before(slot, decider.unwrap_or(NONE));
                self.hold(spot, frame.branch, HeldBy::Start);
            }
        }
    }

    /// Whatever is held in a state that is left, its branches end.
    fn end_held_branches(&mut self, slot: u32) {
        for SuspendedBranch { spot, branch, .. } in self.run.control.take_in(slot) {
            if self.is_branch(spot) {
                self.run.branches.end(branch);
                self.out.effects.push(Effect::EndBranch { branch });
            }
        }
    }

    /// It gives nothing.
    fn say_left_back(&mut self, slot: u32) {
        let (entry, outcome) = self.undone(slot);
        let frame = self.run.frames.get(slot);
        let about = self.program.node(frame.node);
        let count = about.outputs.len();
        let absent = (0..crate::program::index(count)).collect::<Box<[u32]>>();
        self.out.events.push(Event::Left {
            path: frame.path,
            node: frame.node,
            outcome: about.outcome_id(outcome),
            outputs: std::iter::repeat_n(D::none(), count).collect(),
            absent: (count > 0).then_some(absent),
            error: None,
            undoes: NonZeroU64::new(entry),
        });
    }

    /// A child of a hierarchy was undone: its data is what it was before, and it is held there.
    pub(in crate::engine) fn child_undone(&mut self, slot: u32) {
        let frame = self.run.frames.get_mut(slot);
        let popped =
            if std::mem::take(&mut frame.trail.undoing) { frame.trail.pop() } else { None };
        match popped {
            Some((trace, values)) => {
                frame.last = trace.last;
                frame.last_error = trace.error.map(|error| *error);
                self.put_back(slot, values);
            }
            None => frame.last_error = frame.gave.take(),
        }
        self.run.frames.get_mut(slot).phase = Phase::Child;
        if self.goes_on(slot) {
            self.wake(&[slot], Cause::ChildEnded);
        } else {
            self.stand_back(slot);
        }
    }

    /// What was asked to end meanwhile ends.
    fn goes_on(&self, slot: u32) -> bool {
        self.run.frames.get(slot).preempted || self.run.status == Status::Stopping
    }

    fn put_back(&mut self, slot: u32, values: ReplacedValues<D>) {
        let Body::Hierarchy(inside) = self.body(slot) else { return };
        let frame = self.run.frames.get_mut(slot);
        let mut changed = BTreeSet::new();
        for (target, value) in values {
            if let Some(place) = frame.slots.get_mut(target as usize) {
                *place = value;
                changed.insert(target);
            }
        }
        for target in changed {
            self.say_variable(slot, inside, target);
        }
    }

    fn say_variable(&mut self, slot: u32, inside: &Inside<D>, target: u32) {
        let frame = self.run.frames.get(slot);
        let first = self.program.node(frame.node).inputs.len();
        let variable = (target as usize).checked_sub(first);
        let scoped = variable.and_then(|index| inside.scoped.get(index));
        let value = frame.slots.get(target as usize).and_then(|slot| slot.value.clone());
        if let Some((scoped, value)) = scoped.zip(value) {
            let (path, port) = (frame.path, scoped.port.id);
            self.out.events.push(Event::Scoped { path, port, value });
        }
    }

    /// A branch is at its start. When all are, the concurrency state is left.
    fn branch_undone(&mut self, slot: u32, child: u32, branch: BranchId) {
        if self.goes_on(slot) {
            return self.branch_never_begins(slot, branch);
        }
        self.hold(StopPoint::before(slot, child), branch, HeldBy::Start);
        if self.all_at_start(slot) && !self.is_outermost(slot) {
            self.leave_back_later(slot);
        }
    }
}
