//! The data of one active state, requested by scripts and viewers.

use crate::engine::Engine;
use crate::program::{Body, Inside};
use crate::{Activity, Datum, PathId};
use smol_str::SmolStr;
use std::sync::Arc;

/// The data of an active state.
#[derive(Debug, Clone)]
pub struct Inspection<D> {
    /// The current activity of the state.
    pub activity: Activity,
    /// True if the state was asked to end.
    pub preempted: bool,
    /// One value for each input port, in the node's order.
    pub inputs: Arc<[D]>,
    /// The default of each output port, in the node's order.
    pub outputs: Arc<[D]>,
    /// The scoped variables of a container, by name.
    pub scoped_variables: Vec<(SmolStr, D)>,
}

impl<D: Datum> Engine<D> {
    /// The data of the state at this place; `None` if it is not active.
    pub fn inspect(&self, path: PathId) -> Option<Inspection<D>> {
        let slots = self.run.frames.below(self.run.root?);
        let slot = slots.into_iter().find(|&slot| self.run.frames.get(slot).path == path)?;
        let frame = self.run.frames.get(slot);
        let node = self.program.node(frame.node);
        let scoped_variables = match &node.body {
            Body::Hierarchy(inside) | Body::Concurrency(_, inside) => {
                self.scoped(slot, node.inputs().len(), inside)
            }
            Body::Script | Body::Library(_) => Vec::new(),
        };
        Some(Inspection {
            activity: crate::engine::state::snapshot::activity(&frame.phase),
            preempted: frame.preempted,
            inputs: frame.inputs.clone().unwrap_or_default(),
            outputs: frame.outputs.clone().unwrap_or_default(),
            scoped_variables,
        })
    }

    fn scoped(&self, slot: u32, first: usize, inside: &Inside<D>) -> Vec<(SmolStr, D)> {
        let slots = self.run.frames.get(slot).slots.get(first..).unwrap_or_default();
        let value = |slot: &crate::engine::state::frames::Slot<D>| {
            slot.value.clone().unwrap_or_else(D::none)
        };
        inside
            .scoped
            .iter()
            .zip(slots)
            .map(|(scoped, slot)| (scoped.port.name.clone(), value(slot)))
            .collect()
    }

    /// The places of the children of the state at `path`, in their order; empty for an unknown place. Allocates the
    /// places if the state was never entered.
    pub fn child_places(&mut self, path: PathId) -> &[PathId] {
        if self.run.places.node(path).is_none() {
            return &[];
        }
        self.run.places.children(path, &self.program)
    }
}
