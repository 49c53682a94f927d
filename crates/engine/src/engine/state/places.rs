//! Numbers for the places where states run. The children of a place are numbered when the place is first entered. They
//! form a list, so that the place of a child is one lookup away.

use crate::{NodeId, PathId, Program};
use rafcon_model::{StateId, StatePath};
use std::collections::BTreeMap;

#[derive(Debug, Clone, Copy)]
struct Place {
    node: NodeId,
    parent: Option<PathId>,
    /// Index of the first child in [`Places::lists`].
    children: Option<u32>,
}

/// All entered places, and their siblings.
#[derive(Debug)]
pub(in crate::engine) struct Places {
    all: Vec<Place>,
    /// The children of all places, one list after the other.
    lists: Vec<PathId>,
    /// Places of removed states, by the place around them and the state's id.
    former: BTreeMap<(PathId, StateId), PathId>,
}

impl Places {
    /// Creates the table with the root's place, number 0.
    pub(in crate::engine) fn new(root: NodeId) -> Self {
        Self {
            all: vec![Place { node: root, parent: None, children: None }],
            lists: Vec::new(),
            former: BTreeMap::new(),
        }
    }

    /// The place of a child of `path`. The first call allocates the places of all its children.
    pub(in crate::engine) fn enter<D>(
        &mut self,
        path: PathId,
        child: u32,
        program: &Program<D>,
    ) -> PathId {
        let first = match self.all[path.index()].children {
            Some(first) => first,
            None => self.number_children(path, program),
        };
        self.lists[(first + child) as usize]
    }

    /// The places of all children of `path`, allocated at the first call.
    pub(in crate::engine) fn children<D>(
        &mut self,
        path: PathId,
        program: &Program<D>,
    ) -> &[PathId] {
        let place = self.all[path.index()];
        let first = place.children.unwrap_or_else(|| self.number_children(path, program)) as usize;
        let count = program.node(place.node).children();
        &self.lists[first..first + count]
    }

    fn number_children<D>(&mut self, path: PathId, program: &Program<D>) -> u32 {
        let first = length(&self.lists);
        let node = program.node(self.all[path.index()].node);
        for child in (0..node.children()).filter_map(|index| node.child(index)) {
            let place = self.assign(path, child, program);
            self.lists.push(place);
        }
        self.all[path.index()].children = Some(first);
        first
    }

    /// The place of a state below `parent`: that of a former state with its id, otherwise a new one.
    fn assign<D>(&mut self, parent: PathId, node: NodeId, program: &Program<D>) -> PathId {
        if !self.former.is_empty() {
            let key = (parent, program.node(node).id().clone());
            if let Some(path) = self.former.remove(&key) {
                self.all[path.index()].node = node;
                return path;
            }
        }
        self.all.push(Place { node, parent: Some(parent), children: None });
        PathId(length(&self.all) - 1)
    }

    /// Updates the places for a changed program. A place whose state id still exists keeps its number.
    pub(in crate::engine) fn change<D>(&mut self, program: &Program<D>) {
        let had_children: Vec<_> = self.all.iter().map(|place| place.children.is_some()).collect();
        for path in (1..length(&self.all)).map(PathId) {
            self.former.extend(self.key(path, program).map(|key| (key, path)));
        }
        self.lists.clear();
        self.all.iter_mut().for_each(|place| place.children = None);
        // A place has a higher number than the place around it.
        for (path, _) in (0..).map(PathId).zip(had_children).filter(|(_, had)| *had) {
            if self.is_assigned(path, program) {
                self.number_children(path, program);
            }
        }
    }

    fn key<D>(&self, path: PathId, program: &Program<D>) -> Option<(PathId, StateId)> {
        let place = self.all.get(path.index())?;
        Some((place.parent?, program.node(place.node).id().clone()))
    }

    /// True if a state of the program has this place.
    fn is_assigned<D>(&self, path: PathId, program: &Program<D>) -> bool {
        self.key(path, program).is_none_or(|key| self.former.get(&key) != Some(&path))
    }

    pub(in crate::engine) fn node(&self, path: PathId) -> Option<NodeId> {
        Some(self.all.get(path.index())?.node)
    }

    pub(in crate::engine) fn parent(&self, path: PathId) -> Option<PathId> {
        self.all.get(path.index())?.parent
    }

    pub(in crate::engine) fn child<D>(
        &self,
        path: PathId,
        index: usize,
        program: &Program<D>,
    ) -> Option<PathId> {
        let place = self.all.get(path.index())?;
        program.node(place.node).child(index)?;
        self.lists.get(place.children? as usize + index).copied()
    }

    /// The ids from the root down to this place.
    pub(in crate::engine) fn text<D>(&self, path: PathId, program: &Program<D>) -> StatePath {
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

fn length<T>(list: &[T]) -> u32 {
    u32::try_from(list.len()).unwrap_or(u32::MAX)
}
