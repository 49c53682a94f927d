//! The data flows of one container as lists of slots. A value is moved by index.

use super::compile::index;
use rafcon_model::{Container, DataFlow, PortId, Ports, State, StateId};
use std::collections::BTreeMap;

/// One list of slots for each port.
pub(super) type Lists = Vec<Vec<u32>>;

/// The wires of a child, into its inputs and out of its outputs.
#[derive(Debug, Default)]
pub(super) struct ChildWires {
    pub(super) gather: Lists,
    pub(super) scatter: Lists,
}

/// The wires of a container. Slots: its inputs, its scoped variables, then the outputs of children that flow somewhere.
#[derive(Debug)]
pub(super) struct ContainerWires {
    pub(super) slots: u32,
    /// The child and its output port for each of the last slots.
    pub(super) sources: Vec<(u32, u32)>,
    pub(super) scatter: Lists,
    pub(super) gather: Lists,
    pub(super) children: Vec<ChildWires>,
}

/// Compiles all data flows of `container`. Flows from or to missing ports move nothing.
pub(super) fn wires(state: &State, container: &Container) -> ContainerWires {
    let mut plan = Plan::new(state, container);
    for flow in container.data_flows.iter() {
        plan.add(flow);
    }
    plan.finish()
}

struct Plan<'m> {
    state: &'m State,
    scoped: &'m Ports,
    children: BTreeMap<&'m StateId, Child<'m>>,
    /// For each input of the container.
    scatter: Lists,
    /// For each output of the container.
    gather: Lists,
    slots: u32,
    sources: Vec<(u32, u32)>,
}

struct Child<'m> {
    state: &'m State,
    index: u32,
    gather: Lists,
    scatter: Lists,
    /// The slot of each output that flows to a port.
    slots: Vec<Option<u32>>,
}

impl<'m> Plan<'m> {
    fn new(state: &'m State, container: &'m Container) -> Self {
        let child = |state: &'m State, index: u32| Child {
            state,
            index,
            gather: vec![Vec::new(); state.inputs.len()],
            scatter: vec![Vec::new(); state.outputs.len()],
            slots: vec![None; state.outputs.len()],
        };
        Self {
            state,
            scoped: &container.scoped_variables,
            children: (0..)
                .zip(container.states.iter())
                .map(|(index, (id, state))| (id, child(state, index)))
                .collect(),
            scatter: vec![Vec::new(); state.inputs.len()],
            gather: vec![Vec::new(); state.outputs.len()],
            slots: index(state.inputs.len() + container.scoped_variables.len()),
            sources: Vec::new(),
        }
    }

    fn add(&mut self, flow: &DataFlow) {
        match self.scoped_target(flow) {
            Some(slot) => self.add_to_scoped(flow, slot),
            None => self.add_to_port(flow),
        }
    }

    fn scoped_slot(&self, port: PortId) -> Option<u32> {
        Some(index(self.state.inputs.len()) + position(self.scoped, port)?)
    }

    fn scoped_target(&self, flow: &DataFlow) -> Option<u32> {
        if flow.to_state == self.state.id { self.scoped_slot(flow.to_port) } else { None }
    }

    fn add_to_scoped(&mut self, flow: &DataFlow, slot: u32) {
        let list = if flow.from_state == self.state.id {
            let port = position(&self.state.inputs, flow.from_port);
            port.and_then(|port| self.scatter.get_mut(port as usize))
        } else {
            self.children.get_mut(&flow.from_state).and_then(|child| {
                let port = position(&child.state.outputs, flow.from_port)?;
                child.scatter.get_mut(port as usize)
            })
        };
        if let Some(list) = list {
            list.push(slot);
        }
    }

    fn add_to_port(&mut self, flow: &DataFlow) {
        let Some(source) = self.source(flow) else { return };
        let list = if flow.to_state == self.state.id {
            let port = position(&self.state.outputs, flow.to_port);
            port.and_then(|port| self.gather.get_mut(port as usize))
        } else {
            self.children.get_mut(&flow.to_state).and_then(|child| {
                let port = position(&child.state.inputs, flow.to_port)?;
                child.gather.get_mut(port as usize)
            })
        };
        if let Some(list) = list {
            list.push(source);
        }
    }

    /// The slot of a flow's source. The first flow from a child's output allocates it.
    fn source(&mut self, flow: &DataFlow) -> Option<u32> {
        if flow.from_state == self.state.id {
            let input = position(&self.state.inputs, flow.from_port);
            return input.or_else(|| self.scoped_slot(flow.from_port));
        }
        let child = self.children.get_mut(&flow.from_state)?;
        let port = position(&child.state.outputs, flow.from_port)? as usize;
        if let Some(slot) = child.slots[port] {
            return Some(slot);
        }
        let slot = self.slots;
        self.slots += 1;
        self.sources.push((child.index, index(port)));
        child.slots[port] = Some(slot);
        child.scatter[port].push(slot);
        Some(slot)
    }

    fn finish(self) -> ContainerWires {
        let child = |child: Child<'_>| ChildWires { gather: child.gather, scatter: child.scatter };
        ContainerWires {
            slots: self.slots,
            sources: self.sources,
            scatter: self.scatter,
            gather: self.gather,
            children: self.children.into_values().map(child).collect(),
        }
    }
}

/// The index of the port with this id.
fn position(ports: &Ports, id: PortId) -> Option<u32> {
    ports.as_slice().binary_search_by_key(&id, |port| port.id).ok().map(index)
}
