//! What stands inside a hierarchy or concurrency state.

use crate::{
    DataFlow, DataFlowId, Origin, PortId, Ports, State, StateId, Target, Transition, TransitionId,
};
use imbl::{OrdMap, OrdSet};
use std::sync::Arc;

/// Child states by id; the order of the map is the order of children everywhere.
pub type States = OrdMap<StateId, Arc<State>>;

/// Children and the lines between them. Cloning shares everything.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Container {
    /// The children.
    pub states: States,
    /// What runs after what.
    pub transitions: Transitions,
    /// Which value goes where.
    pub data_flows: DataFlows,
    /// Variables that the children share through data flows.
    pub scoped_variables: Ports,
}

impl Container {
    /// Where execution begins: the target of the start transition in the container with the id `id`.
    pub fn start(&self, id: &StateId) -> Option<Target> {
        self.transitions.from(&Origin::Income).next()?.target(id)
    }
}

/// The transitions of a container, found by id and by origin.
#[derive(Debug, Clone, Default)]
pub struct Transitions {
    by_id: OrdMap<TransitionId, Transition>,
    by_origin: OrdSet<(Origin, TransitionId)>,
}

impl PartialEq for Transitions {
    fn eq(&self, other: &Self) -> bool {
        self.by_id == other.by_id
    }
}

impl Transitions {
    /// All by rising id.
    pub fn iter(&self) -> impl Iterator<Item = &Transition> {
        self.by_id.values()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.by_id.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.by_id.is_empty()
    }

    /// The transition with this id.
    pub fn get(&self, id: TransitionId) -> Option<&Transition> {
        self.by_id.get(&id)
    }

    /// Those that begin at `origin`: one at most in a valid container.
    pub fn from(&self, origin: &Origin) -> impl Iterator<Item = &Transition> {
        let low = (origin.clone(), TransitionId(i64::MIN));
        let high = (origin.clone(), TransitionId(i64::MAX));
        self.by_origin.range(low..=high).filter_map(|(_, id)| self.by_id.get(id))
    }

    /// Puts a transition in its place; gives back the one that had its id.
    pub fn insert(&mut self, transition: Transition) -> Option<Transition> {
        let earlier = self.remove(transition.id);
        if let Some(origin) = transition.origin() {
            self.by_origin.insert((origin, transition.id));
        }
        self.by_id.insert(transition.id, transition);
        earlier
    }

    /// Takes the transition with this id out.
    pub fn remove(&mut self, id: TransitionId) -> Option<Transition> {
        let transition = self.by_id.remove(&id)?;
        if let Some(origin) = transition.origin() {
            self.by_origin.remove(&(origin, id));
        }
        Some(transition)
    }

    /// The smallest id above all that are used, 1 at first.
    pub fn next_id(&self) -> TransitionId {
        TransitionId(self.by_id.get_max().map_or(1, |(id, _)| id.0.saturating_add(1).max(1)))
    }
}

/// The data flows of a container, found by id, by source and by target.
#[derive(Debug, Clone, Default)]
pub struct DataFlows {
    by_id: OrdMap<DataFlowId, DataFlow>,
    by_target: OrdSet<(StateId, PortId, DataFlowId)>,
}

impl PartialEq for DataFlows {
    fn eq(&self, other: &Self) -> bool {
        self.by_id == other.by_id
    }
}

impl DataFlows {
    /// All by rising id.
    pub fn iter(&self) -> impl Iterator<Item = &DataFlow> {
        self.by_id.values()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.by_id.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.by_id.is_empty()
    }

    /// The data flow with this id.
    pub fn get(&self, id: DataFlowId) -> Option<&DataFlow> {
        self.by_id.get(&id)
    }

    /// Those that end at this port, by rising id.
    pub fn into_port(&self, state: &StateId, port: PortId) -> impl Iterator<Item = &DataFlow> {
        let low = (state.clone(), port, DataFlowId(i64::MIN));
        let high = (state.clone(), port, DataFlowId(i64::MAX));
        self.by_target.range(low..=high).filter_map(|(_, _, id)| self.by_id.get(id))
    }

    /// Puts a data flow in its place; gives back the one that had its id.
    pub fn insert(&mut self, flow: DataFlow) -> Option<DataFlow> {
        let earlier = self.remove(flow.id);
        self.by_target.insert((flow.to_state.clone(), flow.to_port, flow.id));
        self.by_id.insert(flow.id, flow);
        earlier
    }

    /// Takes the data flow with this id out.
    pub fn remove(&mut self, id: DataFlowId) -> Option<DataFlow> {
        let flow = self.by_id.remove(&id)?;
        self.by_target.remove(&(flow.to_state.clone(), flow.to_port, id));
        Some(flow)
    }

    /// The smallest id above all that are used, 1 at first.
    pub fn next_id(&self) -> DataFlowId {
        DataFlowId(self.by_id.get_max().map_or(1, |(id, _)| id.0.saturating_add(1).max(1)))
    }
}
