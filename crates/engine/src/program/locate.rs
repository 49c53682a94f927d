//! Finds the node of a path of ids.

use super::{Body, Node, Program};
use crate::NodeId;
use rafcon_model::{StateId, StatePath};
use smol_str::{SmolStr, format_smolstr};
use thiserror::Error;

/// A path that leads to no state.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("there is no state at '{path}': {}; paths are state ids from the root down, joined by '/'", self.where_it_ends())]
pub struct UnknownPath {
    /// Path that was requested.
    pub path: StatePath,
    /// Part of the path that exists.
    pub known: StatePath,
    /// The first id that does not exist.
    pub missing: StateId,
}

impl UnknownPath {
    fn where_it_ends(&self) -> SmolStr {
        let Self { missing, known, .. } = self;
        if known.0.is_empty() {
            return format_smolstr!("the root is not '{missing}'");
        }
        format_smolstr!("'{missing}' is not inside '{known}'")
    }
}

impl<D> Program<D> {
    /// The node at this path.
    pub fn find(&self, path: &StatePath) -> Result<NodeId, UnknownPath> {
        Ok(self.descend(path)?.0)
    }

    /// The node at this path, and the child index of each step below the root.
    pub(crate) fn descend(&self, path: &StatePath) -> Result<(NodeId, Vec<u32>), UnknownPath> {
        let unknown = |depth: usize| UnknownPath {
            path: path.clone(),
            known: StatePath(path.0[..depth].to_vec()),
            missing: path.0.get(depth).cloned().unwrap_or_else(|| StateId::new("")),
        };
        if path.0.first() != Some(self.node(Self::ROOT).id()) {
            return Err(unknown(0));
        }
        let mut node = Self::ROOT;
        let mut steps = Vec::new();
        for (depth, id) in path.0.iter().enumerate().skip(1) {
            let (child, step) = self.step(node, id).ok_or_else(|| unknown(depth))?;
            node = child;
            steps.push(step);
        }
        Ok((node, steps))
    }

    fn step(&self, node: NodeId, id: &StateId) -> Option<(NodeId, u32)> {
        self.child_of(self.node(node), id).map(|(index, child)| (child, index))
    }

    /// Index and node of the child with this id.
    pub(crate) fn child_of(&self, node: &Node<D>, id: &StateId) -> Option<(u32, NodeId)> {
        match &node.body {
            Body::Script => None,
            Body::Library(content) => {
                let root = content.root().filter(|root| self.node(*root).id() == id);
                root.map(|root| (0, root))
            }
            // Children are sorted by id.
            Body::Hierarchy(inside) | Body::Concurrency(_, inside) => {
                let found = inside.children.binary_search_by(|&c| self.node(c).id().cmp(id));
                found.ok().map(|index| (super::index(index), inside.children[index]))
            }
        }
    }
}
