//! Deadlines and lost-link policies: they end the waiting of a machine without a person.

use rafcon_model::{Json, Kind, LibraryContent, Loss, Machine};

/// The entry of the semantic data with a state's deadline.
const DEADLINE: &str = "deadline_s";

/// True if a state of the machine has a deadline or a lost-link policy.
pub(super) fn ends_itself(machine: &Machine) -> bool {
    let keys = [DEADLINE, Loss::Link.key(), Loss::Command.key()];
    let mut open = vec![&machine.root];
    while let Some(state) = open.pop() {
        let data = state.semantic_data.as_deref();
        if keys.iter().any(|key| data.and_then(|data| Json::get(data, key)).is_some()) {
            return true;
        }
        open.extend(state.container().into_iter().flat_map(|inside| inside.states.values()));
        if let Kind::Library(library) = &state.kind
            && let LibraryContent::Found(root) = &library.content
        {
            open.push(root);
        }
    }
    false
}
