//! Barrier concurrency states: all children, then the decider.

use crate::engine::state::frames::{Ended, NONE};
use crate::engine::state::phase::{Cause, Phase};
use crate::engine::state::step::Step;
use crate::program::{ABORTED, Exit, Inside, PREEMPTED};
use crate::{Datum, Verdict, Verdicts};

impl<'s, D: Datum> Step<'s, D> {
    /// The decider ended.
    pub(in crate::engine) fn decider_ended(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        child: u32,
        ended: Ended<D>,
    ) {
        self.store_outputs(slot, inside, child, &ended);
        let frame = self.run.frames.get_mut(slot);
        frame.children[child as usize] = NONE;
        frame.after = true;
        frame.last = Some((child, ended.outcome));
        frame.last_error = ended.error.clone().filter(|_| ended.outcome == ABORTED);
        frame.ended[child as usize] = Some(ended);
        self.wake(&[slot], Cause::ChildEnded);
    }

    /// All children have ended: the decider, unless the barrier was preempted; after the decider, its transition.
    pub(in crate::engine) fn advance_barrier(
        &mut self,
        slot: u32,
        decider: Option<u32>,
        inside: &'s Inside<D>,
    ) {
        let frame = self.run.frames.get_mut(slot);
        let pass = frame.pass.take();
        match decider.filter(|_| frame.last.is_none() && !frame.preempted) {
            Some(decider) => self.go_to_decider(slot, inside, (decider, pass)),
            None if frame.last.is_none() => self.leave_container(slot, inside, PREEMPTED),
            None if self.passes_end(slot) => self.conclude(slot, inside),
            None => {}
        }
    }

    fn go_to_decider(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        (decider, pass): (u32, Option<u32>),
    ) {
        if self.passes_to(slot, decider, pass) {
            self.run.frames.get_mut(slot).phase = Phase::Deciding;
            self.enter_decider(slot, inside, decider);
        }
    }

    /// The transition of the child that decides (decider or winner) says how the concurrency state ends.
    pub(in crate::engine) fn conclude(&mut self, slot: u32, inside: &'s Inside<D>) {
        let last = self.run.frames.get(slot).last;
        match last.map(|(child, outcome)| self.exit(inside, child, outcome)) {
            Some(Exit::Outcome(outcome)) => self.leave_container(slot, inside, outcome),
            Some(Exit::Child(_) | Exit::Nowhere) | None => self.nowhere(slot, inside),
        }
    }

    /// How the children of a barrier ended, for its decider.
    pub(in crate::engine) fn verdicts(&self, slot: u32, inside: &Inside<D>) -> Verdicts<D> {
        let verdict = |(child, ended): (u32, &Option<Ended<D>>)| {
            let ended = ended.as_ref()?;
            let node = self.program.node(inside.child(child));
            let outcome = node.outcome_at(ended.outcome);
            Some(Verdict {
                state: node.id().clone(),
                name: node.name().clone(),
                outcome: outcome.id,
                outcome_name: outcome.name.clone(),
                error: ended.error.clone(),
            })
        };
        let ended = &self.run.frames.get(slot).ended;
        Verdicts { children: (0..).zip(ended).filter_map(verdict).collect() }
    }
}
