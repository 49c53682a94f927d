//! States of a machine by their paths, including those in libraries.

use rafcon_model::{Kind, Library, LibraryContent, Machine, State, StateId, StatePath};
use std::sync::Arc;

/// All paths of a machine, parents before children.
pub(crate) fn paths(machine: &Machine) -> Vec<StatePath> {
    let mut found = vec![(StatePath::root(machine.root.id.clone()), &machine.root)];
    let mut next = 0;
    while let Some((path, state)) = found.get(next).cloned() {
        found.extend(inside(state).into_iter().map(|(id, state)| (path.child(id.clone()), state)));
        next += 1;
    }
    found.into_iter().map(|(path, _)| path).collect()
}

fn inside(state: &State) -> Vec<(&StateId, &Arc<State>)> {
    match &state.kind {
        Kind::Hierarchy(c) | Kind::Barrier(c) | Kind::Preemptive(c) => c.states.iter().collect(),
        Kind::Library(Library { content: LibraryContent::Found(root), .. }) => {
            vec![(&root.id, root)]
        }
        Kind::Library(_) | Kind::Execution(_) | Kind::Decider(_) => Vec::new(),
    }
}

/// Mutable access to the state at a path.
pub(crate) fn state_at_mut<'m>(
    machine: &'m mut Machine,
    path: &StatePath,
) -> Option<&'m mut State> {
    let mut state = Arc::make_mut(&mut machine.root);
    for id in path.0.iter().skip(1) {
        let child = match &mut state.kind {
            Kind::Hierarchy(c) | Kind::Barrier(c) | Kind::Preemptive(c) => c.states.get_mut(id)?,
            Kind::Library(Library { content: LibraryContent::Found(root), .. }) => root,
            Kind::Library(_) | Kind::Execution(_) | Kind::Decider(_) => return None,
        };
        state = Arc::make_mut(child);
    }
    Some(state)
}
