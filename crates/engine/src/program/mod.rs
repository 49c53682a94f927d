//! A machine made ready to run: dense nodes with tables instead of names. Knows the model; knows nothing of a run.

mod compile;
mod defaults;
mod flows;
mod locate;
mod node;
mod numbers;
mod tables;

pub(crate) use compile::index;
pub use locate::UnknownPath;
pub use node::Node;
pub(crate) use node::{ABORTED, Body, Concurrency, Content, Exit, Initial, Inside, PREEMPTED};

pub(crate) use tables::{Checks, FlowRange};

use crate::NodeId;
use tables::Tables;

/// A compiled machine: one [`Node`] for each state of the machine and one set of nodes for each library content, shared
/// by all states that use it.
#[derive(Debug)]
pub struct Program<D> {
    nodes: Vec<Node<D>>,
    pub(crate) tables: Tables,
    /// The error of a hierarchy that runs in a circle without any script.
    pub(crate) circle: Option<D>,
}

impl<D> Program<D> {
    /// The root state of the machine.
    pub const ROOT: NodeId = NodeId(0);

    /// The node with this number, which must come from this program.
    pub fn node(&self, id: NodeId) -> &Node<D> {
        &self.nodes[id.index()]
    }

    /// All nodes that the machine has; the root is the first.
    pub fn nodes(&self) -> impl Iterator<Item = (NodeId, &Node<D>)> {
        (0..).map(NodeId).zip(&self.nodes).filter(|(_, node)| !node.gone)
    }

    /// One more than the highest number of a node; [`Program::change`] keeps the numbers of states that are gone.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never true: there is always a root.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}
