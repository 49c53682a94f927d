//! Changes of the machine during a run: which changes affect active states, and when a change is applied.

use crate::engine::state::step::Work;
use crate::engine::{ChangeEffect, Command, Engine, Refusal, Status};
use crate::program::{Body, Node};
use crate::{Change, Datum, Event, Globals, NodeId, Outbox, PathId, Program};
use rafcon_model::{OutcomeId, Port};
use std::collections::BTreeMap;
use std::sync::Arc;

impl<D: Datum> Engine<D> {
    /// Switches to another program, refuses it, or keeps it until no active state prevents it.
    pub(in crate::engine) fn change(
        &mut self,
        change: Change<D>,
        globals: &dyn Globals<D>,
        out: &mut Outbox<D>,
    ) -> Result<(), Refusal> {
        self.view().legal(Command::Change)?;
        match self.touched(&change.program) {
            Ok(()) => {
                self.run.turn += 1;
                self.take_over(change.program, globals, out);
                self.work(globals, out);
            }
            Err((path, _)) if change.wait => {
                self.run.change = Some(change.program);
                out.events.push(Event::ChangeWaits { path });
            }
            Err((path, touch)) => {
                return Err(Refusal::Touches { path: self.path_text(path), touch });
            }
        }
        Ok(())
    }

    /// Does all remaining work. A waiting change is applied as soon as no active state prevents it, also between the
    /// end of a state and the next one.
    pub(in crate::engine) fn work(&mut self, globals: &dyn Globals<D>, out: &mut Outbox<D>) {
        while self.run.change.is_some() {
            let is_gap = self.run.work.iter().all(|work| matches!(work, Work::Advance(_)));
            if is_gap && let Some(program) = self.change_that_fits() {
                self.take_over(program, globals, out);
            }
            if !self.step(globals, out).work_once() {
                break;
            }
        }
        self.step(globals, out).work();
        self.run.branches.settle();
    }

    fn change_that_fits(&mut self) -> Option<Arc<Program<D>>> {
        let program = self.run.change.take()?;
        if self.touched(&program).is_ok() {
            return Some(program);
        }
        self.run.change = Some(program);
        None
    }

    fn take_over(
        &mut self,
        program: Arc<Program<D>>,
        globals: &dyn Globals<D>,
        out: &mut Outbox<D>,
    ) {
        self.run.change = None;
        out.events.push(Event::Changed);
        let before = std::mem::replace(&mut self.program, program);
        self.step(globals, out).migrate(&before);
    }

    /// Returns an error that names the first active state that a change would affect.
    fn touched(&self, after: &Program<D>) -> Result<(), (PathId, ChangeEffect)> {
        // Applies also while the root is held before its beginning or after its end.
        let (was, is) = (self.program.node(Program::<D>::ROOT), after.node(Program::<D>::ROOT));
        if self.run.status != Status::Idle && was.id() != is.id() {
            return Err((PathId(0), ChangeEffect::Removed));
        }
        let frames = self.run.root.map(|root| self.run.frames.below(root)).unwrap_or_default();
        let mut new_nodes: BTreeMap<u32, NodeId> = BTreeMap::new();
        for slot in frames {
            let frame = self.run.frames.get(slot);
            let node = self.program.node(frame.node);
            let there = match new_nodes.get(&frame.parent) {
                Some(&around) => after.child_of(after.node(around), node.id()).map(|found| found.1),
                None => Some(Program::<D>::ROOT),
            };
            let there = there.ok_or((frame.path, ChangeEffect::Removed))?;
            new_nodes.insert(slot, there);
            if let Some(touch) = touch(node, after.node(there)) {
                return Err((frame.path, touch));
            }
            self.branches_stay(slot, after, there).map_err(|touch| (frame.path, touch))?;
            self.last_stays(slot, after, there)?;
        }
        Ok(())
    }

    /// The children of an active concurrency state must keep their ids. Ended children must keep their outcomes and
    /// outputs.
    fn branches_stay(
        &self,
        slot: u32,
        after: &Program<D>,
        there: NodeId,
    ) -> Result<(), ChangeEffect> {
        let frame = self.run.frames.get(slot);
        let Body::Concurrency(_, was) = &self.program.node(frame.node).body else { return Ok(()) };
        let Body::Concurrency(_, is) = &after.node(there).body else { return Ok(()) };
        let was: Vec<_> = was.children.iter().map(|&child| self.program.node(child)).collect();
        let is: Vec<_> = is.children.iter().map(|&child| after.node(child)).collect();
        let same = was.iter().map(|child| child.id()).eq(is.iter().map(|child| child.id()));
        let ended = |child: u32| {
            frame.children.side_by_side().is_some_and(|children| children.ended(child).is_some())
        };
        let pairs = (0..).zip(was.iter().zip(&is)).filter(|(child, _)| ended(*child));
        let mut ends = pairs.map(|(_, (was, is))| {
            outcomes(was).eq(outcomes(is)) && ports(was.outputs()).eq(ports(is.outputs()))
        });
        if same && ends.all(|end| end) { Ok(()) } else { Err(ChangeEffect::Branches) }
    }

    /// The child whose transition a hierarchy is about to follow must still exist, with the outcome by which it ended.
    fn last_stays(
        &self,
        slot: u32,
        after: &Program<D>,
        there: NodeId,
    ) -> Result<(), (PathId, ChangeEffect)> {
        let frame = self.run.frames.get(slot);
        let Body::Hierarchy(inside) = &self.program.node(frame.node).body else { return Ok(()) };
        let Some((child, outcome)) = frame.last.filter(|_| !frame.children.any_active()) else {
            return Ok(());
        };
        let last = self.program.node(inside.child(child));
        let stays = after.child_of(after.node(there), last.id());
        let ends = stays.and_then(|(_, child)| after.node(child).outcome(last.outcome_id(outcome)));
        if ends.is_some() {
            return Ok(());
        }
        let path = self.run.places.child(frame.path, child as usize, &self.program);
        Err((path.unwrap_or(frame.path), ChangeEffect::Ended))
    }
}

/// The difference, if any, that prevents an active state from taking the place of another.
fn touch<D>(was: &Node<D>, is: &Node<D>) -> Option<ChangeEffect> {
    if was.state().kind.name() != is.state().kind.name() {
        return Some(ChangeEffect::Kind);
    }
    let same =
        ports(was.inputs()).eq(ports(is.inputs())) && ports(was.outputs()).eq(ports(is.outputs()));
    if !same {
        return Some(ChangeEffect::Ports);
    }
    (!outcomes(was).eq(outcomes(is))).then_some(ChangeEffect::Outcomes)
}

fn ports(ports: &[Port]) -> impl Iterator<Item = (rafcon_model::PortId, &str)> {
    ports.iter().map(|port| (port.id, port.name.as_str()))
}

fn outcomes<D>(node: &Node<D>) -> impl Iterator<Item = (OutcomeId, &str)> {
    node.outcomes().iter().map(|outcome| (outcome.id, outcome.name.as_str()))
}
