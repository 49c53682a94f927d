//! Reactions to a silent ground: policies of states hold branches and preempt states (`docs/semantics.md`, Lost link).
//! This module knows how long the silence lasts, but no clock.

use crate::engine::Status;
use crate::engine::state::frames::{Children, NONE};
use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::StopPoint;
use crate::program::{ABORTED, Body, Concurrency, PREEMPTED};
use crate::{Datum, Event, HeldBy, Program, Silence, When};
use rafcon_model::{Loss, LossPolicy};

impl<D: Datum> Step<'_, D> {
    /// Sets the current silence. Holds remain after its end, until a command releases them.
    pub(in crate::engine) fn set_silence(&mut self, silence: Silence) {
        self.run.control.silence = silence;
        if !silence.is_over() {
            self.leave_alone();
        }
    }

    /// Preempts one state whose policy the silence has exceeded. False if no state qualifies.
    pub(in crate::engine) fn preempt_lost(&mut self) -> bool {
        if self.run.control.silence.is_over() {
            return false;
        }
        let Some((slot, loss)) = self.view().lost() else { return false };
        let path = self.run.frames.get(slot).path;
        self.out.events.push(Event::LossRecovery { path, loss });
        let frames = self.run.frames.below(slot);
        self.preempt(&frames);
        true
    }

    /// Ends step mode for branches that policies hold in these frames, because a state that is asked to end is not
    /// held.
    pub(in crate::engine) fn free_lost(&mut self, frames: &[u32]) {
        let holds = self.run.control.holds.iter();
        let lost = holds.filter(|hold| matches!(hold.by(), Some(HeldBy::Loss(_))));
        for hold in lost.filter(|hold| frames.contains(&hold.stop_point.parent)) {
            self.run.branches.set(hold.branch, false);
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The loss that holds a branch at a stop point: before a state that may not begin, or after one that had to end
    /// first.
    pub(in crate::engine) fn loss_at(&self, stop_point: StopPoint) -> Option<Loss> {
        if self.run.control.silence.is_over()
            || !stop_point.is_root() && self.is_decider(stop_point)
        {
            return None;
        }
        Loss::ALL.into_iter().find(|loss| match stop_point.when {
            When::Before => {
                let policy = self.own_policy_at(stop_point, *loss);
                let policy = policy.or_else(|| self.policy_around(stop_point.parent, *loss));
                policy.is_some_and(|policy| {
                    self.is_over(policy.hold_ms, *loss) || self.is_over(policy.recover_ms, *loss)
                })
            }
            When::After => {
                let may_hold = !stop_point.is_root() && !self.is_racer(stop_point);
                let policy = self.own_policy_at(stop_point, *loss).filter(|_| may_hold);
                policy.is_some_and(|policy| {
                    let recovers = self.is_over(policy.recover_ms, *loss);
                    self.is_over(policy.finish_ms, *loss)
                        && !(recovers && self.has_left_unfinished(stop_point))
                })
            }
        })
    }

    /// True if the child of a stop point was left by *preempted*, or by *aborted* because its recovery failed.
    fn has_left_unfinished(&self, stop_point: StopPoint) -> bool {
        let frame = self.run.frames.get(stop_point.parent);
        let outcome = match &frame.children {
            Children::None => None,
            Children::Library(root) => root.end.as_ref().map(|ended| ended.outcome),
            Children::Hierarchy(_) => frame.last.map(|(_, outcome)| outcome),
            Children::Concurrency(children) => {
                children.ended(stop_point.child).map(|ended| ended.outcome)
            }
        };
        matches!(outcome, Some(PREEMPTED | ABORTED))
    }

    /// True if a branch of a race ends here. If it were held, it would win later, and the others would continue.
    fn is_racer(&self, stop_point: StopPoint) -> bool {
        matches!(self.body(stop_point.parent), Body::Concurrency(Concurrency::Preemptive, _))
    }

    /// The outermost state whose policy the silence has exceeded. A state that contains another policy does not count.
    fn lost(&self) -> Option<(u32, Loss)> {
        if !matches!(self.run.status, Status::Running | Status::Paused) {
            return None;
        }
        let lost = |slot| Loss::ALL.into_iter().find(|loss| self.is_lost(slot, *loss));
        self.active().into_iter().find_map(|slot| Some((slot, lost(slot)?)))
    }

    fn is_lost(&self, slot: u32, loss: Loss) -> bool {
        let own = |slot: u32| self.program.node(self.run.frames.get(slot).node).loss_policy(loss);
        let recover_ms = own(slot).and_then(|policy| policy.recover_ms);
        self.is_over(recover_ms, loss)
            && !self.run.frames.get(slot).preempted
            && !self.run.frames.below(slot).into_iter().skip(1).any(|inner| own(inner).is_some())
    }

    fn is_over(&self, time_ms: Option<u64>, loss: Loss) -> bool {
        let silent_ms = self.run.control.silence.of(loss);
        time_ms.is_some_and(|time_ms| silent_ms > 0 && silent_ms >= time_ms)
    }

    /// The own policy of a stop point's state.
    fn own_policy_at(&self, stop_point: StopPoint, loss: Loss) -> Option<LossPolicy> {
        if stop_point.is_root() {
            return self.program.node(Program::<D>::ROOT).loss_policy(loss);
        }
        let around = self.program.node(self.run.frames.get(stop_point.parent).node);
        let child = around.child(usize::try_from(stop_point.child).ok()?)?;
        self.program.node(child).loss_policy(loss)
    }

    /// The policy for an active state: its own, or that of the nearest state around it that has one. A preempted state
    /// ends the search, so that its handlers run.
    fn policy_around(&self, slot: u32, loss: Loss) -> Option<LossPolicy> {
        let mut next = slot;
        while next != NONE {
            let frame = self.run.frames.get(next);
            if frame.preempted {
                return None;
            }
            let policy = self.program.node(frame.node).loss_policy(loss);
            if policy.is_some() {
                return policy;
            }
            next = frame.parent;
        }
        None
    }
}
