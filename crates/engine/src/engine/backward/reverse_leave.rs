//! Leaves states backwards and restores the data around them from before they began.

use crate::engine::Status;
use crate::engine::state::frames::NONE;
use crate::engine::state::phase::{Cause, Phase};
use crate::engine::state::step::{Step, View, Work};
use crate::engine::state::suspended::{StopPoint, SuspendedBranch};
use crate::engine::state::undo_log::ReplacedValues;
use crate::program::{Body, Concurrency, Inside};
use crate::{BranchId, Datum, Effect, Event, HeldBy, WaitReason};
use std::collections::BTreeSet;
use std::num::NonZeroU64;

impl<D: Datum> Step<'_, D> {
    /// Leaves a state at its start backwards. The outermost state stays active and is held there.
    pub(in crate::engine) fn leave_back(&mut self, slot: u32) {
        let is_script = matches!(self.view().body(slot), Body::Script);
        if !is_script && self.view().is_outermost(slot) {
            return self.stand_at_start(slot);
        }
        self.end_held_branches(slot);
        self.say_left_back(slot);
        let frame = self.run.frames.get(slot);
        let (parent, branch) = (frame.parent, frame.branch);
        let child = self.program.node(frame.node).child_index;
        self.run.frames.remove(slot);
        self.run.frames.get_mut(parent).children.set_active(child, None);
        match self.view().body(parent) {
            Body::Script => {}
            Body::Hierarchy(_) => self.child_undone(parent),
            Body::Library(_) => self.leave_back_later(parent),
            Body::Concurrency(..) => self.branch_undone(parent, child, branch),
        }
    }

    fn stand_at_start(&mut self, slot: u32) {
        let branch = self.run.frames.get(slot).branch;
        match self.view().body(slot) {
            Body::Hierarchy(_) => {
                let child = self.view().upcoming(slot).unwrap_or(NONE);
                self.hold_back(StopPoint::before(slot, child), branch, HeldBy::Start);
            }
            Body::Library(_) => self.hold_back(StopPoint::before(slot, 0), branch, HeldBy::Start),
            Body::Concurrency(kind, _) => self.stand_without_branches(slot, *kind),
            Body::Script => {}
        }
    }

    /// Holds or waits at the start of a state that has no open branches. Open branches have holds of their own.
    fn stand_without_branches(&mut self, slot: u32, kind: Concurrency) {
        let frame = self.run.frames.get(slot);
        match kind {
            _ if frame.children.side_by_side().is_some_and(|children| children.open > 0) => {}
            Concurrency::Preemptive => self.wait(slot, WaitReason::NoChildren),
            Concurrency::Barrier(decider) => {
                let stop_point = StopPoint::before(slot, decider.unwrap_or(NONE));
                self.hold_back(stop_point, frame.branch, HeldBy::Start);
            }
        }
    }

    /// Holds a branch where a step back has brought it. A branch that was resumed meanwhile passes this stop point.
    pub(in crate::engine) fn hold_back(
        &mut self,
        stop_point: StopPoint,
        branch: BranchId,
        by: HeldBy,
    ) {
        self.hold(stop_point, branch, by);
        if !self.run.branches.steps(branch) {
            self.run.work.push(Work::Pass(self.run.control.newest()));
        }
    }

    /// Ends the branches that are held in a state that is left.
    fn end_held_branches(&mut self, slot: u32) {
        for SuspendedBranch { stop_point, branch, .. } in self.run.control.take_in(slot) {
            if self.view().is_branch(stop_point) {
                self.run.branches.end(branch);
                self.out.effects.push(Effect::EndBranch { branch });
            }
        }
    }

    /// Reports that a state was left backwards, without outputs.
    fn say_left_back(&mut self, slot: u32) {
        let (entry, outcome) = self.view().undone(slot);
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

    /// Restores the data of a hierarchy from before the undone child, and holds it there.
    pub(in crate::engine) fn child_undone(&mut self, slot: u32) {
        let frame = self.run.frames.get_mut(slot);
        if let Some(children) = frame.children.in_turn_mut() {
            let log = &mut children.undo_log;
            let popped = if std::mem::take(&mut log.undoing) { log.pop() } else { None };
            match popped {
                Some((entry, values)) => {
                    frame.last = entry.last;
                    frame.last_error = entry.error.map(|error| *error);
                    self.put_back(slot, values);
                }
                None => frame.last_error = children.handed_error.take(),
            }
        }
        self.run.frames.get_mut(slot).phase = Phase::Child;
        if self.view().goes_on(slot) {
            self.wake(&[slot], Cause::ChildEnded);
        } else {
            self.stand_back(slot);
        }
    }

    fn put_back(&mut self, slot: u32, values: ReplacedValues<D>) {
        let Body::Hierarchy(inside) = self.view().body(slot) else { return };
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

    /// Holds an undone branch at its start. The concurrency state is left when all branches are at their start.
    fn branch_undone(&mut self, slot: u32, child: u32, branch: BranchId) {
        if self.view().goes_on(slot) {
            return self.branch_never_begins(slot, branch);
        }
        self.hold_back(StopPoint::before(slot, child), branch, HeldBy::Start);
        if self.view().all_at_start(slot) && !self.view().is_outermost(slot) {
            self.leave_back_later(slot);
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// True if the frame was asked to end meanwhile, or the run is stopping.
    fn goes_on(&self, slot: u32) -> bool {
        self.run.frames.get(slot).preempted || self.run.status == Status::Stopping
    }
}
