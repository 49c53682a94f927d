//! Forced outcomes: for a state that waits or is held, or for a state before which a branch is held.

use crate::engine::Refusal;
use crate::engine::state::frames::{Ended, EndedChild};
use crate::engine::state::phase::{Cause, Phase};
use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::{StopPoint, SuspendReason, SuspendedBranch};
use crate::engine::state::undo_log::EndedRun;
use crate::program::{ABORTED, Body, Concurrency, Inside, Node};
use crate::{Datum, Effect, Event, PathId, When};
use rafcon_model::{OutcomeId, StatePath};

impl<'s, D: Datum> Step<'s, D> {
    pub(in crate::engine) fn force(
        &mut self,
        path: &StatePath,
        outcome: OutcomeId,
    ) -> Result<(), Refusal> {
        let (node, steps) = self.program.descend(path)?;
        let refusal = || Refusal::NoSuchOutcome { path: path.clone(), outcome };
        let index = self.program.node(node).outcome_index(outcome.0).ok_or_else(refusal)?;
        let place = self.run.place(self.program, &steps);
        let cannot = |reason| Refusal::CannotForce { path: path.clone(), reason };
        let nowhere = "it is not active, and nothing is held before it";
        let place = place.ok_or_else(|| cannot(nowhere))?;
        if let Some(slot) = self.view().frame_at(place) {
            return self.force_end(slot, outcome, index).map_err(cannot);
        }
        let hold = self.take_hold_before(place).ok_or_else(|| cannot(nowhere))?;
        self.out.events.push(Event::Forced { path: place, outcome });
        self.skip(&hold, index);
        Ok(())
    }

    /// Ends a held or waiting state.
    fn force_end(&mut self, slot: u32, outcome: OutcomeId, index: u32) -> Result<(), &'static str> {
        self.view().stands_still(slot)?;
        let path = self.run.frames.get(slot).path;
        self.out.events.push(Event::Forced { path, outcome });
        for SuspendedBranch { stop_point, branch, .. } in self.run.control.take_in(slot) {
            if self.view().is_branch(stop_point) {
                self.run.branches.end(branch);
                self.out.effects.push(Effect::EndBranch { branch });
            }
        }
        let frame = self.run.frames.get_mut(slot);
        frame.last_error = frame.last_error.take().filter(|_| index == ABORTED);
        let node = self.program.node(frame.node);
        match &node.body {
            Body::Hierarchy(inside) | Body::Concurrency(_, inside) => {
                self.leave_container(slot, inside, index);
            }
            Body::Library(_) => {
                let frame = self.run.frames.get_mut(slot);
                if let Some(root) = frame.children.library() {
                    root.end = None;
                }
                let outputs = frame.outputs.take();
                let outputs = outputs.unwrap_or_else(|| node.outputs.clone());
                let ended = Ended { outcome: index, outputs, absent: Vec::new(), error: None };
                self.leave(slot, ended);
            }
            Body::Script => self.leave(slot, without_outputs(node, index)),
        }
        Ok(())
    }

    /// Removes the hold before the state at this place.
    fn take_hold_before(&mut self, place: PathId) -> Option<SuspendedBranch<D>> {
        let before = |hold: &&SuspendedBranch<D>| match hold.why {
            SuspendReason::Held { .. } if hold.stop_point.when == When::Before => {
                self.view().place_at(hold.stop_point) == Some(place)
            }
            SuspendReason::Held { .. } | SuspendReason::Checking { .. } => false,
        };
        let id = self.run.control.holds.iter().find(before)?.id;
        self.run.control.take(id)
    }

    /// Skips a state as if it had ended by this outcome, without outputs.
    fn skip(&mut self, hold: &SuspendedBranch<D>, outcome: u32) {
        let StopPoint { parent, child, .. } = hold.stop_point;
        if hold.stop_point.is_root() {
            self.run.finish = Some(Box::new(self.view().unbegun(outcome)));
            return self.finish();
        }
        let run = self.view().keeps_undo_log().then(|| EndedRun::skipped(outcome));
        match self.view().body(parent) {
            Body::Script => {}
            Body::Hierarchy(_) => {
                let frame = self.run.frames.get_mut(parent);
                let Some(children) = frame.children.in_turn_mut() else { return };
                children.handed_error = frame.last_error.take();
                let first = children.undo_log.undo.len();
                if let Some(run) = run {
                    self.log_end(parent, child, run, first);
                }
                self.run.frames.get_mut(parent).last = Some((child, outcome));
                self.wake(&[parent], Cause::LetGo);
            }
            Body::Library(content) => {
                let Some(root) = content.root() else { return };
                let outputs = self.view().root_outputs(parent, content, self.program.node(root));
                let ended = Ended { outcome, outputs, absent: Vec::new(), error: None };
                self.library_root_ended(parent, content, EndedChild { ended, run });
            }
            Body::Concurrency(kind, inside) => self.skip_branch(hold, *kind, inside, outcome),
        }
    }

    fn skip_branch(
        &mut self,
        hold: &SuspendedBranch<D>,
        kind: Concurrency,
        inside: &'s Inside<D>,
        outcome: u32,
    ) {
        let StopPoint { parent, child, .. } = hold.stop_point;
        let ended = without_outputs(self.program.node(inside.child(child)), outcome);
        let decides = kind.decider() == Some(child);
        let frame = self.run.frames.get_mut(parent);
        if let Some(children) = frame.children.side_by_side_mut() {
            children.end(child, ended, (!decides).then(|| EndedRun::skipped(outcome)));
        }
        if decides {
            frame.last = Some((child, outcome));
            self.wake(&[parent], Cause::LetGo);
        } else {
            self.branch_done(parent, child, hold.branch);
        }
    }

    /// Asks an active state and everything in it to end.
    pub(in crate::engine) fn preempt_at(&mut self, path: &StatePath) -> Result<(), Refusal> {
        let steps = self.program.descend(path)?.1;
        let place = self.run.place(self.program, &steps);
        let slot = place.and_then(|place| self.view().frame_at(place));
        let slot = slot.ok_or_else(|| Refusal::NotActive { path: path.clone() })?;
        let frames = self.run.frames.below(slot);
        self.preempt(&frames);
        Ok(())
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// Refuses a state that continues by itself.
    fn stands_still(&self, slot: u32) -> Result<(), &'static str> {
        let frame = self.run.frames.get(slot);
        let checks =
            |hold: &SuspendedBranch<D>| hold.stop_point.parent == slot && hold.check().is_some();
        match frame.phase {
            Phase::Script => Err("its script runs; preempt it instead"),
            Phase::Checking => Err("the condition of a breakpoint is being evaluated; wait for it"),
            _ if self.run.control.holds.iter().any(checks) => {
                Err("the condition of a breakpoint is being evaluated; wait for it")
            }
            Phase::Held | Phase::Waiting(_) => Ok(()),
            Phase::Branches if !frame.children.any_active() => Ok(()),
            Phase::Begun | Phase::Child | Phase::Branches | Phase::Deciding => {
                Err("states in it are active; choose one of those, or preempt it")
            }
        }
    }

    fn place_at(&self, stop_point: StopPoint) -> Option<PathId> {
        if stop_point.is_root() {
            return Some(PathId(0));
        }
        let around = self.run.frames.get(stop_point.parent).path;
        self.run.places.child(around, stop_point.child as usize, self.program)
    }
}

fn without_outputs<D: Datum>(node: &Node<D>, outcome: u32) -> Ended<D> {
    crate::engine::stepping::leave::ended(node, outcome, Vec::new(), None)
}
