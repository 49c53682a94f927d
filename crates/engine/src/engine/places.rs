//! Numbers for the places where states run. The children of a place are numbered in one block when it is first entered,
//! so that the place of a child is one addition away.

use crate::{NodeId, PathId, Program};
use rafcon_model::StatePath;

#[derive(Debug, Clone, Copy)]
struct Place {
    node: NodeId,
    parent: Option<PathId>,
    children: Option<PathId>,
}

/// All places that were entered, and those beside them.
#[derive(Debug)]
pub(super) struct Places {
    all: Vec<Place>,
}

impl Places {
    /// The place of the root has the number 0.
    pub(super) fn new(root: NodeId) -> Self {
        Self { all: vec![Place { node: root, parent: None, children: None }] }
    }

    /// The first of the block of children of `path`; made at the first call.
    pub(super) fn children<D>(&mut self, path: PathId, program: &Program<D>) -> PathId {
        let place = self.all[path.index()];
        if let Some(first) = place.children {
            return first;
        }
        let first = PathId(u32::try_from(self.all.len()).unwrap_or(u32::MAX));
        let node = program.node(place.node);
        let block = (0..node.children()).filter_map(|index| node.child(index));
        self.all.extend(block.map(|node| Place { node, parent: Some(path), children: None }));
        self.all[path.index()].children = Some(first);
        first
    }

    pub(super) fn node(&self, path: PathId) -> Option<NodeId> {
        Some(self.all.get(path.index())?.node)
    }

    pub(super) fn parent(&self, path: PathId) -> Option<PathId> {
        self.all.get(path.index())?.parent
    }

    pub(super) fn child<D>(
        &self,
        path: PathId,
        index: usize,
        program: &Program<D>,
    ) -> Option<PathId> {
        let place = self.all.get(path.index())?;
        let offset = u32::try_from(index).ok()?;
        program.node(place.node).child(index)?;
        Some(PathId(place.children?.0 + offset))
    }

    /// Ids from the root down.
    pub(super) fn text<D>(&self, path: PathId, program: &Program<D>) -> StatePath {
        let mut ids = Vec::new();
        let mut next = Some(path);
        while let Some(place) = next.and_then(|path| self.all.get(path.index())) {
            ids.push(program.node(place.node).id().clone());
            next = place.parent;
        }
        ids.reverse();
        StatePath(ids)
    }
}
