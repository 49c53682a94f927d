//! What stands inside a hierarchy or concurrency state.

use crate::sorted::Sorted;
use crate::{DataFlows, Origin, Ports, State, StateId, Target, Transitions};
use std::sync::Arc;

/// Child states by id; the order of the map is the order of children everywhere.
pub type States = Sorted<StateId, Arc<State>>;

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
