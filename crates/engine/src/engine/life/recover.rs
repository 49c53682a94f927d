//! Recovery of scripts that a crash interrupted: they wait, abort, or run again.

use crate::engine::Refusal;
use crate::engine::state::frames::NONE;
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Step, View, Work};
use crate::engine::state::suspended::StopPoint;
use crate::program::{ABORTED, Body, PREEMPTED};
use crate::{Datum, HeldBy, Interrupted, Verdicts, WaitReason};
use rafcon_model::StatePath;
use std::sync::Arc;

impl<D: Datum> Step<'_, D> {
    /// Decides about all interrupted scripts, or about those at and below one place.
    pub(in crate::engine) fn recover(
        &mut self,
        path: Option<&StatePath>,
        interrupted: Interrupted,
    ) -> Result<(), Refusal> {
        let mut waiting = self.view().active();
        waiting.retain(|&slot| {
            self.view().is_interrupted(slot) && self.view().is_at_or_below(slot, path)
        });
        if waiting.is_empty() {
            return Err(Refusal::NotInterrupted { path: path.cloned() });
        }
        if interrupted != Interrupted::Wait {
            for slot in waiting {
                self.resume_script(slot, interrupted, false);
            }
            self.run.work.reverse();
        }
        Ok(())
    }

    /// Resumes the state of a script that was interrupted. Its work is queued in the order of execution.
    pub(in crate::engine) fn resume_script(
        &mut self,
        slot: u32,
        interrupted: Interrupted,
        hold: bool,
    ) {
        let asked = self.run.frames.get(slot).preempted;
        match interrupted {
            Interrupted::Wait if asked => self.end_script_later(slot, PREEMPTED, None),
            Interrupted::Wait => self.wait(slot, WaitReason::Interrupted),
            Interrupted::Abort => {
                let error = self.run.crash.clone();
                self.end_script_later(slot, ABORTED, error);
            }
            Interrupted::Again if hold => {
                let branch = self.run.frames.get(slot).branch;
                self.hold(StopPoint::before(slot, NONE), branch, HeldBy::Start);
            }
            Interrupted::Again => self.run_again(slot),
        }
    }

    /// Continues a state that was held or waited before its script: it ends if it was asked to, otherwise its script
    /// runs.
    pub(in crate::engine) fn advance_script(&mut self, slot: u32) {
        let frame = self.run.frames.get(slot);
        match frame.phase {
            Phase::Held | Phase::Checking | Phase::Waiting(_) if frame.preempted => {
                self.end_script_later(slot, PREEMPTED, None);
            }
            Phase::Held => self.run_again(slot),
            Phase::Begun
            | Phase::Checking
            | Phase::Script
            | Phase::Child
            | Phase::Waiting(_)
            | Phase::Branches
            | Phase::Deciding => {}
        }
    }

    fn run_again(&mut self, slot: u32) {
        let verdicts = self.view().verdicts_for(slot);
        self.run_script(slot, verdicts);
    }

    /// Ends the state of a script without outputs, because the script has no result.
    fn end_script_later(&mut self, slot: u32, outcome: u32, error: Option<D>) {
        let frame = self.run.frames.get_mut(slot);
        // No cause wakes the frame in this phase.
        frame.phase = Phase::Begun;
        let node = self.program.node(frame.node);
        let ended = crate::engine::stepping::leave::ended(node, outcome, Vec::new(), error);
        self.run.work.push(Work::Leave { slot, ended: Box::new(ended) });
    }
}

impl<D: Datum> View<'_, '_, D> {
    fn is_interrupted(&self, slot: u32) -> bool {
        self.run.frames.get(slot).phase == Phase::Waiting(WaitReason::Interrupted)
    }

    fn is_at_or_below(&self, slot: u32, path: Option<&StatePath>) -> bool {
        let Some(StatePath(above)) = path else { return true };
        let place = self.run.frames.get(slot).path;
        self.run.places.text(place, self.program).0.starts_with(above)
    }

    /// The ends of a barrier's branches, if this state is its decider.
    fn verdicts_for(&self, slot: u32) -> Option<Arc<Verdicts<D>>> {
        let frame = self.run.frames.get(slot);
        if !self.program.node(frame.node).id().is_decider() || frame.parent == NONE {
            return None;
        }
        match self.body(frame.parent) {
            Body::Concurrency(_, inside) => Some(Arc::new(self.verdicts(frame.parent, inside))),
            Body::Script | Body::Hierarchy(_) | Body::Library(_) => None,
        }
    }
}
