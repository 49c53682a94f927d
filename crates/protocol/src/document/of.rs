//! Conversion from the model to documents. It is not recursive, so deep machines are safe.

use super::value::{encode, encode_json};
use super::{
    DataFlowDocument, Document, HeaderDocument, LayoutDocument, LibraryDocument, OutcomeDocument,
    PortDocument, RuntimeValueDocument, Selection, StateDocument, StateKind, TransitionDocument,
};
use rafcon_model::edit;
use rafcon_model::port::Extra;
use rafcon_model::{
    DataFlow, DataType, Header, Kind, KindName, Library, LibraryContent, Machine, Outcome, Port,
    Ports, RuntimeValues, State, StateId, Transition,
};
use serde_json::Value as Wire;

impl Document {
    /// Creates the document of a machine.
    pub fn of(machine: &Machine) -> Self {
        Self { header: HeaderDocument::of(&machine.header), states: state_documents(&machine.root) }
    }
}

/// Returns every state outside libraries with its path, in the order of a document.
pub fn states_of(machine: &Machine) -> Vec<(String, &State)> {
    let mut states = Vec::new();
    walk(&machine.root, None, |path, state| states.push((path, state)));
    states
}

/// Returns a state and its descendants outside libraries. Paths begin at the state.
pub(crate) fn state_documents(state: &State) -> Vec<StateDocument> {
    let mut states = Vec::new();
    walk(state, None, |path, state| states.push(StateDocument::of(&path, state)));
    states
}

/// Visits a state and its descendants outside libraries, each state before its children.
pub(super) fn walk<'s>(
    state: &'s State,
    parent: Option<&str>,
    mut visit: impl FnMut(String, &'s State),
) {
    let mut open = vec![(path_of(parent, &state.id), state)];
    while let Some((path, state)) = open.pop() {
        let children = state.container().into_iter().flat_map(|c| c.states.values().rev());
        open.extend(children.map(|child| (path_of(Some(&path), &child.id), &**child)));
        visit(path, state);
    }
}

fn path_of(parent: Option<&str>, id: &StateId) -> String {
    parent.map_or_else(|| id.to_string(), |parent| format!("{parent}/{id}"))
}

impl HeaderDocument {
    /// Creates the document of a machine's header.
    pub fn of(header: &Header) -> Self {
        Self {
            creation_time: header.creation_time.to_string(),
            version: header.version.as_ref().map(ToString::to_string),
            used_rafcon_version: header.used_rafcon_version.as_ref().map(ToString::to_string),
            layout: LayoutDocument::of(&header.layout),
            extra: extra(&header.extra),
        }
    }
}

impl StateDocument {
    /// Creates the document of the state at `path`, including its connections.
    pub fn of(path: &str, state: &State) -> Self {
        let mut document = Self::alone(path, state);
        if let Some(inside) = state.container() {
            document.transitions = inside.transitions.iter().map(TransitionDocument::of).collect();
            document.data_flows = inside.data_flows.iter().map(DataFlowDocument::of).collect();
        }
        document
    }

    /// Creates the document of the state at `path`, without its connections.
    pub(super) fn alone(path: &str, state: &State) -> Self {
        let is_plain = !state.id.as_str().is_empty() && !state.id.as_str().contains('/');
        let variables = state.container().map(|inside| &inside.scoped_variables);
        Self {
            path: path.to_owned(),
            id: (!is_plain).then(|| state.id.to_string()),
            name: state.name.to_string(),
            kind: StateKind::of(state.kind.name()),
            description: state.description.as_deref().map(str::to_owned),
            script: state.script().and_then(|script| script.text.as_deref()).map(str::to_owned),
            outcomes: state.outcomes.iter().map(OutcomeDocument::of).collect(),
            inputs: ports(&state.inputs),
            outputs: ports(&state.outputs),
            scoped_variables: variables.map(ports).unwrap_or_default(),
            semantic_data: state.semantic_data.as_deref().map(encode_json),
            layout: LayoutDocument::of(&state.layout),
            library: match &state.kind {
                Kind::Library(library) => Some(LibraryDocument::of(library)),
                _ => None,
            },
            transitions: Vec::new(),
            data_flows: Vec::new(),
            extra: extra(&state.extra),
        }
    }
}

impl StateKind {
    /// Converts the model's name of a kind.
    pub fn of(name: KindName) -> Self {
        match name {
            KindName::Execution => Self::Execution,
            KindName::Decider => Self::Decider,
            KindName::Hierarchy => Self::Hierarchy,
            KindName::Barrier => Self::Barrier,
            KindName::Preemptive => Self::Preemptive,
            KindName::Library => Self::Library,
        }
    }
}

impl From<StateKind> for KindName {
    fn from(kind: StateKind) -> Self {
        match kind {
            StateKind::Execution => Self::Execution,
            StateKind::Decider => Self::Decider,
            StateKind::Hierarchy => Self::Hierarchy,
            StateKind::Barrier => Self::Barrier,
            StateKind::Preemptive => Self::Preemptive,
            StateKind::Library => Self::Library,
        }
    }
}

impl OutcomeDocument {
    fn of(outcome: &Outcome) -> Self {
        Self { id: outcome.id.0, name: outcome.name.to_string(), extra: extra(&outcome.extra) }
    }
}

fn ports(ports: &Ports) -> Vec<PortDocument> {
    ports.iter().map(PortDocument::of).collect()
}

impl PortDocument {
    fn of(port: &Port) -> Self {
        Self {
            id: port.id.0,
            name: port.name.to_string(),
            data_type: type_name(&port.data_type),
            default: encode(&port.default),
            extra: extra(&port.extra),
        }
    }
}

/// Returns a name from which the type can be restored.
pub(crate) fn type_name(data_type: &DataType) -> String {
    match data_type {
        DataType::Named(name) => name.to_string(),
        _ => data_type.short_name().to_string(),
    }
}

impl TransitionDocument {
    /// Creates the document of a transition.
    pub fn of(transition: &Transition) -> Self {
        let text = |id: &Option<StateId>| id.as_ref().map(ToString::to_string);
        Self {
            id: transition.id.0,
            from_state: text(&transition.from_state),
            from_outcome: transition.from_outcome.map(|id| id.0),
            to_state: text(&transition.to_state),
            to_outcome: transition.to_outcome.map(|id| id.0),
            extra: extra(&transition.extra),
        }
    }
}

impl DataFlowDocument {
    /// Creates the document of a data flow.
    pub fn of(flow: &DataFlow) -> Self {
        Self {
            id: flow.id.0,
            from_state: flow.from_state.to_string(),
            from_port: flow.from_port.0,
            to_state: flow.to_state.to_string(),
            to_port: flow.to_port.0,
            extra: extra(&flow.extra),
        }
    }
}

impl LibraryDocument {
    fn of(library: &Library) -> Self {
        Self {
            path: library.path.to_string(),
            name: library.name.to_string(),
            version: library.version.as_ref().map(ToString::to_string),
            inputs: runtime_values(&library.inputs),
            outputs: runtime_values(&library.outputs),
            missing: match &library.content {
                LibraryContent::Found(_) => None,
                LibraryContent::Missing { reason } => Some(reason.to_string()),
            },
        }
    }
}

fn runtime_values(values: &RuntimeValues) -> Vec<RuntimeValueDocument> {
    let of = |(port, value): (&rafcon_model::PortId, &rafcon_model::RuntimeValue)| {
        RuntimeValueDocument { port: port.0, value: encode(&value.value), used: value.used }
    };
    values.iter().map(of).collect()
}

fn extra(extra: &Extra) -> Option<Wire> {
    extra.as_deref().map(encode_json)
}

impl Selection {
    /// Creates the document of a selection.
    pub fn of(selection: &edit::Selection) -> Self {
        Self {
            container: selection.container.to_string(),
            states: selection.states.iter().flat_map(|state| state_documents(state)).collect(),
            scoped_variables: selection.scoped_variables.iter().map(PortDocument::of).collect(),
            transitions: selection.transitions.iter().map(TransitionDocument::of).collect(),
            data_flows: selection.data_flows.iter().map(DataFlowDocument::of).collect(),
        }
    }
}
