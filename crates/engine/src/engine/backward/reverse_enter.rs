//! Enters states backwards: with the data of their end, or to run the script that undoes them.

use crate::engine::state::frames::{Children, NONE, Seed, Slot};
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Back, Step, View, Work};
use crate::engine::state::suspended::{StopPoint, SuspendedBranch};
use crate::engine::state::undo_log::{EndedContainerData, EndedRun, Kept};
use crate::engine::stepping::concurrency::all_but_decider;
use crate::program::{Body, Concurrency, Inside, PREEMPTED};
use crate::{BranchId, Datum, Effect, Event, HeldBy, Job, NodeId, When};
use std::num::NonZeroU64;
use std::sync::Arc;

/// A child to enter backwards.
#[derive(Debug, Clone, Copy)]
struct BackwardEntry {
    parent: u32,
    child: u32,
    node: NodeId,
    branch: BranchId,
    /// Number of the undone entry, and its outcome.
    undoes: (u64, u32),
}

impl<'s, D: Datum> Step<'s, D> {
    /// Enters an ended child backwards.
    pub(in crate::engine) fn enter_back(
        &mut self,
        parent: u32,
        child: u32,
        run: EndedRun<D>,
        branch: BranchId,
    ) {
        let around = self.program.node(self.run.frames.get(parent).node);
        let Some(id) = around.child(child as usize) else { return };
        let undoes = (run.entry, run.outcome);
        let entry = BackwardEntry { parent, child, node: id, branch, undoes };
        match run.kept {
            Kept::Inner(inner) => {
                let inputs = Arc::clone(&inner.inputs);
                let slot = self.begin_back(entry, inputs);
                self.restore_inner(slot, *inner);
            }
            Kept::Nothing | Kept::Lost => {
                let inputs = self.inputs_now(parent, child, id);
                let slot = self.begin_back(entry, inputs);
                self.run_back(slot);
            }
        }
    }

    /// The inputs of a script that runs backward, computed again from the current data.
    fn inputs_now(&mut self, parent: u32, child: u32, id: NodeId) -> Arc<[D]> {
        let (node, path) = (self.program.node(id), self.child_path(parent, child));
        if let Body::Library(content) = self.view().body(parent) {
            return self.library_root_inputs(parent, content, node, path);
        }
        self.child_inputs(parent, node, path, None)
    }

    fn begin_back(&mut self, entry: BackwardEntry, inputs: Arc<[D]>) -> u32 {
        let BackwardEntry { parent, child, node, branch, undoes } = entry;
        let path = self.child_path(parent, child);
        let entered = Event::Entered {
            path,
            node,
            inputs: Arc::clone(&inputs),
            undoes: NonZeroU64::new(undoes.0),
        };
        self.out.events.push(entered);
        let about = self.program.node(node);
        let outputs = self.view().output_defaults(parent, about);
        let seed = Seed {
            node,
            path,
            branch,
            parent,
            preempted: false,
            start_depth: None,
            inputs,
            outputs,
            error: None,
            entered_at: 0,
        };
        let slot = self.run.frames.add(seed, Children::of(&about.body));
        self.run.entries += 1;
        let frame = self.run.frames.get_mut(slot);
        frame.entry = self.run.entries;
        frame.undoes = Some(undoes);
        self.hang(parent, child, slot);
        slot
    }

    fn run_back(&mut self, slot: u32) {
        let id = self.run.frames.id(slot);
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Script;
        self.out.effects.push(Effect::Run(Job {
            frame: id,
            branch: frame.branch,
            path: frame.path,
            node: frame.node,
            inputs: frame.inputs.clone().unwrap_or_default(),
            outputs: frame.outputs.clone().unwrap_or_default(),
            error: None,
            preempted: false,
            verdicts: None,
            backward: true,
        }));
    }

    /// Restores a container to its state after its last child.
    fn restore_inner(&mut self, slot: u32, inner: EndedContainerData<D>) {
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Child;
        frame.slots = inner.slots;
        frame.last = inner.last;
        frame.last_error = inner.last_error;
        frame.start_depth = inner.start_depth;
        frame.children = inner.children;
        let branch = frame.branch;
        match self.view().body(slot) {
            Body::Script => {}
            Body::Hierarchy(inside) => {
                self.say_variables(slot, inside);
                self.stand_back(slot);
            }
            Body::Library(_) => {
                let frame = self.run.frames.get_mut(slot);
                match frame.children.library().and_then(|root| root.run.take()) {
                    Some(root) if root.entry > 0 => self.enter_back(slot, 0, root, branch),
                    Some(_) | None => self.leave_back_later(slot),
                }
            }
            Body::Concurrency(kind, inside) => {
                self.say_variables(slot, inside);
                self.all_back(slot, *kind, inside);
            }
        }
    }

    /// Enters all branches of a concurrency state backwards. Branches that never began are held at their start.
    fn all_back(&mut self, slot: u32, kind: Concurrency, inside: &'s Inside<D>) {
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Branches;
        let Some(children) = frame.children.side_by_side_mut() else { return };
        let began = |child: &u32| children.all[*child as usize].run.is_some();
        let (ran, never): (Vec<_>, Vec<_>) = all_but_decider(kind, inside).partition(began);
        children.open = crate::program::index(never.len());
        children.winner = None;
        if ran.is_empty() && (never.is_empty() || !self.view().is_outermost(slot)) {
            return self.leave_back_later(slot);
        }
        for child in never {
            let branch = self.fork_stepping();
            self.hold_back(StopPoint::before(slot, child), branch, HeldBy::Start);
        }
        self.branches_back(slot, &ran);
    }

    /// Enters these ended branches backwards, removes their outputs and skips the decider.
    pub(in crate::engine) fn branches_back(&mut self, slot: u32, children: &[u32]) {
        let Body::Concurrency(kind, inside) = self.view().body(slot) else { return };
        let frame = self.run.frames.get_mut(slot);
        frame.stand_ready();
        frame.phase = Phase::Branches;
        frame.last = None;
        frame.last_error = None;
        let Some(branches) = frame.children.side_by_side_mut() else { return };
        branches.winner = None;
        if let Some(decider) = kind.decider() {
            branches.all[decider as usize].ended = None;
        }
        let held = self.take_holds_after(slot, children, *kind);
        for &child in children {
            let branch =
                held.iter().find(|hold| hold.stop_point.child == child).map(|hold| hold.branch);
            let branch = branch.unwrap_or_else(|| self.open_again(slot));
            self.run.branches.set(branch, true);
            match self.take_end(slot, child) {
                Some(run) if run.entry > 0 => self.enter_back(slot, child, run, branch),
                Some(_) | None => {
                    self.hold_back(StopPoint::before(slot, child), branch, HeldBy::Start);
                }
            }
        }
        self.rebase(slot, *kind, inside);
        if self.view().all_at_start(slot) && !self.view().is_outermost(slot) {
            self.leave_back_later(slot);
        }
    }

    /// Reverts the end of a child and returns what the child left behind.
    fn take_end(&mut self, slot: u32, child: u32) -> Option<EndedRun<D>> {
        let branches = self.run.frames.get_mut(slot).children.side_by_side_mut()?;
        branches.order.retain(|&other| other != child);
        let child = branches.all.get_mut(child as usize)?;
        child.ended = None;
        child.run.take()
    }

    /// Removes the holds after these children's ends, and those of the decider.
    fn take_holds_after(
        &mut self,
        slot: u32,
        children: &[u32],
        kind: Concurrency,
    ) -> Vec<SuspendedBranch<D>> {
        let holds = &mut self.run.control.holds;
        let ends = |hold: &mut SuspendedBranch<D>| {
            let child = hold.stop_point.child;
            let ended = hold.stop_point.when == When::After && children.contains(&child);
            hold.stop_point.parent == slot && (ended || kind.decider() == Some(child))
        };
        holds.extract_if(.., ends).collect()
    }

    /// Counts an ended branch as open again, on a new branch.
    fn open_again(&mut self, slot: u32) -> BranchId {
        if let Some(children) = self.run.frames.get_mut(slot).children.side_by_side_mut() {
            children.open += 1;
        }
        self.fork_stepping()
    }

    fn fork_stepping(&mut self) -> BranchId {
        let branch = self.run.branches.begin(true);
        self.out.effects.push(Effect::Fork { branch });
        branch
    }

    /// Resets the data of a concurrency state to its base values plus the outputs of its ended branches.
    fn rebase(&mut self, slot: u32, kind: Concurrency, inside: &'s Inside<D>) {
        let frame = self.run.frames.get_mut(slot);
        let Some(children) = frame.children.side_by_side() else { return };
        let Some(base) = &children.base else { return };
        frame.slots.clone_from(base);
        let given = match kind {
            Concurrency::Barrier(_) => children.order.clone(),
            Concurrency::Preemptive => Vec::new(),
        };
        let said = self.out.events.len();
        for child in given {
            self.store_end(slot, inside, child);
        }
        self.out.events.truncate(said);
        self.say_variables(slot, inside);
    }

    /// Reports the values of a container's scoped variables.
    fn say_variables(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get(slot);
        let first = self.program.node(frame.node).inputs.len();
        let said = inside.scoped.iter().zip(frame.slots.iter().skip(first));
        self.out.events.extend(said.filter_map(|(scoped, Slot { value, .. })| {
            let (path, port) = (frame.path, scoped.port.id);
            Some(Event::Scoped { path, port, value: value.clone()? })
        }));
    }

    /// Holds a hierarchy that was entered backwards or whose child was undone. A hierarchy at its start is left
    /// instead, unless it is the outermost.
    pub(in crate::engine) fn stand_back(&mut self, slot: u32) {
        let frame = self.run.frames.get(slot);
        let branch = frame.branch;
        let at_start = frame
            .children
            .in_turn()
            .is_none_or(|children| children.undo_log.entries.is_empty() && !children.undo_log.lost);
        let child = self.view().upcoming(slot).unwrap_or(NONE);
        match at_start {
            true if self.view().is_outermost(slot) => {
                self.hold_back(StopPoint::before(slot, child), branch, HeldBy::Start);
            }
            true => self.leave_back_later(slot),
            false => self.hold_back(StopPoint::before(slot, child), branch, HeldBy::Step),
        }
    }

    pub(in crate::engine) fn leave_back_later(&mut self, slot: u32) {
        let frame = self.run.frames.id(slot);
        self.run.work.push(Work::Back(Back::Leave(frame)));
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The number of the undone entry and the outcome of a state that is left backwards: the undone outcome, or
    /// *preempted* if it had none.
    pub(in crate::engine) fn undone(&self, slot: u32) -> (u64, u32) {
        let frame = self.run.frames.get(slot);
        frame.undoes.unwrap_or((frame.entry, PREEMPTED))
    }
}
