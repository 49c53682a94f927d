//! Beginning again while nothing moves: what is active is dropped, without an end.

use crate::engine::state::phase::Phase;
use crate::engine::state::step::Step;
use crate::engine::state::suspended::SuspendedBranch;
use crate::engine::{Command, Refusal};
use crate::{Datum, Effect, Event};

impl<D: Datum> Step<'_, D> {
    /// Refuses a command that would take the ground from under a script.
    pub(in crate::engine) fn nothing_runs(&self, command: Command) -> Result<(), Refusal> {
        self.legal(command)?;
        if let Some(check) = self.run.control.holds.iter().find_map(SuspendedBranch::check) {
            return Err(Refusal::StillChecks { command, check });
        }
        let runs = |&slot: &u32| self.run.frames.get(slot).phase == Phase::Script;
        let Some(slot) = self.active().into_iter().find(runs) else { return Ok(()) };
        let path = self.run.places.text(self.run.frames.get(slot).path, self.program);
        Err(Refusal::StillRuns { command, path })
    }

    /// Drops all active states, parents before children, and ends their branches.
    pub(in crate::engine) fn drop_all(&mut self) {
        let frames = self.active();
        for SuspendedBranch { spot, branch, .. } in std::mem::take(&mut self.run.control.holds) {
            if self.is_branch(spot) {
                self.run.branches.end(branch);
                self.out.effects.push(Effect::EndBranch { branch });
            }
        }
        for &slot in &frames {
            self.out.events.push(Event::Dropped { path: self.run.frames.get(slot).path });
        }
        for slot in frames.into_iter().rev() {
            let (frame, branches) = (self.run.frames.get(slot), &mut self.run.branches);
            let (branch, parent) = (frame.branch, frame.parent);
            let is_own = parent != crate::engine::state::frames::NONE
                && self.run.frames.get(parent).branch != branch;
            if is_own {
                branches.end(branch);
                self.out.effects.push(Effect::EndBranch { branch });
            }
            self.run.frames.remove(slot);
        }
        self.run.root = None;
        self.run.finish = None;
        self.run.control.forget();
        self.step_all(false);
    }
}
