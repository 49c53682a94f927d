//! A compiled machine: dense nodes with tables instead of names. It knows the model, but no run.

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
    /// The error of a hierarchy whose children run in a circle without a script.
    pub(crate) circle: Option<D>,
}

impl<D> Program<D> {
    /// The root state of the machine.
    pub const ROOT: NodeId = NodeId(0);

    /// The node with this number, which must come from this program.
    pub fn node(&self, id: NodeId) -> &Node<D> {
        &self.nodes[id.index()]
    }

    /// All nodes of the current machine; the root is the first.
    pub fn nodes(&self) -> impl Iterator<Item = (NodeId, &Node<D>)> {
        (0..).map(NodeId).zip(&self.nodes).filter(|(_, node)| !node.gone)
    }

    /// One more than the highest node number. [`Program::change`] keeps the numbers of removed states.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Always false, because the root always exists.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}
