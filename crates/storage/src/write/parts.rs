//! Content of each file of a state, from the state and the bytes that it was read from. Does not determine folders.

use super::encode;
use crate::files::{Part, Saved, StateFolder};
use rafcon_model::{Container, Kind, Library, State, StateId, json};

/// A state on disk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Old<'o> {
    pub(crate) state: &'o std::sync::Arc<State>,
    pub(crate) place: &'o StateFolder,
}

impl<'o> Old<'o> {
    /// The root of a machine.
    pub(crate) fn of(saved: &'o Saved) -> Self {
        Self { state: &saved.root, place: &saved.place }
    }

    /// The states in it, by rising id.
    pub(crate) fn children(self) -> impl Iterator<Item = (&'o StateId, Self)> {
        let container = self.state.container().into_iter();
        let mut states = container.flat_map(|container| container.states.iter()).peekable();
        self.place.children().iter().filter_map(move |(id, place)| {
            while states.next_if(|(known, _)| *known < id).is_some() {}
            let (id, state) = states.next_if(|(known, _)| *known == id)?;
            Some((id, Self { state, place }))
        })
    }
}

/// The text of the file from the state; `None` if the state has no such file.
pub(crate) fn text(state: &State, part: Part) -> Option<String> {
    match part {
        Part::Core => Some(encode::core(state)),
        Part::Script => state.script()?.text.as_deref().map(str::to_owned),
        Part::Semantic => state.semantic_data.as_deref().map(json::write),
        Part::Layout => state.layout.text().map(encode::document),
    }
}

/// Returns true if both states have equal content in this file.
pub(crate) fn is_same(new: &State, old: &State, part: Part) -> bool {
    match part {
        Part::Core => is_same_core(new, old),
        Part::Script => new.script() == old.script(),
        Part::Semantic => new.semantic_data == old.semantic_data,
        Part::Layout => new.layout == old.layout,
    }
}

fn is_same_core(new: &State, old: &State) -> bool {
    let same = new.id == old.id
        && new.name == old.name
        && new.description == old.description
        && new.outcomes == old.outcomes
        && new.extra == old.extra;
    let same_ports = || new.inputs == old.inputs && new.outputs == old.outputs;
    same && match (&new.kind, &old.kind) {
        (Kind::Execution(_), Kind::Execution(_)) | (Kind::Decider(_), Kind::Decider(_)) => {
            same_ports()
        }
        (Kind::Hierarchy(new), Kind::Hierarchy(old))
        | (Kind::Barrier(new), Kind::Barrier(old))
        | (Kind::Preemptive(new), Kind::Preemptive(old)) => {
            same_ports() && is_same_inside(new, old)
        }
        (Kind::Library(new), Kind::Library(old)) => is_same_reference(new, old),
        _ => false,
    }
}

/// Compares containers without their children, which have their own files.
fn is_same_inside(new: &Container, old: &Container) -> bool {
    new.transitions == old.transitions
        && new.data_flows == old.data_flows
        && new.scoped_variables == old.scoped_variables
}

/// Compares library references without the library's content, which is in no file of this machine.
fn is_same_reference(new: &Library, old: &Library) -> bool {
    let parts =
        |library: &Library| (library.path.clone(), library.name.clone(), library.version.clone());
    parts(new) == parts(old) && new.inputs == old.inputs && new.outputs == old.outputs
}

/// Returns the bytes of the file. They are the original ones if these could not be decoded and their part did not change.
pub(crate) fn bytes(state: &State, old: Option<Old<'_>>, part: Part) -> Option<Vec<u8>> {
    let verbatim = old.and_then(|old| {
        let bytes = old.place.verbatim(part)?;
        is_same(state, old.state, part).then(|| bytes.to_vec())
    });
    verbatim.or_else(|| text(state, part).map(String::into_bytes))
}

/// Returns the oddities of a state after the save: damaged files remain damaged until their part changes.
pub(crate) fn oddities(new: &State, old: Option<Old<'_>>) -> crate::files::Oddities {
    let mut oddities = crate::files::Oddities::default();
    if let Some(old) = old {
        for part in Part::ALL {
            let bytes = old.place.verbatim(part).filter(|_| is_same(new, old.state, part));
            oddities.verbatim.extend(bytes.map(|bytes| (part, std::sync::Arc::clone(bytes))));
        }
    }
    oddities
}
