//! The children of a concurrency state as branches: how each begins and ends.

use crate::engine::state::frames::{Ended, NONE};
use crate::engine::state::phase::Cause;
use crate::engine::state::step::Step;
use crate::engine::state::suspended::StopPoint;
use crate::engine::state::undo_log::EndedRun;
use crate::program::{Body, Concurrency, Inside};
use crate::{BranchId, Datum, Effect};

impl<'s, D: Datum> Step<'s, D> {
    /// Enters a child of a concurrency state on its branch.
    pub(in crate::engine) fn begin_branch(&mut self, parent: u32, child: u32, branch: BranchId) {
        let Body::Concurrency(_, inside) = self.body(parent) else { return };
        let mut seed = self.seed(parent, child, inside.child(child), None);
        let frame = self.run.frames.get(parent);
        seed.preempted = frame.preempted || frame.winner.is_some();
        seed.branch = branch;
        self.begin(seed, child, None);
    }

    /// A child ended. The outputs of a barrier's children are taken at once, so that of two the later one wins.
    pub(in crate::engine) fn branch_ended(
        &mut self,
        slot: u32,
        (kind, inside): (Concurrency, &'s Inside<D>),
        (child, branch): (u32, BranchId),
        (ended, past): (Ended<D>, Option<EndedRun<D>>),
    ) {
        if matches!(kind, Concurrency::Barrier(_)) {
            self.store_outputs(slot, inside, child, &ended);
        }
        let frame = self.run.frames.get_mut(slot);
        frame.children[child as usize] = NONE;
        frame.ended[child as usize] = Some(ended);
        frame.order.push(child);
        if let Some(place) = frame.pasts.get_mut(child as usize) {
            *place = past;
        }
        if self.passes(StopPoint::after(slot, child), branch) {
            self.branch_done(slot, child, branch);
        }
    }

    /// A child that ended counts from now on.
    pub(in crate::engine) fn branch_done(&mut self, slot: u32, child: u32, branch: BranchId) {
        self.end_branch(slot, branch);
        match self.body(slot) {
            Body::Concurrency(Concurrency::Barrier(_), _) => self.wake(&[slot], Cause::ChildEnded),
            Body::Concurrency(Concurrency::Preemptive, _) => self.racer_done(slot, child),
            Body::Script | Body::Library(_) | Body::Hierarchy(_) => {}
        }
    }

    /// A child that was held before it began never begins.
    pub(in crate::engine) fn branch_never_begins(&mut self, slot: u32, branch: BranchId) {
        self.end_branch(slot, branch);
        self.wake(&[slot], Cause::ChildEnded);
    }

    fn end_branch(&mut self, slot: u32, branch: BranchId) {
        self.run.branches.end(branch);
        self.out.effects.push(Effect::EndBranch { branch });
        let frame = self.run.frames.get_mut(slot);
        frame.open = frame.open.saturating_sub(1);
    }
}

/// The children of a concurrency state that have branches of their own.
pub(in crate::engine) fn all_but_decider<D>(
    kind: Concurrency,
    inside: &Inside<D>,
) -> impl DoubleEndedIterator<Item = u32> + use<D> {
    (0..inside.count()).filter(move |&child| Some(child) != kind.decider())
}
