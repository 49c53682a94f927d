//! Conversion from the model's edits to wire edits.

use super::{Edit, Element, Goal, OutcomeOf, PortList, PortOf};
use crate::document::{
    HeaderDocument, LayoutDocument, Selection, StateKind, json_of, state_documents, type_name,
    value_of,
};
use rafcon_model::edit::{
    ChildrenEdit, DataFlowEdit, Edit as Model, HeaderEdit, LayoutEdit, LayoutElement, OutcomeEdit,
    PortEdit, RuntimeValueEdit, StateEdit, TransitionEdit,
};
use rafcon_model::{Origin, PortId, PortKind, StateId, Target};

impl Edit {
    /// Converts an edit of the model. `None` for the inverse of another edit, which is never sent.
    pub fn of(edit: &Model) -> Option<Self> {
        Some(match edit {
            Model::State(path, edit) => state(path.to_string(), edit),
            Model::Outcome(path, id, edit) => outcome(path.to_string(), id.0, edit),
            Model::Port(path, kind, id, edit) => {
                port(path.to_string(), PortList::of(*kind), id.0, edit)
            }
            Model::Transition(path, id, edit) => transition(path.to_string(), id.0, edit),
            Model::DataFlow(path, id, edit) => data_flow(path.to_string(), id.0, edit),
            Model::RuntimeValue(path, kind, id, edit) => {
                runtime_value(path.to_string(), PortList::of(*kind), id.0, edit)
            }
            Model::Layout(path, edit) => layout(path.to_string(), edit),
            Model::Children(path, edit) => children(path.to_string(), edit),
            Model::Header(edit) => header(edit),
            Model::Batch(edits) => {
                Self::Batch { edits: edits.iter().map(Self::of).collect::<Option<_>>()? }
            }
            Model::Restore(_) => return None,
        })
    }
}

fn state(path: String, edit: &StateEdit) -> Edit {
    match edit {
        StateEdit::SetName(name) => Edit::SetName { path, name: name.to_string() },
        StateEdit::SetId(id) => Edit::SetId { path, id: id.to_string() },
        StateEdit::SetDescription(text) => {
            Edit::SetDescription { path, description: text.as_deref().map(str::to_owned) }
        }
        StateEdit::SetSemanticData(data) => {
            Edit::SetSemanticData { path, semantic_data: data.as_deref().map(json_of) }
        }
        StateEdit::SetScript(text) => {
            Edit::SetScript { path, script: text.as_deref().map(str::to_owned) }
        }
        StateEdit::SetKind(kind) => Edit::SetKind { path, kind: StateKind::of(*kind) },
    }
}

fn outcome(path: String, outcome: i64, edit: &OutcomeEdit) -> Edit {
    match edit {
        OutcomeEdit::Add(name) => Edit::AddOutcome { path, outcome, name: name.to_string() },
        OutcomeEdit::Rename(name) => Edit::RenameOutcome { path, outcome, name: name.to_string() },
        OutcomeEdit::Remove => Edit::RemoveOutcome { path, outcome },
    }
}

fn port(path: String, list: PortList, port: i64, edit: &PortEdit) -> Edit {
    match edit {
        PortEdit::Add { name, data_type, default } => Edit::AddPort {
            path,
            list,
            port,
            name: name.to_string(),
            data_type: type_name(data_type),
            default: value_of(default),
        },
        PortEdit::Rename(name) => Edit::RenamePort { path, list, port, name: name.to_string() },
        PortEdit::SetType(data_type) => {
            Edit::SetPortType { path, list, port, data_type: type_name(data_type) }
        }
        PortEdit::SetDefault(value) => {
            Edit::SetPortDefault { path, list, port, default: value_of(value) }
        }
        PortEdit::Remove => Edit::RemovePort { path, list, port },
    }
}

fn transition(path: String, transition: i64, edit: &TransitionEdit) -> Edit {
    match edit {
        TransitionEdit::Add { from, to } => {
            Edit::AddTransition { path, transition, from: origin(from), to: Goal::of(to) }
        }
        TransitionEdit::SetOrigin(from) => {
            Edit::SetTransitionOrigin { path, transition, from: origin(from) }
        }
        TransitionEdit::SetTarget(to) => {
            Edit::SetTransitionTarget { path, transition, to: Goal::of(to) }
        }
        TransitionEdit::Remove => Edit::RemoveTransition { path, transition },
    }
}

fn data_flow(path: String, data_flow: i64, edit: &DataFlowEdit) -> Edit {
    match edit {
        DataFlowEdit::Add { from, to } => Edit::AddDataFlow {
            path,
            data_flow,
            from: PortOf::of(&from.0, from.1),
            to: PortOf::of(&to.0, to.1),
        },
        DataFlowEdit::SetSource(from) => {
            Edit::SetDataFlowSource { path, data_flow, from: PortOf::of(&from.0, from.1) }
        }
        DataFlowEdit::SetTarget(to) => {
            Edit::SetDataFlowTarget { path, data_flow, to: PortOf::of(&to.0, to.1) }
        }
        DataFlowEdit::Remove => Edit::RemoveDataFlow { path, data_flow },
    }
}

fn runtime_value(path: String, list: PortList, port: i64, edit: &RuntimeValueEdit) -> Edit {
    match edit {
        RuntimeValueEdit::Set(value) => {
            Edit::SetRuntimeValue { path, list, port, value: value_of(value) }
        }
        RuntimeValueEdit::SetUsed(used) => Edit::UseRuntimeValue { path, list, port, used: *used },
        RuntimeValueEdit::Remove => Edit::RemoveRuntimeValue { path, list, port },
    }
}

fn layout(path: String, edit: &LayoutEdit) -> Edit {
    let pair = |point: &(f64, f64)| [point.0, point.1];
    match edit {
        LayoutEdit::SetPosition(element, at) => {
            Edit::SetPosition { path, element: Element::of(*element), position: pair(at) }
        }
        LayoutEdit::SetSize(element, size) => {
            Edit::SetSize { path, element: Element::of(*element), size: pair(size) }
        }
        LayoutEdit::SetWaypoints(element, points) => {
            let waypoints = points.iter().map(pair).collect();
            Edit::SetWaypoints { path, element: Element::of(*element), waypoints }
        }
        LayoutEdit::Set(layout) => Edit::SetLayout { path, layout: LayoutDocument::of(layout) },
    }
}

fn children(path: String, edit: &ChildrenEdit) -> Edit {
    match edit {
        ChildrenEdit::Add(state) => Edit::AddState { path, states: state_documents(state) },
        ChildrenEdit::Remove(state) => Edit::RemoveState { path, state: state.to_string() },
        ChildrenEdit::SetStart(to) => Edit::SetStart { path, to: to.as_ref().map(Goal::of) },
        ChildrenEdit::Group { states, scoped_variables, id, name } => Edit::Group {
            path,
            states: texts(states),
            scoped_variables: scoped_variables.iter().map(|id| id.0).collect(),
            id: id.to_string(),
            name: name.to_string(),
        },
        ChildrenEdit::Ungroup { state, fresh } => {
            Edit::Ungroup { path, state: state.to_string(), fresh: texts(fresh) }
        }
        ChildrenEdit::Substitute { state, by } => {
            Edit::SubstituteState { path, state: state.to_string(), states: state_documents(by) }
        }
        ChildrenEdit::Move { states, to, ids } => {
            Edit::MoveStates { path, states: texts(states), to: to.to_string(), ids: texts(ids) }
        }
        ChildrenEdit::Paste { selection, ids } => {
            Edit::Paste { path, selection: Selection::of(selection), ids: texts(ids) }
        }
    }
}

fn header(edit: &HeaderEdit) -> Edit {
    match edit {
        HeaderEdit::SetVersion(version) => {
            Edit::SetVersion { version: version.as_ref().map(ToString::to_string) }
        }
        HeaderEdit::SetLayout(layout) => {
            Edit::SetMachineLayout { layout: LayoutDocument::of(layout) }
        }
        HeaderEdit::Set(header) => Edit::SetHeader { header: HeaderDocument::of(header) },
    }
}

fn texts(ids: &[StateId]) -> Vec<String> {
    ids.iter().map(ToString::to_string).collect()
}

fn origin(origin: &Origin) -> Option<OutcomeOf> {
    match origin {
        Origin::Income => None,
        Origin::Outcome(state, outcome) => {
            Some(OutcomeOf { state: state.to_string(), outcome: outcome.0 })
        }
    }
}

impl Goal {
    fn of(target: &Target) -> Self {
        match target {
            Target::State(state) => Self::State(state.to_string()),
            Target::Outcome(outcome) => Self::Outcome(outcome.0),
        }
    }
}

impl PortOf {
    fn of(state: &StateId, port: PortId) -> Self {
        Self { state: state.to_string(), port: port.0 }
    }
}

impl PortList {
    /// Converts the model's kind of port.
    pub fn of(kind: PortKind) -> Self {
        match kind {
            PortKind::Input => Self::Input,
            PortKind::Output => Self::Output,
            PortKind::ScopedVariable => Self::ScopedVariable,
        }
    }
}

impl Element {
    fn of(element: LayoutElement) -> Self {
        match element {
            LayoutElement::State => Self::State,
            LayoutElement::Name => Self::Name,
            LayoutElement::Income => Self::Income,
            LayoutElement::Outcome(id) => Self::Outcome(id.0),
            LayoutElement::Port(PortKind::Input, id) => Self::Input(id.0),
            LayoutElement::Port(PortKind::Output, id) => Self::Output(id.0),
            LayoutElement::Port(PortKind::ScopedVariable, id) => Self::ScopedVariable(id.0),
            LayoutElement::Transition(id) => Self::Transition(id.0),
            LayoutElement::DataFlow(id) => Self::DataFlow(id.0),
        }
    }
}
