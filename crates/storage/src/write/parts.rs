//! What stands in each file of a state's folder. Knows the state and the bytes that it was read from, no folders.

use super::encode;
use crate::files::Part;
use crate::place::Place;
use rafcon_model::{State, json};

/// A state as it lies on a disk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Old<'o> {
    pub(crate) state: &'o std::sync::Arc<State>,
    pub(crate) place: &'o Place,
}

impl Old<'_> {
    /// The state with this id in it, as it lies on the disk.
    pub(crate) fn child(self, id: &rafcon_model::StateId) -> Option<Self> {
        let state = self.state.container()?.states.get(id)?;
        Some(Self { state, place: self.place.child(id)? })
    }
}

/// The text of the file, as far as the state tells; `None` if it has no such file.
pub(crate) fn text(state: &State, part: Part) -> Option<String> {
    match part {
        Part::Core => Some(encode::core(state)),
        Part::Script => state.script()?.text.as_deref().map(str::to_owned),
        Part::Semantic => state.semantic_data.as_deref().map(json::write),
        Part::Layout => state.layout.text().map(encode::document),
    }
}

/// Whether both states have the same in this file.
pub(crate) fn is_same(new: &State, old: &State, part: Part) -> bool {
    match part {
        Part::Core => encode::core(new) == encode::core(old),
        Part::Script => new.script() == old.script(),
        Part::Semantic => new.semantic_data == old.semantic_data,
        Part::Layout => new.layout == old.layout,
    }
}

/// The bytes of the file; those that were read, if they could not be understood and their part did not change.
pub(crate) fn bytes(state: &State, old: Option<Old<'_>>, part: Part) -> Option<Vec<u8>> {
    let verbatim = old.and_then(|old| {
        let bytes = old.place.verbatim(part)?;
        is_same(state, old.state, part).then(|| bytes.to_vec())
    });
    verbatim.or_else(|| text(state, part).map(String::into_bytes))
}

/// The place of a state that is written now: files that were understood to be damaged stay so while nobody changes them.
pub(crate) fn oddities(new: &State, old: Option<Old<'_>>) -> crate::place::Oddities {
    let mut oddities = crate::place::Oddities::default();
    if let Some(old) = old {
        for part in Part::ALL {
            let bytes = old.place.verbatim(part).filter(|_| is_same(new, old.state, part));
            oddities.verbatim.extend(bytes.map(|bytes| (part, std::sync::Arc::clone(bytes))));
        }
    }
    oddities
}
