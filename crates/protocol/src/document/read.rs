//! Conversion from documents to the model. Errors name the state and the field. The model checks the rules of the result. The
//! conversion does not recurse into states, so deep machines are safe.

use super::value::{decode, decode_json};
use super::{
    DataFlowDocument, Document, HeaderDocument, LayoutDocument, LibraryDocument, OutcomeDocument,
    PortDocument, RuntimeValueDocument, Selection, StateDocument, StateKind, TransitionDocument,
};
use rafcon_model::edit;
use rafcon_model::port::Extra;
use rafcon_model::rules::MAX_NESTING;
use rafcon_model::{
    Container, DataFlow, DataFlowId, DataType, Header, Kind, Layout, Library, LibraryContent,
    Machine, Outcome, OutcomeId, Port, PortId, Ports, RuntimeValue, RuntimeValues, Script, State,
    StateId, Transition, TransitionId,
};
use serde_json::Value as Wire;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Action for each library state: load its content, or [`leave`] it without content.
pub type OnLibrary<'l> = dyn FnMut(&mut State) + 'l;

/// Leaves a library state without its content.
pub fn leave(_library: &mut State) {}

/// Reason why a document cannot be converted.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}, {field}: {what}")]
pub struct DocumentError {
    /// Path of the state, or its container.
    pub path: String,
    /// Field of the document.
    pub field: String,
    /// Description of the fault and its remedy.
    pub what: String,
}

impl DocumentError {
    pub(crate) fn new(path: &str, field: &str, what: impl Into<String>) -> Self {
        Self { path: path.to_owned(), field: field.to_owned(), what: what.into() }
    }
}

impl Document {
    /// Converts the document. `library` loads the content of each library state, or is [`leave`].
    pub fn read(&self, library: &mut OnLibrary<'_>) -> Result<Machine, DocumentError> {
        Ok(Machine { header: self.header.read()?, root: state_tree(&self.states, library)? })
    }
}

impl HeaderDocument {
    /// Converts the header to the model.
    pub(crate) fn read(&self) -> Result<Header, DocumentError> {
        let place = Place("the machine");
        Ok(Header {
            creation_time: self.creation_time.as_str().into(),
            version: self.version.as_ref().map(Into::into),
            used_rafcon_version: self.used_rafcon_version.as_ref().map(Into::into),
            layout: place.layout(self.layout.as_ref())?,
            extra: place.extra(self.extra.as_ref())?,
        })
    }
}

/// Converts one state with its descendants.
pub(crate) fn state_tree(
    documents: &[StateDocument],
    library: &mut OnLibrary<'_>,
) -> Result<Arc<State>, DocumentError> {
    let mut states = forest(documents, library)?;
    match (states.pop(), states.is_empty()) {
        (Some(state), true) => Ok(state),
        (last, _) => {
            let at = last.map_or_else(|| "an empty list".to_owned(), |state| state.id.to_string());
            let what = "expected one state and its descendants, each after its parent";
            Err(DocumentError::new(&at, "path", what))
        }
    }
}

/// Converts the outermost states with their descendants, in their order.
fn forest(
    documents: &[StateDocument],
    library: &mut OnLibrary<'_>,
) -> Result<Vec<Arc<State>>, DocumentError> {
    let mut places: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut open: Vec<(Option<usize>, State)> = Vec::with_capacity(documents.len());
    for (index, document) in documents.iter().enumerate() {
        let place = Place(&document.path);
        let (parent, state) = document.read(library)?;
        let parent = match parent {
            Some(parent) => Some(*places.get(parent).ok_or_else(|| {
                place.wrong("path", format!("its parent {parent} does not precede it"))
            })?),
            None => None,
        };
        let depth = parent.map_or(1, |(_, depth)| depth + 1);
        if depth > MAX_NESTING {
            let what = format!("it is nested deeper than {MAX_NESTING} levels; take levels out");
            return Err(place.wrong("path", what));
        }
        if places.insert(&document.path, (index, depth)).is_some() {
            return Err(place.wrong("path", "it occurs twice"));
        }
        let parent = parent.map(|(index, _)| index);
        open.push((parent, state));
    }
    join(open)
}

/// Inserts each state into its parent, the last first, so that each is complete when it is inserted.
fn join(mut open: Vec<(Option<usize>, State)>) -> Result<Vec<Arc<State>>, DocumentError> {
    let mut outermost = Vec::new();
    while let Some((parent, state)) = open.pop() {
        let Some((_, parent)) = parent.and_then(|parent| open.get_mut(parent)) else {
            outermost.push(Arc::new(state));
            continue;
        };
        let kind = parent.kind.name();
        let Some(inside) = parent.container_mut() else {
            let what = format!("a state of the kind {kind} has no children");
            return Err(DocumentError::new(parent.id.as_str(), "kind", what));
        };
        inside.states.insert(state.id.clone(), Arc::new(state));
    }
    outermost.reverse();
    Ok(outermost)
}

impl StateDocument {
    /// Returns the path of the parent, and the state without children.
    fn read(&self, library: &mut OnLibrary<'_>) -> Result<(Option<&str>, State), DocumentError> {
        let place = Place(&self.path);
        let (parent, id) = self.split()?;
        let mut state = State::new(StateId::new(id), &self.name, self.kind()?);
        state.description = self.description.as_deref().map(Into::into);
        if !self.outcomes.is_empty() {
            let outcomes = self.outcomes.iter().map(|outcome| outcome.read(place));
            state.outcomes = outcomes.collect::<Result<_, _>>()?;
        }
        state.inputs = place.ports("inputs", &self.inputs)?;
        state.outputs = place.ports("outputs", &self.outputs)?;
        state.semantic_data =
            place.json("semantic_data", self.semantic_data.as_ref())?.map(Into::into);
        state.layout = place.layout(self.layout.as_ref())?;
        state.extra = place.extra(self.extra.as_ref())?;
        if self.library.is_some() {
            library(&mut state);
        }
        Ok((parent, state))
    }

    fn split(&self) -> Result<(Option<&str>, &str), DocumentError> {
        let Some(id) = &self.id else {
            let halves = self.path.rsplit_once('/');
            return Ok(halves.map_or((None, &*self.path), |(parent, id)| (Some(parent), id)));
        };
        let rest = self.path.strip_suffix(id.as_str());
        match rest.map(|rest| (rest, rest.strip_suffix('/'))) {
            Some(("", _)) => Ok((None, id)),
            Some((_, Some(parent))) => Ok((Some(parent), id)),
            _ => Err(Place(&self.path).wrong("id", "the path does not end with it")),
        }
    }

    fn kind(&self) -> Result<Kind, DocumentError> {
        let script = || Script { text: self.script.as_deref().map(Into::into) };
        let kind = match self.kind {
            StateKind::Execution => Kind::Execution(script()),
            StateKind::Decider => Kind::Decider(script()),
            StateKind::Hierarchy => Kind::Hierarchy(self.inside()?),
            StateKind::Barrier => Kind::Barrier(self.inside()?),
            StateKind::Preemptive => Kind::Preemptive(self.inside()?),
            StateKind::Library => Kind::Library(self.library()?),
        };
        let is_container =
            matches!(kind, Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_));
        let has_script = matches!(kind, Kind::Execution(_) | Kind::Decider(_));
        let is_library = matches!(kind, Kind::Library(_));
        let fields = [
            ("script", self.script.is_some(), has_script),
            ("library", self.library.is_some(), is_library),
            ("scoped_variables", !self.scoped_variables.is_empty(), is_container),
            ("transitions", !self.transitions.is_empty(), is_container),
            ("data_flows", !self.data_flows.is_empty(), is_container),
        ];
        match fields.into_iter().find(|(_, is_there, may_be)| *is_there && !may_be) {
            Some((field, _, _)) => {
                let what = format!("a state of the kind {} has none; leave it out", kind.name());
                Err(Place(&self.path).wrong(field, what))
            }
            None => Ok(kind),
        }
    }

    fn inside(&self) -> Result<Container, DocumentError> {
        let place = Place(&self.path);
        Ok(Container {
            scoped_variables: place.ports("scoped_variables", &self.scoped_variables)?,
            transitions: self
                .transitions
                .iter()
                .map(|t| t.read(place))
                .collect::<Result<_, _>>()?,
            data_flows: self.data_flows.iter().map(|f| f.read(place)).collect::<Result<_, _>>()?,
            ..Container::default()
        })
    }

    fn library(&self) -> Result<Library, DocumentError> {
        let place = Place(&self.path);
        let what = "a library state needs the path and name of its library";
        self.library.as_ref().ok_or_else(|| place.wrong("library", what))?.read(place)
    }
}

/// Path of the state being converted, for errors.
#[derive(Clone, Copy)]
struct Place<'p>(&'p str);

impl Place<'_> {
    fn wrong(self, field: &str, what: impl Into<String>) -> DocumentError {
        DocumentError::new(self.0, field, what)
    }

    fn json(
        self,
        field: &str,
        value: Option<&Wire>,
    ) -> Result<Option<rafcon_model::Json>, DocumentError> {
        value.map(|value| decode_json(value).map_err(|what| self.wrong(field, what))).transpose()
    }

    fn extra(self, value: Option<&Wire>) -> Result<Extra, DocumentError> {
        Ok(self.json("extra", value)?.map(Box::new))
    }

    fn layout(self, layout: Option<&LayoutDocument>) -> Result<Layout, DocumentError> {
        let layout = layout.map(LayoutDocument::read).transpose();
        Ok(layout.map_err(|what| self.wrong("layout", what))?.unwrap_or_default())
    }

    fn ports(self, field: &str, ports: &[PortDocument]) -> Result<Ports, DocumentError> {
        ports.iter().map(|port| port.read(self, field)).collect()
    }
}

impl OutcomeDocument {
    fn read(&self, place: Place<'_>) -> Result<Outcome, DocumentError> {
        let extra = place.extra(self.extra.as_ref())?;
        Ok(Outcome { id: OutcomeId(self.id), name: self.name.as_str().into(), extra })
    }
}

impl PortDocument {
    fn read(&self, place: Place<'_>, field: &str) -> Result<Port, DocumentError> {
        let wrong = |what| place.wrong(&format!("{field}, port {}, default", self.id), what);
        Ok(Port {
            id: PortId(self.id),
            name: self.name.as_str().into(),
            data_type: DataType::from_file(&self.data_type),
            default: decode(&self.default).map_err(wrong)?,
            extra: place.extra(self.extra.as_ref())?,
        })
    }
}

impl TransitionDocument {
    fn read(&self, place: Place<'_>) -> Result<Transition, DocumentError> {
        Ok(Transition {
            id: TransitionId(self.id),
            from_state: self.from_state.as_ref().map(StateId::new),
            from_outcome: self.from_outcome.map(OutcomeId),
            to_state: self.to_state.as_ref().map(StateId::new),
            to_outcome: self.to_outcome.map(OutcomeId),
            extra: place.extra(self.extra.as_ref())?,
        })
    }
}

impl DataFlowDocument {
    fn read(&self, place: Place<'_>) -> Result<DataFlow, DocumentError> {
        Ok(DataFlow {
            id: DataFlowId(self.id),
            from_state: StateId::new(&self.from_state),
            from_port: PortId(self.from_port),
            to_state: StateId::new(&self.to_state),
            to_port: PortId(self.to_port),
            extra: place.extra(self.extra.as_ref())?,
        })
    }
}

impl LibraryDocument {
    fn read(&self, place: Place<'_>) -> Result<Library, DocumentError> {
        let reason = self.missing.as_deref().unwrap_or("its content has not been read");
        Ok(Library {
            path: self.path.as_str().into(),
            name: self.name.as_str().into(),
            version: self.version.as_ref().map(Into::into),
            inputs: runtime_values(place, &self.inputs)?,
            outputs: runtime_values(place, &self.outputs)?,
            content: LibraryContent::Missing { reason: reason.into() },
        })
    }
}

fn runtime_values(
    place: Place<'_>,
    values: &[RuntimeValueDocument],
) -> Result<RuntimeValues, DocumentError> {
    let value = |value: &RuntimeValueDocument| {
        let wrong = |what| place.wrong(&format!("library, value of port {}", value.port), what);
        let read = decode(&value.value).map_err(wrong)?;
        Ok((PortId(value.port), RuntimeValue { value: read, used: value.used }))
    };
    values.iter().map(value).collect()
}

impl Selection {
    /// Converts the selection to the model.
    pub(crate) fn read(
        &self,
        library: &mut OnLibrary<'_>,
    ) -> Result<edit::Selection, DocumentError> {
        let place = Place("the selection");
        let variables = self.scoped_variables.iter();
        Ok(edit::Selection {
            container: StateId::new(&self.container),
            states: forest(&self.states, library)?,
            scoped_variables: variables
                .map(|port| port.read(place, "scoped_variables"))
                .collect::<Result<_, _>>()?,
            transitions: self
                .transitions
                .iter()
                .map(|t| t.read(place))
                .collect::<Result<_, _>>()?,
            data_flows: self.data_flows.iter().map(|f| f.read(place)).collect::<Result<_, _>>()?,
        })
    }
}
