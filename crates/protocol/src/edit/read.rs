//! Conversion from wire edits to the model's. Errors name the field. The model checks that the edit is legal.

use super::{Edit, Element, Goal, OutcomeOf, PortList, PortOf};
use crate::document::{
    DocumentError, LayoutDocument, OnLibrary, leave, read_json, read_value, state_tree,
};
use rafcon_model::edit::{
    ChildrenEdit, DataFlowEdit, Edit as Model, HeaderEdit, LayoutEdit, LayoutElement, OutcomeEdit,
    PortEdit, RuntimeValueEdit, StateEdit, TransitionEdit,
};
use rafcon_model::{
    DataFlowId, DataType, Layout, Origin, OutcomeId, PortId, PortKind, StateId, StatePath, Target,
    TransitionId, Value,
};
use std::sync::Arc;

/// Maximum nesting of batches.
const NESTING_MAX: usize = 4;

/// Reason why an edit cannot be converted.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` of the edit: {what}")]
pub struct EditFault {
    /// Field of the edit.
    pub field: &'static str,
    /// Description of the fault and its remedy.
    pub what: String,
}

impl TryFrom<&Edit> for Model {
    type Error = EditFault;

    /// Converts the edit. Library states are left without content.
    fn try_from(edit: &Edit) -> Result<Self, EditFault> {
        edit.read(&mut leave)
    }
}

impl Edit {
    /// Converts the edit. `library` loads the content of each library state in it.
    pub fn read(&self, library: &mut OnLibrary<'_>) -> Result<Model, EditFault> {
        self.read_nested(library, 0)
    }

    /// Tries the four families of edits in turn. Each passes other edits to the next.
    fn read_nested(&self, library: &mut OnLibrary<'_>, depth: usize) -> Result<Model, EditFault> {
        match self {
            Self::Batch { .. } if depth >= NESTING_MAX => {
                let what =
                    format!("batches are nested deeper than {NESTING_MAX} levels; join them");
                Err(EditFault { field: "edits", what })
            }
            Self::Batch { edits } => {
                let edits = edits.iter().map(|edit| edit.read_nested(library, depth + 1));
                Ok(Model::Batch(edits.collect::<Result<_, _>>()?))
            }
            Self::SetVersion { version } => {
                Ok(Model::Header(HeaderEdit::SetVersion(version.as_ref().map(Into::into))))
            }
            Self::SetMachineLayout { layout } => {
                Ok(Model::Header(HeaderEdit::SetLayout(read_layout(layout.as_ref())?)))
            }
            Self::SetHeader { header } => {
                let header = header.read().map_err(|error| in_document("header", &error))?;
                Ok(Model::Header(HeaderEdit::Set(header)))
            }
            _ => self.of_children(library),
        }
    }

    fn of_children(&self, library: &mut OnLibrary<'_>) -> Result<Model, EditFault> {
        let (path, edit) = match self {
            Self::AddState { path, states } => {
                let state = state_tree(states, library);
                (path, ChildrenEdit::Add(state.map_err(|error| in_document("states", &error))?))
            }
            Self::RemoveState { path, state } => (path, ChildrenEdit::Remove(StateId::new(state))),
            Self::SetStart { path, to } => {
                (path, ChildrenEdit::SetStart(to.as_ref().map(Goal::read)))
            }
            Self::Group { path, states, scoped_variables, id, name } => {
                let scoped_variables = scoped_variables.iter().copied().map(PortId).collect();
                let (id, name) = (StateId::new(id), name.into());
                (path, ChildrenEdit::Group { states: ids(states), scoped_variables, id, name })
            }
            Self::Ungroup { path, state, fresh } => {
                (path, ChildrenEdit::Ungroup { state: StateId::new(state), fresh: ids(fresh) })
            }
            Self::SubstituteState { path, state, states } => {
                let by = state_tree(states, library);
                let by = by.map_err(|error| in_document("states", &error))?;
                (path, ChildrenEdit::Substitute { state: StateId::new(state), by })
            }
            Self::MoveStates { path, states, to, ids: new } => {
                let (states, to, ids) = (ids(states), StatePath::parse(to), ids(new));
                (path, ChildrenEdit::Move { states, to, ids })
            }
            Self::Paste { path, selection, ids: new } => {
                let selection = selection.read(library);
                let selection = selection.map_err(|error| in_document("selection", &error))?;
                (path, ChildrenEdit::Paste { selection, ids: ids(new) })
            }
            _ => return self.of_state(),
        };
        Ok(Model::Children(StatePath::parse(path), edit))
    }

    fn of_state(&self) -> Result<Model, EditFault> {
        let text = |text: &Option<String>| text.as_deref().map(Arc::from);
        let (path, edit) = match self {
            Self::SetName { path, name } => (path, StateEdit::SetName(name.into())),
            Self::SetId { path, id } => (path, StateEdit::SetId(StateId::new(id))),
            Self::SetDescription { path, description } => {
                (path, StateEdit::SetDescription(text(description)))
            }
            Self::SetSemanticData { path, semantic_data } => {
                let data = semantic_data.as_ref().map(read_json).transpose();
                let wrong = |what| EditFault { field: "semantic_data", what };
                (path, StateEdit::SetSemanticData(data.map_err(wrong)?.map(Arc::new)))
            }
            Self::SetScript { path, script } => (path, StateEdit::SetScript(text(script))),
            Self::SetKind { path, kind } => (path, StateEdit::SetKind((*kind).into())),
            _ => return self.of_interface(),
        };
        Ok(Model::State(StatePath::parse(path), edit))
    }

    fn of_interface(&self) -> Result<Model, EditFault> {
        let (path, id, edit) = match self {
            Self::AddOutcome { path, outcome, name } => {
                (path, outcome, OutcomeEdit::Add(name.into()))
            }
            Self::RenameOutcome { path, outcome, name } => {
                (path, outcome, OutcomeEdit::Rename(name.into()))
            }
            Self::RemoveOutcome { path, outcome } => (path, outcome, OutcomeEdit::Remove),
            _ => return self.of_port(),
        };
        Ok(Model::Outcome(StatePath::parse(path), OutcomeId(*id), edit))
    }

    fn of_port(&self) -> Result<Model, EditFault> {
        let (path, list, id, edit) = match self {
            Self::AddPort { path, list, port, name, data_type, default } => {
                let (name, data_type) = (name.into(), DataType::from_file(data_type));
                let default = read("default", default)?;
                (path, list, port, PortEdit::Add { name, data_type, default })
            }
            Self::RenamePort { path, list, port, name } => {
                (path, list, port, PortEdit::Rename(name.into()))
            }
            Self::SetPortType { path, list, port, data_type } => {
                (path, list, port, PortEdit::SetType(DataType::from_file(data_type)))
            }
            Self::SetPortDefault { path, list, port, default } => {
                (path, list, port, PortEdit::SetDefault(read("default", default)?))
            }
            Self::RemovePort { path, list, port } => (path, list, port, PortEdit::Remove),
            _ => return self.of_runtime_value(),
        };
        Ok(Model::Port(StatePath::parse(path), (*list).into(), PortId(*id), edit))
    }

    fn of_runtime_value(&self) -> Result<Model, EditFault> {
        let (path, list, id, edit) = match self {
            Self::SetRuntimeValue { path, list, port, value } => {
                (path, list, port, RuntimeValueEdit::Set(read("value", value)?))
            }
            Self::UseRuntimeValue { path, list, port, used } => {
                (path, list, port, RuntimeValueEdit::SetUsed(*used))
            }
            Self::RemoveRuntimeValue { path, list, port } => {
                (path, list, port, RuntimeValueEdit::Remove)
            }
            _ => return self.of_connection(),
        };
        Ok(Model::RuntimeValue(StatePath::parse(path), (*list).into(), PortId(*id), edit))
    }

    fn of_connection(&self) -> Result<Model, EditFault> {
        let (path, id, edit) = match self {
            Self::AddTransition { path, transition, from, to } => {
                let (from, to) = (origin(from.as_ref()), to.read());
                (path, transition, TransitionEdit::Add { from, to })
            }
            Self::SetTransitionOrigin { path, transition, from } => {
                (path, transition, TransitionEdit::SetOrigin(origin(from.as_ref())))
            }
            Self::SetTransitionTarget { path, transition, to } => {
                (path, transition, TransitionEdit::SetTarget(to.read()))
            }
            Self::RemoveTransition { path, transition } => {
                (path, transition, TransitionEdit::Remove)
            }
            _ => return self.of_data_flow(),
        };
        Ok(Model::Transition(StatePath::parse(path), TransitionId(*id), edit))
    }

    fn of_data_flow(&self) -> Result<Model, EditFault> {
        let (path, id, edit) = match self {
            Self::AddDataFlow { path, data_flow, from, to } => {
                (path, data_flow, DataFlowEdit::Add { from: from.read(), to: to.read() })
            }
            Self::SetDataFlowSource { path, data_flow, from } => {
                (path, data_flow, DataFlowEdit::SetSource(from.read()))
            }
            Self::SetDataFlowTarget { path, data_flow, to } => {
                (path, data_flow, DataFlowEdit::SetTarget(to.read()))
            }
            Self::RemoveDataFlow { path, data_flow } => (path, data_flow, DataFlowEdit::Remove),
            _ => return self.of_layout(),
        };
        Ok(Model::DataFlow(StatePath::parse(path), DataFlowId(*id), edit))
    }

    fn of_layout(&self) -> Result<Model, EditFault> {
        let pair = |[x, y]: [f64; 2]| (x, y);
        let (path, edit) = match self {
            Self::SetPosition { path, element, position } => {
                (path, LayoutEdit::SetPosition((*element).into(), pair(*position)))
            }
            Self::SetSize { path, element, size } => {
                (path, LayoutEdit::SetSize((*element).into(), pair(*size)))
            }
            Self::SetWaypoints { path, element, waypoints } => {
                let points = waypoints.iter().copied().map(pair).collect();
                (path, LayoutEdit::SetWaypoints((*element).into(), points))
            }
            Self::SetLayout { path, layout } => {
                (path, LayoutEdit::Set(read_layout(layout.as_ref())?))
            }
            _ => {
                let what = "nothing is done by this kind of edit; take another".to_owned();
                return Err(EditFault { field: "edit", what });
            }
        };
        Ok(Model::Layout(StatePath::parse(path), edit))
    }
}

fn in_document(field: &'static str, error: &DocumentError) -> EditFault {
    EditFault { field, what: error.to_string() }
}

fn read(field: &'static str, value: &serde_json::Value) -> Result<Value, EditFault> {
    read_value(value).map_err(|what| EditFault { field, what })
}

fn read_layout(layout: Option<&LayoutDocument>) -> Result<Layout, EditFault> {
    let layout = layout.map(LayoutDocument::read).transpose();
    Ok(layout.map_err(|what| EditFault { field: "layout", what })?.unwrap_or_default())
}

fn ids(texts: &[String]) -> Vec<StateId> {
    texts.iter().map(StateId::new).collect()
}

fn origin(from: Option<&OutcomeOf>) -> Origin {
    let outcome =
        |from: &OutcomeOf| Origin::Outcome(StateId::new(&from.state), OutcomeId(from.outcome));
    from.map_or(Origin::Income, outcome)
}

impl Goal {
    fn read(&self) -> Target {
        match self {
            Self::State(state) => Target::State(StateId::new(state)),
            Self::Outcome(outcome) => Target::Outcome(OutcomeId(*outcome)),
        }
    }
}

impl PortOf {
    fn read(&self) -> (StateId, PortId) {
        (StateId::new(&self.state), PortId(self.port))
    }
}

impl From<PortList> for PortKind {
    fn from(list: PortList) -> Self {
        match list {
            PortList::Input => Self::Input,
            PortList::Output => Self::Output,
            PortList::ScopedVariable => Self::ScopedVariable,
        }
    }
}

impl From<Element> for LayoutElement {
    fn from(element: Element) -> Self {
        match element {
            Element::State => Self::State,
            Element::Name => Self::Name,
            Element::Income => Self::Income,
            Element::Outcome(id) => Self::Outcome(OutcomeId(id)),
            Element::Input(id) => Self::Port(PortKind::Input, PortId(id)),
            Element::Output(id) => Self::Port(PortKind::Output, PortId(id)),
            Element::ScopedVariable(id) => Self::Port(PortKind::ScopedVariable, PortId(id)),
            Element::Transition(id) => Self::Transition(TransitionId(id)),
            Element::DataFlow(id) => Self::DataFlow(DataFlowId(id)),
        }
    }
}
