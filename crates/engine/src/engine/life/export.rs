//! Exports the active states by name: the counterpart of `restore.rs`.

use crate::engine::Engine;
use crate::engine::state::frames::{ChildrenSideBySide, Ended, Frame};
use crate::program::{Body, Concurrency, Inside, Node};
use crate::{ActiveStateData, ChildEnd, Datum, ScopedValue};
use rafcon_model::{OutcomeId, PortId};
use std::collections::BTreeMap;

impl<D: Datum> Engine<D> {
    /// The active states with all their data; `None` if none is active. In a hierarchy, only the child that ended last
    /// has its true outcome. The others are given as *aborted*, because their outcomes no longer matter.
    pub fn configuration(&self) -> Option<ActiveStateData<D>> {
        let frames = self.run.frames.below(self.run.root?);
        let mut made: BTreeMap<u32, ActiveStateData<D>> = BTreeMap::new();
        for &slot in frames.iter().rev() {
            let children = self.run.frames.get(slot).children.active();
            let children = children.filter_map(|child| made.remove(&child)).collect();
            made.insert(slot, self.exported(slot, children));
        }
        made.remove(&self.run.root?)
    }

    fn exported(&self, slot: u32, children: Vec<ActiveStateData<D>>) -> ActiveStateData<D> {
        let frame = self.run.frames.get(slot);
        let node = self.program.node(frame.node);
        let inputs = frame.inputs.clone().unwrap_or_default();
        let mut restored = ActiveStateData {
            state: node.id().clone(),
            inputs: node.inputs().iter().map(|port| port.id).zip(inputs.iter().cloned()).collect(),
            order: frame.slots.first().map_or(0, |slot| slot.sequence),
            error: frame.error.clone(),
            preempted: Some(frame.preempted),
            scoped: Vec::new(),
            ended: Vec::new(),
            last: None,
            children,
        };
        match &node.body {
            Body::Script | Body::Library(_) => {}
            Body::Hierarchy(inside) => {
                restored.scoped = variables(frame, node, inside);
                restored.ended = self.ends(frame, node, inside);
                restored.last = frame.last.map(|(child, _)| self.id_of(inside, child));
            }
            Body::Concurrency(kind, inside) => {
                restored.scoped = variables(frame, node, inside);
                restored.ended = self.ends_of_branches(frame, *kind, inside);
            }
        }
        restored
    }

    fn id_of(&self, inside: &Inside<D>, child: u32) -> rafcon_model::StateId {
        self.program.node(inside.child(child)).id().clone()
    }

    /// The outputs that flow on, one entry each, and the end of the child that ended last.
    fn ends(&self, frame: &Frame<D>, node: &Node<D>, inside: &Inside<D>) -> Vec<ChildEnd<D>> {
        let slots = frame.slots.iter().skip(node.inputs().len() + inside.scoped.len());
        let given = inside.sources.iter().zip(slots).filter_map(|(&(child, port), slot)| {
            let output = self.output(inside, child, port).zip(slot.value.clone());
            let outputs = output.into_iter().collect();
            let end = ChildEnd { outputs, order: slot.sequence, ..self.end(inside, child) };
            (!end.outputs.is_empty()).then_some(end)
        });
        let mut ends: Vec<_> = given.collect();
        ends.sort_by_key(|end| end.order);
        ends.extend(frame.last.map(|(child, outcome)| ChildEnd {
            outcome: self.program.node(inside.child(child)).outcome_id(outcome),
            error: frame.last_error.clone(),
            order: self.run.sequence,
            ..self.end(inside, child)
        }));
        ends
    }

    fn end(&self, inside: &Inside<D>, child: u32) -> ChildEnd<D> {
        ChildEnd {
            state: self.id_of(inside, child),
            outcome: OutcomeId::ABORTED,
            outputs: Vec::new(),
            error: None,
            order: 0,
        }
    }

    fn output(&self, inside: &Inside<D>, child: u32, port: u32) -> Option<PortId> {
        let outputs = self.program.node(inside.child(child)).outputs();
        outputs.get(port as usize).map(|port| port.id)
    }

    /// The ends of branches. Their order puts the winner of a race first; in a barrier it is the order in which their
    /// values were stored.
    fn ends_of_branches(
        &self,
        frame: &Frame<D>,
        kind: Concurrency,
        inside: &Inside<D>,
    ) -> Vec<ChildEnd<D>> {
        let end = |(child, ended): (u32, &Ended<D>)| {
            let node = self.program.node(inside.child(child));
            let is_absent = |port: u32| ended.absent.contains(&port);
            let ports = (0..).zip(node.outputs().iter().zip(ended.outputs.iter()));
            let given = ports.filter(|(index, _)| !is_absent(*index));
            ChildEnd {
                outcome: node.outcome_id(ended.outcome),
                outputs: given.map(|(_, (port, value))| (port.id, value.clone())).collect(),
                error: ended.error.clone(),
                order: match kind {
                    Concurrency::Preemptive => u64::from(frame.children.winner() != Some(child)),
                    Concurrency::Barrier(_) => {
                        frame.stored_at(self.program.node(frame.node), inside, child)
                    }
                },
                ..self.end(inside, child)
            }
        };
        let children = frame.children.side_by_side().into_iter();
        children.flat_map(ChildrenSideBySide::ends).map(end).collect()
    }
}

fn variables<D: Datum>(
    frame: &Frame<D>,
    node: &Node<D>,
    inside: &Inside<D>,
) -> Vec<ScopedValue<D>> {
    let slots = frame.slots.iter().skip(node.inputs().len());
    let kept = inside.scoped.iter().zip(slots);
    kept.filter_map(|(scoped, slot)| {
        let value = slot.value.clone()?;
        Some(ScopedValue { port: scoped.port.id, value, order: slot.sequence })
    })
    .collect()
}
