//! Requests to end active states. A request is never reset, so that none is lost.

use crate::engine::state::phase::{Cause, Reaction, react};
use crate::engine::state::step::{Step, Work};
use crate::{Datum, Effect};

impl<D: Datum> Step<'_, D> {
    /// Preempts all active children of a state, in their order.
    pub(in crate::engine) fn preempt_children(&mut self, slot: u32) {
        let active = self.run.frames.get(slot).children.active();
        let frames = active.flat_map(|child| self.run.frames.below(child)).collect::<Vec<_>>();
        self.preempt(&frames);
        self.release(slot);
    }

    /// Preempts these frames; those that are held or wait select their next step.
    pub(in crate::engine) fn preempt(&mut self, frames: &[u32]) {
        for &slot in frames {
            let frame = self.run.frames.get_mut(slot);
            if !frame.preempted {
                frame.preempted = true;
                self.out.effects.push(Effect::Preempt(frame.path));
            }
        }
        self.free_lost(frames);
        self.wake(frames, Cause::Preempted);
        if !self.run.control.holds.is_empty() {
            for &slot in frames {
                self.release(slot);
            }
        }
    }

    /// Queues the next step of the frames that advance for this cause, the first frame first.
    pub(in crate::engine) fn wake(&mut self, frames: &[u32], cause: Cause) {
        for &slot in frames.iter().rev() {
            let reaction = react(&self.run.frames.get(slot).phase, cause);
            if reaction == Reaction::Advance {
                self.run.work.push(Work::Advance(self.run.frames.id(slot)));
            }
        }
    }
}
