//! Enters a state: creates its frame, collects its data and begins its first work.

use crate::engine::state::frames::{Children, NONE, Seed};
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Step, View, Work};
use crate::engine::state::suspended::StopPoint;
use crate::engine::stepping::concurrency::all_but_decider;
use crate::program::{Body, Concurrency, Inside, PREEMPTED, index};
use crate::{
    BranchId, Datum, Effect, Event, Job, Level, NodeId, Note, PathId, Program, Verdicts, WaitReason,
};
use std::sync::Arc;

impl<'s, D: Datum> Step<'s, D> {
    /// Enters the root with the inputs of the start.
    pub(in crate::engine) fn enter_root(&mut self) {
        let node = self.program.node(Program::<D>::ROOT);
        let path = PathId(0);
        let entered_at = self.out.events.len();
        let inputs = self.root_inputs();
        self.run.inputs.clear();
        let seed = Seed {
            node: Program::<D>::ROOT,
            path,
            branch: BranchId(0),
            parent: NONE,
            preempted: false,
            start_depth: (!self.run.start_from.is_empty()).then_some(0),
            inputs,
            outputs: Arc::clone(&node.outputs),
            error: None,
            entered_at,
        };
        self.begin(seed, 0, None);
    }

    /// The root's inputs: values from the start, otherwise defaults.
    pub(in crate::engine) fn root_inputs(&mut self) -> Arc<[D]> {
        let (node, path) = (self.program.node(Program::<D>::ROOT), PathId(0));
        let (ports, given) = (node.inputs(), self.run.inputs.clone());
        for (name, _) in given.iter().filter(|(name, _)| !ports.iter().any(|p| p.name == *name)) {
            self.note(path, Level::Warning, Note::NoSuchInput { name: name.clone() });
        }
        let value = |port: usize| {
            let named =
                given.iter().rfind(|(name, _)| ports.get(port).is_some_and(|p| p.name == *name));
            named.map(|(_, value)| value.clone())
        };
        self.default_inputs(node, path, value)
    }

    /// Enters a child of an active state, unless something holds before it.
    pub(in crate::engine) fn enter(&mut self, parent: u32, child: u32) {
        match self.view().body(parent) {
            Body::Script => {}
            Body::Library(content) => {
                let branch = self.run.frames.get(parent).branch;
                if self.passes(StopPoint::before(parent, child), branch) {
                    self.enter_library_root(parent, content);
                }
            }
            Body::Hierarchy(inside) => {
                let keeps = self.view().keeps_undo_log();
                let frame = self.run.frames.get_mut(parent);
                let error = frame.last_error.take();
                if let Some(children) = frame.children.in_turn_mut() {
                    children.handed_error = error.clone().filter(|_| keeps);
                }
                let seed = self.seed(parent, child, inside.child(child), error);
                self.begin(seed, child, None);
            }
            Body::Concurrency(..) => {
                let branch = self.fork(parent);
                if self.passes(StopPoint::before(parent, child), branch) {
                    self.begin_branch(parent, child, branch);
                }
            }
        }
    }

    /// Enters the decider of a barrier, on the branch of the barrier.
    pub(in crate::engine) fn enter_decider(
        &mut self,
        parent: u32,
        inside: &'s Inside<D>,
        child: u32,
    ) {
        let verdicts = self.view().verdicts(parent, inside);
        let seed = self.seed(parent, child, inside.child(child), None);
        self.begin(seed, child, Some(Arc::new(verdicts)));
    }

    /// Begins a branch. It goes step by step if its parent does, unless a step over a state around it is in progress.
    pub(in crate::engine) fn fork(&mut self, parent: u32) -> BranchId {
        let frame = self.run.frames.get(parent);
        let steps = self.run.branches.steps(frame.branch)
            && !self.view().is_inside_of_step(parent, frame.branch);
        let branch = self.run.branches.begin(steps);
        self.out.effects.push(Effect::Fork { branch });
        branch
    }

    /// The initial contents of a child's frame, with data from the parent.
    pub(in crate::engine) fn seed(
        &mut self,
        parent: u32,
        child: u32,
        id: NodeId,
        error: Option<D>,
    ) -> Seed<D> {
        let node = self.program.node(id);
        let path = self.child_path(parent, child);
        let entered_at = self.out.events.len();
        let inputs = self.child_inputs(parent, node, path, error.as_ref());
        let frame = self.run.frames.get(parent);
        Seed {
            node: id,
            path,
            branch: frame.branch,
            parent,
            preempted: false,
            start_depth: self.view().start_depth(parent, child),
            inputs,
            outputs: Arc::clone(&node.outputs),
            error,
            entered_at,
        }
    }

    pub(in crate::engine) fn child_path(&mut self, parent: u32, child: u32) -> PathId {
        let path = self.run.frames.get(parent).path;
        self.run.places.enter(path, child, self.program)
    }

    /// Makes a frame the active child of another, or the root of the run.
    pub(in crate::engine) fn hang(&mut self, parent: u32, child: u32, slot: u32) {
        if parent == NONE {
            self.run.root = Some(slot);
            return;
        }
        self.run.frames.get_mut(parent).children.set_active(child, Some(slot));
    }

    /// Enters the child with this index. Its frame joins the tree before it does anything, so that a request to end
    /// reaches it.
    pub(in crate::engine) fn begin(
        &mut self,
        mut seed: Seed<D>,
        child: u32,
        verdicts: Option<Arc<Verdicts<D>>>,
    ) {
        self.give_inputs(&mut seed);
        let (node, parent) = (self.program.node(seed.node), seed.parent);
        let (path, inputs) = (seed.path, Arc::clone(&seed.inputs));
        self.out.events.insert(
            seed.entered_at,
            Event::Entered { path, node: seed.node, inputs, undoes: None },
        );
        self.check_inputs(path, node, &seed.inputs);
        for (port, reason) in &node.bad_outputs {
            let port = node.outputs().get(*port as usize).map(|port| port.name.clone());
            let note = Note::BadDefault { port: port.unwrap_or_default(), reason: reason.clone() };
            self.note(path, Level::Error, note);
        }
        let slot = self.run.frames.add(seed, Children::of(&node.body));
        self.run.entries += 1;
        self.run.frames.get_mut(slot).entry = self.run.entries;
        self.hang(parent, child, slot);
        self.run.entered += u64::from(!matches!(node.body, Body::Library(_)));
        match &node.body {
            Body::Script => self.run_script(slot, verdicts),
            Body::Hierarchy(inside) => self.begin_container(slot, inside),
            Body::Concurrency(kind, inside) => self.begin_concurrency(slot, *kind, inside),
            Body::Library(content) => self.begin_library(slot, content),
        }
    }

    pub(in crate::engine) fn run_script(&mut self, slot: u32, verdicts: Option<Arc<Verdicts<D>>>) {
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
            error: frame.error.clone(),
            preempted: frame.preempted,
            verdicts,
            backward: false,
        }));
    }

    fn begin_container(&mut self, slot: u32, inside: &'s Inside<D>) {
        if !self.fails_to_begin(slot, inside) {
            self.fill(slot, inside);
            let keeps = self.view().keeps_undo_log();
            if let Some(children) = self.run.frames.get_mut(slot).children.in_turn_mut() {
                children.undo_log.logs = keeps;
            }
            self.advance_later(slot);
        }
    }

    fn begin_concurrency(&mut self, slot: u32, kind: Concurrency, inside: &'s Inside<D>) {
        if self.fails_to_begin(slot, inside) {
            return;
        }
        self.fill(slot, inside);
        if self.run.frames.get(slot).preempted {
            return self.leave_container_later(slot, inside, PREEMPTED);
        }
        let keeps = self.view().keeps_undo_log();
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Branches;
        let branches = all_but_decider(kind, inside).rev();
        let before = self.run.work.len();
        self.run.work.extend(branches.map(|child| Work::Enter { parent: slot, child }));
        let open = index(self.run.work.len() - before);
        if let Some(children) = frame.children.side_by_side_mut() {
            children.open = open;
            children.base = keeps.then(|| frame.slots.clone());
        }
        match kind {
            Concurrency::Preemptive if open == 0 => self.wait(slot, WaitReason::NoChildren),
            Concurrency::Barrier(_) if open == 0 => self.advance_later(slot),
            Concurrency::Barrier(_) | Concurrency::Preemptive => {}
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// Depth on the start path of a child that is on it and is entered first.
    pub(in crate::engine) fn start_depth(&self, parent: u32, child: u32) -> Option<u32> {
        let frame = self.run.frames.get(parent);
        let depth = frame.start_depth.filter(|_| frame.last.is_none())?;
        let path = &self.run.start_from;
        let is_on_path = path.get(depth as usize) == Some(&child);
        (is_on_path && depth as usize + 1 < path.len()).then_some(depth + 1)
    }
}
