//! Moves active states to another program: indices are mapped to names, and back to the new indices.

use crate::engine::state::frames::{NONE, Slot};
use crate::engine::state::phase::Phase;
use crate::engine::state::step::{Step, View};
use crate::engine::state::suspended::{StopPoint, SuspendReason};
use crate::program::{Body, Concurrency, Exit, Inside, Node};
use crate::{Datum, Event, NodeId, Program, When};
use rafcon_model::{PortId, StateId};
use std::collections::{BTreeMap, BTreeSet};

/// Source of a value in a container.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::engine) enum Source {
    Input(PortId),
    Variable(PortId),
    Output(StateId, PortId),
}

/// A container of the former program.
struct FormerNode<'p, D> {
    program: &'p Program<D>,
    node: &'p Node<D>,
    inside: &'p Inside<D>,
}

impl<D> FormerNode<'_, D> {
    fn sources(&self) -> Vec<Source> {
        sources(self.program, self.node, self.inside)
    }
}

impl<'s, D: Datum> Step<'s, D> {
    /// Moves the run from the program `before` to the program of this step.
    pub(in crate::engine) fn migrate(&mut self, before: &Program<D>) {
        self.migrate_start(before);
        self.run.places.change(self.program);
        let frames = self.view().active();
        let loose = self.migrate_holds(before);
        for &slot in &frames {
            self.migrate_frame(slot, before);
        }
        self.renew_holds();
        for slot in loose.into_iter().rev() {
            self.advance_later(slot);
        }
        for slot in frames.into_iter().rev() {
            if self.view().finds_a_way(slot) {
                self.advance_later(slot);
            }
        }
    }

    /// Keeps the part of the start path that still exists.
    fn migrate_start(&mut self, before: &Program<D>) {
        let mut at = (before.node(Program::<D>::ROOT), self.program.node(Program::<D>::ROOT));
        let mut steps = Vec::new();
        for &step in &self.run.start_from {
            let Some(was) = at.0.child(step as usize).map(|child| before.node(child)) else {
                break;
            };
            let Some((index, is)) = self.program.child_of(at.1, was.id()) else { break };
            at = (was, self.program.node(is));
            steps.push(index);
        }
        self.run.start_from = steps;
    }

    /// Maps the children before or after which branches are held to their new indices. Frames have not been moved yet.
    ///
    /// A condition about a removed child is dropped. Its frame is returned and selects its next step again.
    fn migrate_holds(&mut self, before: &Program<D>) -> Vec<u32> {
        let mut loose = Vec::new();
        for mut hold in std::mem::take(&mut self.run.control.holds) {
            let StopPoint { parent, child, .. } = hold.stop_point;
            hold.stop_point.child = self.view().same_child(before, hold.stop_point);
            let is_gone = parent != NONE && child != NONE && hold.stop_point.child == NONE;
            if let SuspendReason::Checking { scan, .. } = &mut hold.why {
                scan.stop_point = hold.stop_point;
                if is_gone {
                    loose.push(parent);
                    continue;
                }
            }
            self.run.control.holds.push(hold);
        }
        loose
    }

    /// Updates the next child of each hold, and reports the hold again if that child has changed.
    fn renew_holds(&mut self) {
        let mut holds = std::mem::take(&mut self.run.control.holds);
        for hold in &mut holds {
            let StopPoint { parent, .. } = hold.stop_point;
            let SuspendReason::Held { by, next } = &mut hold.why else { continue };
            if parent == NONE || !self.view().is_hierarchy(parent) {
                continue;
            }
            let upcoming = self.view().upcoming(parent);
            if hold.stop_point.when == When::Before {
                hold.stop_point.child = upcoming.unwrap_or(NONE);
            }
            let there = upcoming.map(|child| self.child_path(parent, child));
            if there != *next {
                *next = there;
                let (path, by) = (self.run.frames.get(parent).path, *by);
                self.out.events.push(Event::Held { path, next: there, by });
            }
        }
        self.run.control.holds = holds;
    }

    fn migrate_frame(&mut self, slot: u32, before: &Program<D>) {
        let frame = self.run.frames.get(slot);
        let was = before.node(frame.node);
        let is = self.view().node_at(frame.parent, was);
        let pass =
            frame.pass.map(|child| self.view().same_child(before, StopPoint::before(slot, child)));
        let steps = self.run.start_from.len();
        let frame = self.run.frames.get_mut(slot);
        frame.node = is;
        frame.pass = pass;
        frame.start_depth = frame.start_depth.filter(|&depth| (depth as usize) < steps);
        self.renew_outputs(slot);
        self.migrate_undo_log(slot, before, was);
        match (&was.body, self.view().body(slot)) {
            (Body::Hierarchy(old), Body::Hierarchy(new)) => {
                let former = FormerNode { program: before, node: was, inside: old };
                self.migrate_last(slot, before, old);
                self.migrate_slots(slot, &former, new);
            }
            (Body::Concurrency(_, old), Body::Concurrency(kind, new)) => {
                let former = FormerNode { program: before, node: was, inside: old };
                let known: BTreeSet<_> = former.sources().into_iter().collect();
                self.migrate_slots(slot, &former, new);
                if matches!(kind, Concurrency::Barrier(_)) {
                    self.fill_new_outputs(slot, new, &known);
                }
            }
            _ => {}
        }
    }

    /// Outputs of ended children of a barrier also follow new data flows.
    fn fill_new_outputs(&mut self, slot: u32, new: &Inside<D>, known: &BTreeSet<Source>) {
        let frame = self.run.frames.get(slot);
        let is = self.program.node(frame.node);
        let Some(children) = frame.children.side_by_side() else { return };
        let places = (0..).zip(sources(self.program, is, new));
        let outputs = places.skip(is.inputs().len() + new.scoped.len()).zip(&new.sources);
        let value = |((place, source), &(child, port)): ((usize, Source), &(u32, u32))| {
            let ended = children.ended(child).filter(|_| !known.contains(&source))?;
            let value = ended.outputs.get(port as usize).filter(|_| !ended.absent.contains(&port));
            let sequence = frame.stored_at(is, new, child);
            Some((place, Slot { sequence, value: Some(value?.clone()) }))
        };
        let values: Vec<_> = outputs.filter_map(value).collect();
        let frame = self.run.frames.get_mut(slot);
        for (place, value) in values {
            if let Some(slot) = frame.slots.get_mut(place) {
                *slot = value;
            }
        }
    }

    /// Takes the new defaults of a container's outputs, which apply at its end.
    fn renew_outputs(&mut self, slot: u32) {
        if self.run.frames.get(slot).outputs.is_some() {
            let outputs = self.view().outputs_anew(slot);
            self.run.frames.get_mut(slot).outputs = Some(outputs);
        }
    }

    fn migrate_last(&mut self, slot: u32, before: &Program<D>, old: &Inside<D>) {
        let around = self.program.node(self.run.frames.get(slot).node);
        let frame = self.run.frames.get_mut(slot);
        let Some((child, outcome)) = frame.last else { return };
        let was = before.node(old.child(child));
        let found = self.program.child_of(around, was.id());
        let last = found.and_then(|(index, node)| {
            let outcome = self.program.node(node).outcome_index(was.outcome_id(outcome).0)?;
            Some((index, outcome))
        });
        frame.last = last;
        if last.is_none() {
            // The container has begun nevertheless.
            frame.start_depth = None;
        }
    }

    /// Keeps values by name. New scoped variables begin with their default.
    fn migrate_slots(&mut self, slot: u32, former: &FormerNode<'_, D>, new: &'s Inside<D>) {
        let frame = self.run.frames.get_mut(slot);
        let (path, is) = (frame.path, self.program.node(frame.node));
        if frame.slots.len() != former.inside.slots as usize {
            return;
        }
        let values = std::mem::take(&mut frame.slots);
        let mut kept: BTreeMap<_, _> = former.sources().into_iter().zip(values).collect();
        let mut fresh = new.scoped.iter();
        for source in sources(self.program, is, new) {
            let scoped = matches!(source, Source::Variable(_)).then(|| fresh.next()).flatten();
            let value = kept.remove(&source).unwrap_or_else(|| {
                let value = scoped.map(|scoped| scoped.initial.clone());
                self.run.sequence += u64::from(value.is_some());
                if let Some((scoped, value)) = scoped.zip(value.clone()) {
                    self.out.events.push(Event::Scoped { path, port: scoped.port.id, value });
                }
                Slot { sequence: if value.is_some() { self.run.sequence } else { 0 }, value }
            });
            frame.slots.push(value);
        }
    }
}

impl<D: Datum> View<'_, '_, D> {
    /// The index that a child has now; [`NONE`] if it was removed.
    fn same_child(&self, before: &Program<D>, stop_point: StopPoint) -> u32 {
        let StopPoint { parent, child, .. } = stop_point;
        if parent == NONE {
            return child;
        }
        let path = self.run.frames.get(parent).path;
        let around = before.node(self.run.frames.get(parent).node);
        let id = around.child(child as usize).map(|child| before.node(child).id());
        let now = self.run.places.node(path).map(|node| self.program.node(node));
        let found = id.zip(now).and_then(|(id, now)| self.program.child_of(now, id));
        found.map_or(NONE, |(index, _)| index)
    }

    /// The node that replaces this one. The frame around it was moved before.
    fn node_at(&self, parent: u32, was: &Node<D>) -> NodeId {
        if parent == NONE {
            return Program::<D>::ROOT;
        }
        let around = self.program.node(self.run.frames.get(parent).node);
        self.program.child_of(around, was.id()).map_or(Program::<D>::ROOT, |found| found.1)
    }

    /// True if a waiting container can continue.
    fn finds_a_way(&self, slot: u32) -> bool {
        let frame = self.run.frames.get(slot);
        if !matches!(frame.phase, Phase::Waiting(_)) {
            return false;
        }
        match self.body(slot) {
            Body::Hierarchy(inside) => match frame.last {
                Some((child, outcome)) => self.exit(inside, child, outcome) != Exit::Nowhere,
                None => inside.start != Exit::Nowhere,
            },
            Body::Concurrency(_, inside) => frame.last.is_some_and(|(child, outcome)| {
                matches!(self.exit(inside, child, outcome), Exit::Outcome(_))
            }),
            Body::Script | Body::Library(_) => false,
        }
    }
}

/// The source of each slot of a container, in slot order.
pub(in crate::engine) fn sources<D>(
    program: &Program<D>,
    node: &Node<D>,
    inside: &Inside<D>,
) -> Vec<Source> {
    let inputs = node.inputs().iter().map(|port| Source::Input(port.id));
    let variables = inside.scoped.iter().map(|scoped| Source::Variable(scoped.port.id));
    let outputs = inside.sources.iter().filter_map(|&(child, port)| {
        let child = program.node(inside.child(child));
        let port = child.outputs().get(port as usize)?;
        Some(Source::Output(child.id().clone(), port.id))
    });
    inputs.chain(variables).chain(outputs).collect()
}
