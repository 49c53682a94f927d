//! Turns edits into steps.

use super::error::EditError;
use super::step::{Set, Step};
use super::{Edit, HeaderEdit, children, connections, interface, own, place};
use crate::rules::{MAX_NESTING, Rule};
use crate::{
    Container, Header, Kind, Library, LibraryContent, Machine, State, StateId, StatePath, Types,
};

/// The steps of an edit. Rules about single parts are checked after the steps have run, all other rules here.
pub(super) fn plan(
    machine: &Machine,
    edit: Edit,
    types: &dyn Types,
) -> Result<Vec<Step>, EditError> {
    match edit {
        Edit::State(path, edit) => own::plan(machine, &path, edit),
        Edit::Outcome(path, id, edit) => interface::outcome(machine, &path, id, edit),
        Edit::Port(path, kind, id, edit) => interface::port(machine, &path, kind, id, edit),
        Edit::Transition(path, id, edit) => connections::transition(machine, &path, id, edit),
        Edit::DataFlow(path, id, edit) => connections::data_flow(machine, &path, id, edit),
        Edit::RuntimeValue(path, kind, id, edit) => {
            own::runtime_value(machine, &path, kind, id, edit)
        }
        Edit::Layout(path, edit) => place::plan(machine, &path, &edit),
        Edit::Children(path, edit) => children::plan(machine, &path, edit, types),
        Edit::Header(edit) => Ok(header(machine, edit)),
        Edit::Batch(_) | Edit::Restore(_) => Ok(Vec::new()),
    }
}

fn header(machine: &Machine, edit: HeaderEdit) -> Vec<Step> {
    let earlier = machine.header.clone();
    let header = match edit {
        HeaderEdit::SetVersion(version) => Header { version, ..earlier },
        HeaderEdit::SetLayout(layout) => Header { layout, ..earlier },
        HeaderEdit::Set(header) => header,
    };
    vec![Step::new(&StatePath::root(machine.root.id.clone()), Set::Header(Box::new(header)))]
}

/// The state of an edit. The inside of a library can only be changed in the library.
pub(super) fn state_at<'m>(machine: &'m Machine, path: &StatePath) -> Result<&'m State, EditError> {
    let missing = || EditError::no_such_state(path);
    let (first, rest) = path.0.split_first().ok_or_else(missing)?;
    let mut state: &State =
        Some(&machine.root).filter(|root| root.id == *first).ok_or_else(missing)?;
    for id in rest {
        if matches!(state.kind, Kind::Library(_)) && machine.state(path).is_some() {
            let what = format!("it is inside the library state {}", state.id);
            return Err(EditError::state(path, Rule::LibraryFixed, what));
        }
        let child = state.container().and_then(|container| container.states.get(id));
        state = child.ok_or_else(missing)?;
    }
    Ok(state)
}

/// The container of an edit.
pub(super) fn container_at<'m>(
    machine: &'m Machine,
    path: &StatePath,
) -> Result<(&'m State, &'m Container), EditError> {
    let state = state_at(machine, path)?;
    let what = || format!("it is a state of the kind {}, which has no children", state.kind.name());
    let container = state.container();
    let container = container.ok_or_else(|| EditError::state(path, Rule::WrongKind, what()))?;
    Ok((state, container))
}

/// Refuses a change of the outcomes and ports of a library state whose library was found.
pub(super) fn own_interface(path: &StatePath, state: &State) -> Result<(), EditError> {
    match &state.kind {
        Kind::Library(Library { content: LibraryContent::Found(_), .. }) => {
            let what = "its outcomes and ports are those of its library";
            Err(EditError::state(path, Rule::LibraryFixed, what))
        }
        _ => Ok(()),
    }
}

/// Steps that remove the transitions and data flows of a child.
pub(super) fn disconnect(path: &StatePath, container: &Container, id: &StateId) -> Vec<Step> {
    let Container { transitions, data_flows, .. } = container;
    let transitions = transitions.into_state(id).chain(transitions.out_of_state(id));
    let transitions = transitions.map(|t| Step::new(path, Set::Transition(t.id, None)));
    let flows = data_flows.into_state(id).chain(data_flows.out_of_state(id));
    transitions.chain(flows.map(|f| Step::new(path, Set::DataFlow(f.id, None)))).collect()
}

/// Refuses a state that would be too deep as a child of the state at `parent`.
pub(super) fn nesting(parent: &StatePath, state: &State) -> Result<(), EditError> {
    let mut open = vec![(state, parent.0.len() + 1)];
    while let Some((state, depth)) = open.pop() {
        if depth > MAX_NESTING {
            let what = format!("states would be nested deeper than {MAX_NESTING} levels");
            return Err(EditError::state(parent, Rule::Nesting, what));
        }
        let children = state.container().into_iter().flat_map(|c| c.states.values());
        open.extend(children.map(|child| (&**child, depth + 1)));
    }
    Ok(())
}
