//! Edits from Python code: a verb and its arguments become a value of the model, a refusal becomes an exception. Knows the
//! verbs of `rafcon._changes`; never their effects.

use crate::build::Document;
use crate::build_value::{model_type, model_value};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::{PyAttributeError, PyNotImplementedError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rafcon_model::edit::{
    ChildrenEdit, DataFlowEdit, Edit, EditError, HeaderEdit, LayoutEdit, LayoutElement,
    OutcomeEdit, PortEdit, RuntimeValueEdit, StateEdit, TransitionEdit,
};
use rafcon_model::{
    DataFlowId, KindName, Origin, OutcomeId, PortId, PortKind, Rule, State, StateId, StatePath,
    Target, TransitionId, Value, json,
};
use smol_str::SmolStr;
use std::sync::Arc;

/// One change: the verb, the path of its state, and the verb's arguments.
#[derive(Debug)]
pub(crate) struct Request<'a, 'py> {
    pub(crate) verb: &'a str,
    pub(crate) path: StatePath,
    pub(crate) args: &'a Bound<'py, PyTuple>,
}

impl<'py> Request<'_, 'py> {
    /// The edit for this change.
    pub(crate) fn edit(self) -> PyResult<Edit> {
        match self.verb.split_once('.') {
            Some(("state", verb)) => self.state(verb),
            Some(("outcome", verb)) => self.outcome(verb),
            Some(("port", verb)) => self.port(verb),
            Some(("transition", verb)) => self.transition(verb),
            Some(("flow", verb)) => self.flow(verb),
            Some(("runtime", verb)) => self.runtime(verb),
            Some(("children", verb)) => self.children(verb),
            Some(("layout", verb)) => self.layout(verb),
            Some(("machine", "version")) => {
                let version: Option<String> = self.one()?;
                Ok(Edit::Header(HeaderEdit::SetVersion(version.map(SmolStr::from))))
            }
            _ => Err(self.unknown()),
        }
    }

    fn unknown(&self) -> PyErr {
        PyValueError::new_err(format!("no change is named {}", self.verb))
    }

    /// The arguments, whose number must match the pattern.
    fn all<T: FromPyObjectOwned<'py>>(&self) -> PyResult<T> {
        self.args.extract().map_err(Into::into)
    }

    /// The only argument; any other number is an error.
    fn one<T: FromPyObjectOwned<'py>>(&self) -> PyResult<T> {
        self.all::<(T,)>().map(|(value,)| value)
    }

    fn own_id(&self) -> StateId {
        self.path.last().cloned().unwrap_or_else(|| StateId::new(""))
    }

    fn state(self, verb: &str) -> PyResult<Edit> {
        let text = |text: Option<String>| text.map(Arc::from);
        let edit = match verb {
            "name" => StateEdit::SetName(self.one::<String>()?.into()),
            "id" => StateEdit::SetId(StateId::new(self.one::<String>()?)),
            "description" => StateEdit::SetDescription(text(self.one()?)),
            "script" => StateEdit::SetScript(text(self.one()?)),
            "semantic_data" => {
                let document: Option<String> = self.one()?;
                let read = document.map(|document| json::parse(&document)).transpose();
                let read = read.map_err(|error| PyValueError::new_err(error.to_string()))?;
                StateEdit::SetSemanticData(read.map(Arc::new))
            }
            "kind" => StateEdit::SetKind(kind_name(&self.one::<String>()?)?),
            _ => return Err(self.unknown()),
        };
        Ok(Edit::State(self.path, edit))
    }

    fn outcome(self, verb: &str) -> PyResult<Edit> {
        let (id, edit) = match verb {
            "add" => {
                self.all::<(i64, String)>().map(|(id, name)| (id, OutcomeEdit::Add(name.into())))
            }
            "rename" => {
                self.all::<(i64, String)>().map(|(id, name)| (id, OutcomeEdit::Rename(name.into())))
            }
            "remove" => self.one().map(|id: i64| (id, OutcomeEdit::Remove)),
            _ => Err(self.unknown()),
        }?;
        Ok(Edit::Outcome(self.path, OutcomeId(id), edit))
    }

    fn port(self, verb: &str) -> PyResult<Edit> {
        let (kind, id, edits) = match verb {
            "add" => {
                let (kind, id, name, of, default): (String, i64, String, String, Any<'py>) =
                    self.all()?;
                let (data_type, default) = (model_type(&of), model_value(&default)?);
                (kind, id, vec![PortEdit::Add { name: name.into(), data_type, default }])
            }
            "rename" => {
                let (kind, id, name): (String, i64, String) = self.all()?;
                (kind, id, vec![PortEdit::Rename(name.into())])
            }
            "default" => {
                let (kind, id, default): (String, i64, Any<'py>) = self.all()?;
                (kind, id, vec![PortEdit::SetDefault(model_value(&default)?)])
            }
            "type" => {
                let (kind, id, of, default): (String, i64, String, Any<'py>) = self.all()?;
                (kind, id, retype(&of, model_value(&default)?))
            }
            "remove" => {
                let (kind, id): (String, i64) = self.all()?;
                (kind, id, vec![PortEdit::Remove])
            }
            _ => return Err(self.unknown()),
        };
        let (kind, id) = (port_kind(&kind)?, PortId(id));
        let edits = edits.into_iter().map(|edit| Edit::Port(self.path.clone(), kind, id, edit));
        Ok(Edit::Batch(edits.collect()))
    }

    fn transition(self, verb: &str) -> PyResult<Edit> {
        let (id, edit) = match verb {
            "add" => {
                let (id, from_state, from_outcome, to_state, to_outcome) = self.all()?;
                let from = self.origin(from_state, from_outcome)?;
                (id, TransitionEdit::Add { from, to: self.target(to_state, to_outcome)? })
            }
            "origin" => {
                let (id, state, outcome) = self.all()?;
                (id, TransitionEdit::SetOrigin(self.origin(state, outcome)?))
            }
            "target" => {
                let (id, state, outcome) = self.all()?;
                (id, TransitionEdit::SetTarget(self.target(state, outcome)?))
            }
            "remove" => (self.one()?, TransitionEdit::Remove),
            _ => return Err(self.unknown()),
        };
        Ok(Edit::Transition(self.path, TransitionId(id), edit))
    }

    /// Origin of a transition. The container itself, without an outcome, is its income.
    fn origin(&self, state: Option<String>, outcome: Option<i64>) -> PyResult<Origin> {
        match (state, outcome) {
            (None, None) => Ok(Origin::Income),
            (Some(state), None) if state == self.own_id().as_str() => Ok(Origin::Income),
            (Some(state), Some(outcome)) => {
                Ok(Origin::Outcome(StateId::new(state), OutcomeId(outcome)))
            }
            (state, outcome) => Err(PyValueError::new_err(format!(
                "a transition cannot begin at state {state:?} and outcome {outcome:?}; name both, or neither for the start"
            ))),
        }
    }

    fn target(&self, state: Option<String>, outcome: Option<i64>) -> PyResult<Target> {
        let own = self.own_id();
        match (state, outcome) {
            (Some(state), Some(outcome)) if state == own.as_str() => {
                Ok(Target::Outcome(OutcomeId(outcome)))
            }
            (Some(state), None) if state != own.as_str() => Ok(Target::State(StateId::new(state))),
            (state, outcome) => Err(PyValueError::new_err(format!(
                "a transition cannot lead to state {state:?} and outcome {outcome:?}; name a child without an outcome, or {own} with one of its outcomes"
            ))),
        }
    }

    fn flow(self, verb: &str) -> PyResult<Edit> {
        let end = |state: String, port: i64| (StateId::new(state), PortId(port));
        let (id, edit) = match verb {
            "add" => {
                let (id, from, from_port, to, to_port) = self.all()?;
                (id, DataFlowEdit::Add { from: end(from, from_port), to: end(to, to_port) })
            }
            "origin" => self.all().map(|(id, s, p)| (id, DataFlowEdit::SetSource(end(s, p))))?,
            "target" => self.all().map(|(id, s, p)| (id, DataFlowEdit::SetTarget(end(s, p))))?,
            "remove" => (self.one()?, DataFlowEdit::Remove),
            _ => return Err(self.unknown()),
        };
        Ok(Edit::DataFlow(self.path, DataFlowId(id), edit))
    }

    fn runtime(self, verb: &str) -> PyResult<Edit> {
        let (kind, id, edit) = match verb {
            "set" => {
                let (kind, id, value): (String, i64, Any<'py>) = self.all()?;
                (kind, id, RuntimeValueEdit::Set(model_value(&value)?))
            }
            "used" => {
                let (kind, id, used): (String, i64, bool) = self.all()?;
                (kind, id, RuntimeValueEdit::SetUsed(used))
            }
            _ => return Err(self.unknown()),
        };
        Ok(Edit::RuntimeValue(self.path, port_kind(&kind)?, PortId(id), edit))
    }

    fn layout(self, verb: &str) -> PyResult<Edit> {
        let set = |path: &StatePath, edit| Edit::Layout(path.clone(), edit);
        let size = |path, size| set(path, LayoutEdit::SetSize(LayoutElement::State, size));
        match verb {
            "size" => Ok(size(&self.path, self.all()?)),
            "child" => {
                let (child, x, y, width, height): (String, _, _, _, _) = self.all()?;
                let child = self.path.child(StateId::new(child));
                let position = LayoutEdit::SetPosition(LayoutElement::State, (x, y));
                Ok(Edit::Batch(vec![set(&child, position), size(&child, (width, height))]))
            }
            _ => Err(self.unknown()),
        }
    }

    fn children(self, verb: &str) -> PyResult<Edit> {
        let ids = |ids: Vec<String>| ids.into_iter().map(StateId::new).collect();
        let edit = match verb {
            "add" => ChildrenEdit::Add(self.one::<BuiltState>()?.0),
            "remove" => ChildrenEdit::Remove(StateId::new(self.one::<String>()?)),
            "start" => {
                let (state, outcome): (Option<String>, Option<i64>) = self.all()?;
                let target = state.map(|state| self.target(Some(state), outcome));
                ChildrenEdit::SetStart(target.transpose()?)
            }
            "group" => {
                let (states, variables, id, name): (_, Vec<i64>, String, String) = self.all()?;
                let scoped_variables = variables.into_iter().map(PortId).collect();
                let (states, id, name) = (ids(states), StateId::new(id), name.into());
                ChildrenEdit::Group { states, scoped_variables, id, name }
            }
            "ungroup" => {
                let (state, fresh): (String, _) = self.all()?;
                ChildrenEdit::Ungroup { state: StateId::new(state), fresh: ids(fresh) }
            }
            "substitute" => {
                let (state, by): (String, BuiltState) = self.all()?;
                ChildrenEdit::Substitute { state: StateId::new(state), by: by.0 }
            }
            _ => return Err(self.unknown()),
        };
        Ok(Edit::Children(self.path, edit))
    }
}

/// An argument that may be any object.
type Any<'py> = Bound<'py, PyAny>;

/// A state with all its children, passed as the document in which it was built.
struct BuiltState(Arc<State>);

impl<'py> FromPyObject<'_, 'py> for BuiltState {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(object.cast::<Document>()?.get().root()))
    }
}

/// Changes of type and default, in an order in which the default always fits.
fn retype(data_type: &str, default: Value) -> Vec<PortEdit> {
    vec![
        PortEdit::SetDefault(Value::None),
        PortEdit::SetType(model_type(data_type)),
        PortEdit::SetDefault(default),
    ]
}

fn port_kind(name: &str) -> PyResult<PortKind> {
    match name {
        "inputs" => Ok(PortKind::Input),
        "outputs" => Ok(PortKind::Output),
        "scoped_variables" => Ok(PortKind::ScopedVariable),
        other => Err(PyValueError::new_err(format!("no ports are named {other}"))),
    }
}

/// The kind of states with this name.
pub(crate) fn kind_name(name: &str) -> PyResult<KindName> {
    match name {
        "execution" => Ok(KindName::Execution),
        "decider" => Ok(KindName::Decider),
        "hierarchy" => Ok(KindName::Hierarchy),
        "barrier" => Ok(KindName::Barrier),
        "preemptive" => Ok(KindName::Preemptive),
        "library" => Ok(KindName::Library),
        other => Err(PyValueError::new_err(format!("no states are of the kind {other}"))),
    }
}

/// The reference's exception for a refusal: `AttributeError` for a missing object, `TypeError` for a wrong type,
/// `NotImplementedError` for a change of a library's interface, `ValueError` otherwise.
pub(crate) fn refused(error: &EditError) -> PyErr {
    let text = error.to_string();
    match error.rule {
        Rule::NoSuchState
        | Rule::NoSuchElement
        | Rule::OutcomeMandatory
        | Rule::DeciderFixed
        | Rule::WrongKind => PyAttributeError::new_err(text),
        Rule::LibraryFixed => PyNotImplementedError::new_err(text),
        Rule::DefaultType | Rule::RuntimeValueType => PyTypeError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}
