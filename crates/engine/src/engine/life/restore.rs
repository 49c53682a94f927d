//! Restores frames, values and places of a run at a moment. From there the run continues like any other.

use crate::engine::state::frames::{Children, Ended, EndedChild, NONE, Seed, Slot};
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Step, View, Work};
use crate::engine::state::suspended::StopPoint;
use crate::engine::state::undo_log::EndedRun;
use crate::engine::stepping::concurrency::all_but_decider;
use crate::engine::{Command, Refusal, Status};
use crate::program::{ABORTED, Body, Concurrency, Content, Inside};
use crate::{
    ActiveStateData, BranchId, ChildEnd, Datum, Event, Interrupted, NodeId, PathId, Program,
    Restore, WaitReason,
};
use rafcon_model::{Port, PortId, StateId};
use std::sync::Arc;

/// Position at which a frame is restored.
#[derive(Debug, Clone, Copy)]
struct RestoredPoint {
    parent: u32,
    child: u32,
    /// Order of the last request to end that applied to everything active there.
    request: u64,
}

impl<'s, D: Datum> Step<'s, D> {
    pub(in crate::engine) fn restore(&mut self, restore: Restore<D>) -> Result<(), Refusal> {
        self.view().nothing_runs(Command::Restore)?;
        crate::engine::changes::fitting::fits(self.program, &restore.root)?;
        if self.run.status == Status::Idle {
            self.run.entered = restore.counted.states_run;
            self.run.entries = restore.counted.entries;
        }
        self.drop_all();
        self.run.crash = restore.crash;
        if self.run.status == Status::Paused {
            self.pause(false);
        }
        let stopping = restore.stopping;
        self.run.status = stopping.map_or(Status::Running, |_| Status::Stopping);
        self.run.stopped_twice = stopping.is_some_and(|stopping| stopping.twice);
        let hold = stopping.is_none() && (restore.hold || restore.interrupted == Interrupted::Wait);
        self.run.control.starting = hold;
        self.step_all(hold);
        let made = self.rebuild(restore.root, stopping.map_or(0, |stopping| stopping.order));
        if let Some(begun) = restore.begun_at {
            self.lead_on(&begun);
        }
        if stopping.is_some() {
            self.out.events.push(Event::Stopping);
        }
        self.set_going(&made, restore.interrupted, hold);
        Ok(())
    }

    /// Restores all frames of a moment, parents before children.
    fn rebuild(&mut self, root: ActiveStateData<D>, stop: u64) -> Vec<u32> {
        let mut made = Vec::new();
        let mut stack = vec![(RestoredPoint { parent: NONE, child: 0, request: stop }, root)];
        while let Some((point, restored)) = stack.pop() {
            let slot = self.rebuild_frame(point, &restored);
            made.push(slot);
            let node = self.program.node(self.run.frames.get(slot).node);
            let request = point.request.max(self.view().decided_at(slot, &restored));
            let numbered = restored.children.into_iter().filter_map(|restored| {
                let child = self.program.child_of(node, &restored.state)?.0;
                Some((RestoredPoint { parent: slot, child, request }, restored))
            });
            let first = stack.len();
            stack.extend(numbered);
            stack[first..].sort_by_key(|(point, _)| std::cmp::Reverse(point.child));
        }
        made
    }

    fn rebuild_frame(&mut self, point: RestoredPoint, restored: &ActiveStateData<D>) -> u32 {
        let RestoredPoint { parent, child, .. } = point;
        let seed = self.restored_seed(point, restored);
        let (path, id) = (seed.path, seed.node);
        let entered =
            Event::Entered { path, node: id, inputs: Arc::clone(&seed.inputs), undoes: None };
        self.out.events.insert(seed.entered_at, entered);
        let slot = self.run.frames.add(seed, Children::of(&self.program.node(id).body));
        self.run.entries += 1;
        let keeps = self.view().keeps_undo_log();
        let frame = self.run.frames.get_mut(slot);
        frame.entry = self.run.entries;
        if let Some(children) = frame.children.in_turn_mut() {
            (children.undo_log.logs, children.undo_log.lost) = (keeps, true);
        }
        self.hang(parent, child, slot);
        match &self.program.node(id).body {
            Body::Script => {}
            Body::Library(_) => {
                let end = restored.ended.iter().find_map(|end| self.view().end_of(id, end));
                if let Some(root) = self.run.frames.get_mut(slot).children.library() {
                    root.end = end.map(Box::new);
                }
            }
            Body::Hierarchy(inside) => {
                self.refill(slot, inside, restored, true);
                self.restore_last(slot, inside, restored);
            }
            Body::Concurrency(kind, inside) => {
                self.refill(slot, inside, restored, *kind != Concurrency::Preemptive);
                self.restore_ends(slot, *kind, inside, restored);
            }
        }
        slot
    }

    fn restored_seed(&mut self, point: RestoredPoint, restored: &ActiveStateData<D>) -> Seed<D> {
        let RestoredPoint { parent, child, .. } = point;
        let id = self.view().node_of_child(parent, child);
        let node = self.program.node(id);
        let path = if parent == NONE { PathId(0) } else { self.child_path(parent, child) };
        let entered_at = self.out.events.len();
        let given = |port: usize| value_of(&restored.inputs, node.inputs().get(port)?);
        let inputs = self.default_inputs(node, path, given);
        Seed {
            node: id,
            path,
            branch: self.restored_branch(parent, child),
            parent,
            preempted: self.view().was_asked_to_end(point, restored),
            start_depth: None,
            inputs,
            outputs: self.view().output_defaults(parent, node),
            error: restored.error.clone(),
            entered_at,
        }
    }

    fn restored_branch(&mut self, parent: u32, child: u32) -> BranchId {
        if parent == NONE {
            return BranchId(0);
        }
        match self.view().body(parent) {
            Body::Concurrency(kind, _) if kind.decider() != Some(child) => self.fork(parent),
            Body::Script | Body::Hierarchy(_) | Body::Concurrency(..) | Body::Library(_) => {
                self.run.frames.get(parent).branch
            }
        }
    }

    /// Restores the values of a container in their order. At equal orders, outputs come before scoped variables.
    fn refill(
        &mut self,
        slot: u32,
        inside: &Inside<D>,
        restored: &ActiveStateData<D>,
        outputs: bool,
    ) {
        let inputs = self.run.frames.get(slot).inputs.clone().unwrap_or_default();
        let mut writes: Vec<(u64, bool, u32, D)> = Vec::new();
        writes.extend((0..).zip(inputs.iter()).map(|(i, v)| (restored.order, false, i, v.clone())));
        let variables = (0..).skip(inputs.len()).zip(&*inside.scoped);
        writes.extend(variables.map(|(target, scoped)| {
            let kept = restored.scoped.iter().rfind(|kept| kept.port == scoped.port.id);
            kept.map_or_else(
                || (restored.order, true, target, scoped.initial.clone()),
                |kept| (kept.order, true, target, kept.value.clone()),
            )
        }));
        for end in restored.ended.iter().filter(|_| outputs) {
            self.view().outputs_of(slot, inside, end, &mut writes);
        }
        writes.sort_by_key(|(order, is_variable, ..)| (*order, *is_variable));
        self.write_all(slot, inside, writes);
    }

    fn write_all(&mut self, slot: u32, inside: &Inside<D>, writes: Vec<(u64, bool, u32, D)>) {
        let frame = self.run.frames.get_mut(slot);
        let (path, inputs) = (frame.path, frame.inputs.as_ref().map_or(0, |inputs| inputs.len()));
        frame.slots.resize(inside.slots as usize, Slot { sequence: 0, value: None });
        for (_, is_variable, target, value) in writes {
            let Some(place) = frame.slots.get_mut(target as usize) else { continue };
            self.run.sequence += 1;
            *place = Slot { sequence: self.run.sequence, value: Some(value.clone()) };
            let variable = (target as usize).checked_sub(inputs).filter(|_| is_variable);
            if let Some(scoped) = variable.and_then(|index| inside.scoped.get(index)) {
                self.out.events.push(Event::Scoped { path, port: scoped.port.id, value });
            }
        }
    }

    /// Restores the last ended child of a hierarchy, and its error.
    fn restore_last(&mut self, slot: u32, inside: &Inside<D>, restored: &ActiveStateData<D>) {
        let Some(last) = &restored.last else { return };
        let position = inside.children.iter().position(|&c| self.program.node(c).id() == last);
        let end = restored.ended.iter().rfind(|end| end.state == *last);
        let Some((child, end)) = position.zip(end) else { return };
        let outcome = self.program.node(inside.children[child]).outcome_index(end.outcome.0);
        let Some(outcome) = outcome else { return };
        let frame = self.run.frames.get_mut(slot);
        frame.last = Some((crate::program::index(child), outcome));
        frame.last_error = end.error.clone().filter(|_| outcome == ABORTED);
    }

    /// Restores the ends of a concurrency state's children. Children that are active again have not ended.
    fn restore_ends(
        &mut self,
        slot: u32,
        kind: Concurrency,
        inside: &Inside<D>,
        restored: &ActiveStateData<D>,
    ) {
        let runs = |id: &StateId| restored.children.iter().any(|child| child.state == *id);
        let ends = inside.children.iter().map(|&child| {
            let id = self.program.node(child).id();
            let end = restored.ended.iter().rfind(|end| end.state == *id && !runs(id))?;
            Some((end.order, self.view().end_of_child(child, end)?))
        });
        let ends: Vec<_> = ends.collect();
        let decider = kind.decider().map(|decider| decider as usize);
        let branches = ends.iter().enumerate().filter(|(child, _)| Some(*child) != decider);
        let not_ended = branches.clone().filter(|(_, end)| end.is_none()).count();
        let first = branches.filter_map(|(child, end)| Some((end.as_ref()?.0, child))).min();
        let active = restored.children.iter().map(|child| &child.state);
        let active =
            active.filter(|id| kind.decider().is_none_or(|d| !self.view().is_child(inside, d, id)));
        let active = active.count();
        let frame = self.run.frames.get_mut(slot);
        let Some(children) = frame.children.side_by_side_mut() else { return };
        if kind == Concurrency::Preemptive {
            children.winner = first.map(|(_, child)| crate::program::index(child));
        }
        let begins_no_branch = frame.preempted || children.winner.is_some();
        children.open = crate::program::index(if begins_no_branch { active } else { not_ended });
        for (child, end) in children.all.iter_mut().zip(ends) {
            child.ended = end.map(|(_, end)| end);
        }
        if let Some(decider) = kind.decider()
            && let Some(end) = children.ended(decider)
        {
            frame.last = Some((decider, end.outcome));
            frame.last_error = end.error.clone().filter(|_| end.outcome == ABORTED);
        }
    }

    /// Queues the next work of each frame. The queue is in reverse, because its last entry is done first.
    fn set_going(&mut self, made: &[u32], interrupted: Interrupted, hold: bool) {
        for &slot in made {
            if let Body::Script = self.view().body(slot) {
                self.resume_script(slot, interrupted, hold);
            }
        }
        self.run.work.reverse();
        for &slot in made.iter().rev() {
            match self.view().body(slot) {
                Body::Script => {}
                Body::Library(content) => self.resume_library(slot, content),
                Body::Hierarchy(_) => self.resume_hierarchy(slot),
                Body::Concurrency(kind, inside) => self.resume_branches(slot, *kind, inside),
            }
        }
    }

    fn resume_hierarchy(&mut self, slot: u32) {
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Child;
        if frame.children.any_active() {
            return;
        }
        let (branch, last) = (frame.branch, frame.last);
        if last.is_none_or(|(child, _)| self.passes_again(StopPoint::after(slot, child), branch)) {
            self.advance_later(slot);
        }
    }

    fn resume_library(&mut self, slot: u32, content: &'s Content<D>) {
        let frame = self.run.frames.get_mut(slot);
        frame.phase = Phase::Child;
        let Some(root) = frame.children.library() else { return };
        let end = root.end.take();
        if root.active.is_some() {
            return;
        }
        match end {
            Some(ended) => {
                let run = EndedRun::unknown(ended.outcome);
                let run = self.view().keeps_undo_log().then_some(run);
                self.library_root_ended(slot, content, EndedChild { ended: *ended, run });
            }
            None => self.begin_library(slot, content),
        }
    }

    fn resume_branches(&mut self, slot: u32, kind: Concurrency, inside: &'s Inside<D>) {
        let frame = self.run.frames.get_mut(slot);
        let Some(children) = frame.children.side_by_side() else { return };
        let decides = kind.decider().is_some_and(|decider| children.active(decider).is_some());
        frame.phase =
            if decides || frame.last.is_some() { Phase::Deciding } else { Phase::Branches };
        if frame.phase == Phase::Branches && matches!(kind, Concurrency::Barrier(_)) {
            self.hold_ended_again(slot, kind, inside);
        }
        let frame = self.run.frames.get(slot);
        let Some(children) = frame.children.side_by_side() else { return };
        if children.open == 0 && !decides {
            return match kind {
                Concurrency::Preemptive if inside.children.is_empty() && !frame.preempted => {
                    self.wait(slot, WaitReason::NoChildren);
                }
                Concurrency::Preemptive | Concurrency::Barrier(_) => self.advance_later(slot),
            };
        }
        if frame.begins_no_branch() {
            return;
        }
        let waits =
            |child: &u32| children.active(*child).is_none() && children.ended(*child).is_none();
        let begin = (0..inside.count()).rev().filter(|&child| Some(child) != kind.decider());
        let begin: Vec<_> = begin.filter(waits).collect();
        let enter = begin.into_iter().map(|child| Work::Enter { parent: slot, child });
        self.run.work.extend(enter);
    }

    /// Restores the holds of a barrier's ended branches. A branch that is held after its end counts once it is
    /// released.
    fn hold_ended_again(&mut self, slot: u32, kind: Concurrency, inside: &'s Inside<D>) {
        for child in all_but_decider(kind, inside) {
            let children = self.run.frames.get(slot).children.side_by_side();
            let has_ended = children.is_some_and(|children| children.ended(child).is_some());
            let stop_point = StopPoint::after(slot, child);
            if !has_ended || self.view().loss_at(stop_point).is_none() {
                continue;
            }
            let branch = self.fork(slot);
            if let Some(children) = self.run.frames.get_mut(slot).children.side_by_side_mut() {
                children.open += 1;
            }
            if self.passes_again(stop_point, branch) {
                self.branch_done(slot, child, branch);
            }
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The order of the end that decided a race; 0 if none did.
    fn decided_at(&self, slot: u32, restored: &ActiveStateData<D>) -> u64 {
        let frame = self.run.frames.get(slot);
        let node = self.program.node(frame.node);
        let winner = frame.children.winner().and_then(|child| node.child(child as usize));
        let winner = winner.map(|winner| self.program.node(winner).id());
        let end = restored.ended.iter().rfind(|end| Some(&end.state) == winner);
        end.map_or(0, |end| end.order)
    }

    fn node_of_child(&self, parent: u32, child: u32) -> NodeId {
        if parent == NONE {
            return Program::<D>::ROOT;
        }
        let around = self.program.node(self.run.frames.get(parent).node);
        around.child(child as usize).unwrap_or(Program::<D>::ROOT)
    }

    /// True if a request to end applies. It reaches states entered before it, and states that begin inside a state that
    /// was asked to end. It does not reach a state that a hierarchy enters later, because that is a handler.
    fn was_asked_to_end(&self, point: RestoredPoint, restored: &ActiveStateData<D>) -> bool {
        let asked = restored.preempted.unwrap_or(restored.order < point.request);
        if asked || point.parent == NONE || self.is_hierarchy(point.parent) {
            return asked;
        }
        self.run.frames.get(point.parent).begins_no_branch()
    }

    /// Collects the writes of a child's outputs. Scoped variables are restored from their own values instead.
    fn outputs_of(
        &self,
        slot: u32,
        inside: &Inside<D>,
        end: &ChildEnd<D>,
        writes: &mut Vec<(u64, bool, u32, D)>,
    ) {
        let node = self.program.node(self.run.frames.get(slot).node);
        let Some((_, child)) = self.program.child_of(node, &end.state) else { return };
        let first = node.inputs().len() + inside.scoped.len();
        let child = self.program.node(child);
        for (port, output) in child.outputs().iter().enumerate() {
            let Some(value) = value_of(&end.outputs, output) else { continue };
            let targets = self.program.tables.slots(child.scatter, port).iter();
            let slots = targets.filter(|&&target| target as usize >= first);
            writes.extend(slots.map(|&target| (end.order, false, target, value.clone())));
        }
    }

    fn is_child(&self, inside: &Inside<D>, child: u32, id: &StateId) -> bool {
        self.program.node(inside.child(child)).id() == id
    }

    /// The restored end of a library's root.
    fn end_of(&self, library: NodeId, end: &ChildEnd<D>) -> Option<Ended<D>> {
        let (_, child) = self.program.child_of(self.program.node(library), &end.state)?;
        self.end_of_child(child, end)
    }

    fn end_of_child(&self, child: NodeId, end: &ChildEnd<D>) -> Option<Ended<D>> {
        let node = self.program.node(child);
        let outcome = node.outcome_index(end.outcome.0)?;
        let outputs = node.outputs().iter().map(|port| value_of(&end.outputs, port)).collect();
        Some(crate::engine::stepping::leave::ended(node, outcome, outputs, end.error.clone()))
    }
}

/// The value with the id of this port.
fn value_of<D: Clone>(values: &[(PortId, D)], port: &Port) -> Option<D> {
    values.iter().rfind(|(id, _)| *id == port.id).map(|(_, value)| value.clone())
}
