//! Preemptive concurrency states: the first child to end wins, the others are preempted.

use crate::Datum;
use crate::engine::state::phase::Cause;
use crate::engine::state::step::Step;
use crate::program::Inside;

impl<'s, D: Datum> Step<'s, D> {
    /// A child is done; the first one wins.
    pub(in crate::engine) fn racer_done(&mut self, slot: u32, child: u32) {
        let frame = self.run.frames.get_mut(slot);
        let is_first = frame.winner.is_none();
        frame.winner.get_or_insert(child);
        if frame.open == 0 {
            self.wake(&[slot], Cause::ChildEnded);
        } else if is_first {
            self.preempt_children(slot);
        }
    }

    /// All children have ended: their outputs in the order of children, those of the winner last; then its transition.
    pub(in crate::engine) fn advance_preemptive(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get(slot);
        if let Some(winner) = frame.winner.filter(|_| frame.last.is_none()) {
            self.merge(slot, inside, winner);
        }
        self.conclude(slot, inside);
    }

    fn merge(&mut self, slot: u32, inside: &'s Inside<D>, winner: u32) {
        let ended = std::mem::take(&mut self.run.frames.get_mut(slot).ended);
        let others = (0..).zip(&ended).filter(|(child, _)| *child != winner);
        let winners = (0..).zip(&ended).filter(|(child, _)| *child == winner);
        for (child, ended) in others.chain(winners) {
            if let Some(ended) = ended {
                self.store_outputs(slot, inside, child, ended);
            }
        }
        let frame = self.run.frames.get_mut(slot);
        if let Some(won) = ended.get(winner as usize).and_then(Option::as_ref) {
            frame.last = Some((winner, won.outcome));
            frame.last_error.clone_from(&won.error);
        }
        frame.ended = ended;
    }
}
