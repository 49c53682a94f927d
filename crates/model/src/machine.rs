//! The state machine as a whole.

use crate::{Json, Kind, LibraryContent, State, StatePath};
use smol_str::SmolStr;
use std::sync::Arc;

/// A state machine: an immutable tree. Cloning it is cheap, and two machines share their common parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// The header of its file.
    pub header: Header,
    /// The outermost state, which contains all others.
    pub root: Arc<State>,
}

/// The content of `statemachine.json`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Header {
    /// UTC, `YYYY-MM-DD hh:mm:ss`; opaque.
    pub creation_time: SmolStr,
    /// The user's version of the machine or library.
    pub version: Option<SmolStr>,
    /// The program that wrote it last.
    pub used_rafcon_version: Option<SmolStr>,
    /// Layout of the machine as a whole (`sm_meta_data.json`), if any.
    pub layout: crate::Layout,
    /// Unknown keys of the file.
    pub extra: Option<Box<Json>>,
}

impl Machine {
    /// The state at `path`, also inside libraries.
    pub fn state(&self, path: &StatePath) -> Option<&Arc<State>> {
        let (first, rest) = path.0.split_first()?;
        if *first != self.root.id {
            return None;
        }
        rest.iter().try_fold(&self.root, |state, id| match &state.kind {
            Kind::Hierarchy(container) | Kind::Barrier(container) | Kind::Preemptive(container) => {
                container.states.get(id)
            }
            Kind::Library(library) => match &library.content {
                LibraryContent::Found(root) if root.id == *id => Some(root),
                LibraryContent::Found(_) | LibraryContent::Missing { .. } => None,
            },
            Kind::Execution(_) | Kind::Decider(_) => None,
        })
    }

    /// The state at `path`, mutable; `None` inside libraries. Copies shared states on the path.
    pub(crate) fn state_mut(&mut self, path: &StatePath) -> Option<&mut State> {
        let (first, rest) = path.0.split_first()?;
        if *first != self.root.id {
            return None;
        }
        rest.iter().try_fold(Arc::make_mut(&mut self.root), |state, id| {
            state.container_mut()?.states.get_mut(id).map(Arc::make_mut)
        })
    }

    /// The number of states; a library counts as one.
    pub fn count(&self) -> usize {
        let mut open = vec![&*self.root];
        let mut count = 0;
        while let Some(state) = open.pop() {
            count += 1;
            let children = state.container().into_iter().flat_map(|c| c.states.values());
            open.extend(children.map(|child| &**child));
        }
        count
    }
}
