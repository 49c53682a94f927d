//! Concurrency states: the begin and end of branches, a barrier's decider, and the race of a preemptive state.

use crate::engine::state::frames::{ChildrenSideBySide, Ended, EndedChild};
use crate::engine::state::phase::{Cause, Phase};
use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::StopPoint;
use crate::program::{ABORTED, Body, Concurrency, Exit, Inside, PREEMPTED};
use crate::{BranchId, Datum, Effect, Verdict, Verdicts};

impl<D: Datum> Step<'_, D> {
    /// Enters a child of a concurrency state on its branch.
    pub(in crate::engine) fn begin_branch(&mut self, parent: u32, child: u32, branch: BranchId) {
        let Body::Concurrency(_, inside) = self.view().body(parent) else { return };
        let mut seed = self.seed(parent, child, inside.child(child), None);
        let frame = self.run.frames.get(parent);
        seed.preempted = frame.begins_no_branch();
        seed.branch = branch;
        self.begin(seed, child, None);
    }

    /// Records the end of a child. Outputs of a barrier's children are stored at once, so that the later of two values
    /// wins.
    pub(in crate::engine) fn branch_ended(
        &mut self,
        slot: u32,
        child: u32,
        branch: BranchId,
        end: EndedChild<D>,
    ) {
        let Body::Concurrency(kind, inside) = self.view().body(slot) else { return };
        let EndedChild { ended, run } = end;
        if matches!(kind, Concurrency::Barrier(_)) {
            self.store_outputs(slot, inside, child, &ended);
        }
        if let Some(children) = self.run.frames.get_mut(slot).children.side_by_side_mut() {
            children.end(child, ended, run);
            children.order.push(child);
        }
        if self.passes(StopPoint::after(slot, child), branch) {
            self.branch_done(slot, child, branch);
        }
    }

    /// Counts an ended child, and ends its branch.
    pub(in crate::engine) fn branch_done(&mut self, slot: u32, child: u32, branch: BranchId) {
        self.end_branch(slot, branch);
        match self.view().body(slot) {
            Body::Concurrency(Concurrency::Barrier(_), _) => self.wake(&[slot], Cause::ChildEnded),
            Body::Concurrency(Concurrency::Preemptive, _) => self.racer_done(slot, child),
            Body::Script | Body::Library(_) | Body::Hierarchy(_) => {}
        }
    }

    /// Ends the branch of a child that was held before it began and now never begins.
    pub(in crate::engine) fn branch_never_begins(&mut self, slot: u32, branch: BranchId) {
        self.end_branch(slot, branch);
        self.wake(&[slot], Cause::ChildEnded);
    }

    fn end_branch(&mut self, slot: u32, branch: BranchId) {
        self.run.branches.end(branch);
        self.out.effects.push(Effect::EndBranch { branch });
        if let Some(children) = self.run.frames.get_mut(slot).children.side_by_side_mut() {
            children.open = children.open.saturating_sub(1);
        }
    }
}

/// The children of a concurrency state that have branches of their own.
pub(in crate::engine) fn all_but_decider<D>(
    kind: Concurrency,
    inside: &Inside<D>,
) -> impl DoubleEndedIterator<Item = u32> + use<D> {
    (0..inside.count()).filter(move |&child| Some(child) != kind.decider())
}

impl<'s, D: Datum> Step<'s, D> {
    /// Records the end of the decider.
    pub(in crate::engine) fn decider_ended(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        child: u32,
        ended: Ended<D>,
    ) {
        self.store_outputs(slot, inside, child, &ended);
        let frame = self.run.frames.get_mut(slot);
        frame.after = true;
        frame.last = Some((child, ended.outcome));
        frame.last_error = ended.error.clone().filter(|_| ended.outcome == ABORTED);
        if let Some(children) = frame.children.side_by_side_mut() {
            children.end(child, ended, None);
        }
        self.wake(&[slot], Cause::ChildEnded);
    }

    /// Continues a barrier whose children have ended: with the decider, unless the barrier was preempted; after the
    /// decider, with its transition.
    pub(in crate::engine) fn advance_barrier(
        &mut self,
        slot: u32,
        decider: Option<u32>,
        inside: &'s Inside<D>,
    ) {
        let frame = self.run.frames.get_mut(slot);
        let pass = frame.pass.take();
        match decider.filter(|_| frame.last.is_none() && !frame.preempted) {
            Some(decider) => self.go_to_decider(slot, inside, decider, pass),
            None if frame.last.is_none() => self.leave_container(slot, inside, PREEMPTED),
            None if self.passes_end(slot) => self.conclude(slot, inside),
            None => {}
        }
    }

    fn go_to_decider(&mut self, slot: u32, inside: &'s Inside<D>, decider: u32, pass: Option<u32>) {
        if self.passes_to(slot, decider, pass) {
            self.run.frames.get_mut(slot).phase = Phase::Deciding;
            self.enter_decider(slot, inside, decider);
        }
    }

    /// Ends the concurrency state by the transition of its decider or winner.
    pub(in crate::engine) fn conclude(&mut self, slot: u32, inside: &'s Inside<D>) {
        let last = self.run.frames.get(slot).last;
        match last.map(|(child, outcome)| self.view().exit(inside, child, outcome)) {
            Some(Exit::Outcome(outcome)) => self.leave_container(slot, inside, outcome),
            Some(Exit::Child(_) | Exit::Nowhere) | None => self.nowhere(slot, inside),
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The ends of a barrier's children, for its decider.
    pub(in crate::engine) fn verdicts(&self, slot: u32, inside: &Inside<D>) -> Verdicts<D> {
        let verdict = |(child, ended): (u32, &Ended<D>)| {
            let node = self.program.node(inside.child(child));
            let outcome = node.outcome_at(ended.outcome);
            Verdict {
                state: node.id().clone(),
                name: node.name().clone(),
                outcome: outcome.id,
                outcome_name: outcome.name.clone(),
                error: ended.error.clone(),
            }
        };
        let children = self.run.frames.get(slot).children.side_by_side();
        let ends = children.into_iter().flat_map(ChildrenSideBySide::ends);
        Verdicts { children: ends.map(verdict).collect() }
    }
}

impl<'s, D: Datum> Step<'s, D> {
    /// Counts the end of a racer; the first one wins.
    pub(in crate::engine) fn racer_done(&mut self, slot: u32, child: u32) {
        let frame = self.run.frames.get_mut(slot);
        let Some(children) = frame.children.side_by_side_mut() else { return };
        let is_first = children.winner.is_none();
        children.winner.get_or_insert(child);
        if children.open == 0 {
            self.wake(&[slot], Cause::ChildEnded);
        } else if is_first {
            self.preempt_children(slot);
        }
    }

    /// Continues a race whose children have ended: stores their outputs in order, those of the winner last, and follows
    /// the winner's transition.
    pub(in crate::engine) fn advance_preemptive(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get(slot);
        if let Some(winner) = frame.children.winner().filter(|_| frame.last.is_none()) {
            self.merge(slot, inside, winner);
        }
        self.conclude(slot, inside);
    }

    fn merge(&mut self, slot: u32, inside: &'s Inside<D>, winner: u32) {
        for child in (0..inside.count()).filter(|&child| child != winner) {
            self.store_end(slot, inside, child);
        }
        if let Some(won) = self.store_end(slot, inside, winner) {
            let frame = self.run.frames.get_mut(slot);
            frame.last = Some((winner, won.outcome));
            frame.last_error = won.error;
        }
    }

    /// Stores the outputs of an ended child and returns its end.
    pub(in crate::engine) fn store_end(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        child: u32,
    ) -> Option<Ended<D>> {
        let children = self.run.frames.get(slot).children.side_by_side()?;
        let ended = children.ended(child)?.clone();
        self.store_outputs(slot, inside, child, &ended);
        Some(ended)
    }
}
