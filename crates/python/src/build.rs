//! `rafcon._native.Document`: a machine or an unplaced state, while Python code builds it. Knows the model, never a run.

use crate::build_files::LibraryRoots;
use crate::build_value::PythonTypes;
use crate::edit::{Request, kind_name, refused};
use crate::{describe, scripts};
use parking_lot::{Mutex, MutexGuard};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use rafcon_model::edit::{Edit, apply};
use rafcon_model::{
    Container, Conversion, DataFlowId, Header, Kind, KindName, Library, LibraryContent, Machine,
    Ports, RuntimeValue, RuntimeValues, Script, State, StateId, StatePath, TransitionId, convert,
};
use rafcon_runner::Built;
use rafcon_storage::{Libraries, Saved, fill_library};
use smol_str::SmolStr;
use std::sync::Arc;

/// A machine under construction. An independently built state is the root of one.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
pub(crate) struct Document(Mutex<Content>);

/// Content of a document, and its file.
#[derive(Debug)]
pub(crate) struct Content {
    pub(crate) machine: Machine,
    pub(crate) saved: Option<Saved>,
    pub(crate) libraries: Arc<Libraries>,
}

/// One change: verb, path, arguments.
pub(crate) type Change<'py> = (String, String, Bound<'py, PyTuple>);

impl Document {
    /// A document with this content.
    pub(crate) fn of(machine: Machine, saved: Option<Saved>, libraries: Arc<Libraries>) -> Self {
        Self(Mutex::new(Content { machine, saved, libraries }))
    }

    /// The current machine, ready to run.
    pub(crate) fn built(&self, py: Python<'_>, libraries: &Arc<Libraries>) -> Built {
        let content = self.lock(py);
        let (machine, saved) = (content.machine.clone(), content.saved.clone());
        Built { machine, saved, libraries: Arc::clone(libraries) }
    }

    fn alone(root: State) -> Self {
        let machine = Machine { header: Header::default(), root: Arc::new(root) };
        Self::of(machine, None, Arc::default())
    }

    /// The outermost state with all its children.
    pub(crate) fn root(&self) -> Arc<State> {
        Arc::clone(&self.0.lock().machine.root)
    }

    /// The state at a path.
    fn at(&self, py: Python<'_>, path: &str) -> PyResult<Arc<State>> {
        let path = StatePath::parse(path);
        self.lock(py).machine.state(&path).cloned().ok_or_else(|| missing(&path))
    }

    /// Locks the content. Waits without the interpreter, because the holder of the lock may need it.
    pub(crate) fn lock(&self, py: Python<'_>) -> MutexGuard<'_, Content> {
        loop {
            match self.0.try_lock() {
                Some(content) => return content,
                None => py.detach(|| drop(self.0.lock())),
            }
        }
    }
}

#[pymethods]
impl Document {
    /// A new state of a kind, with only the outcomes *aborted* and *preempted*.
    #[staticmethod]
    fn state(kind: &str, state_id: &str, name: &str) -> PyResult<Self> {
        let inside = Container::default;
        let kind = match kind_name(kind)? {
            KindName::Execution => Kind::Execution(Script::default()),
            KindName::Decider => Kind::Decider(Script::default()),
            KindName::Hierarchy => Kind::Hierarchy(inside()),
            KindName::Barrier => Kind::Barrier(inside()),
            KindName::Preemptive => Kind::Preemptive(inside()),
            KindName::Library => {
                return Err(PyValueError::new_err("a library state needs a library"));
            }
        };
        Ok(Self::alone(State::new(StateId::new(state_id), name, kind)))
    }

    /// A new library state. The library must exist; its name is the default for the name of the state.
    #[staticmethod]
    fn library(
        roots: &LibraryRoots,
        reference: (String, String),
        version: Option<&str>,
        named: (String, Option<String>),
    ) -> PyResult<Self> {
        let ((path, library), (state_id, name)) = (reference, named);
        let is_unnamed = name.is_none();
        let name = name.unwrap_or_else(|| library.clone());
        let reference = Library {
            path: path.into(),
            name: library.into(),
            version: version.map(SmolStr::new),
            inputs: RuntimeValues::new(),
            outputs: RuntimeValues::new(),
            content: LibraryContent::Missing { reason: SmolStr::default() },
        };
        let mut state = State::new(StateId::new(state_id), name, Kind::Library(reference));
        fill_library(&mut state, &roots.libraries);
        set_defaults(&mut state);
        match &state.kind {
            Kind::Library(Library { content: LibraryContent::Found(root), .. }) if is_unnamed => {
                state.name = root.name.clone();
                Ok(Self::alone(state))
            }
            Kind::Library(Library { content: LibraryContent::Missing { reason }, .. }) => {
                Err(PyKeyError::new_err(reason.to_string()))
            }
            _ => Ok(Self::alone(state)),
        }
    }

    /// Applies changes, all or none. Each consists of a verb, the path of a state, and arguments.
    fn edit(&self, py: Python<'_>, changes: Vec<Change<'_>>) -> PyResult<()> {
        let edit = batch(changes)?;
        let mut content = self.lock(py);
        apply(&mut content.machine, edit, &PythonTypes).map_err(|error| refused(&error))?;
        Ok(())
    }

    /// One fact about the state at a path.
    fn fact<'py>(&self, py: Python<'py>, path: &str, key: &str) -> PyResult<Bound<'py, PyAny>> {
        if key == "file_system_path" {
            let (path, content) = (StatePath::parse(path), self.lock(py));
            let folder =
                content.saved.as_ref().and_then(|saved| saved.folder(&path, &content.libraries));
            return Ok(folder.map(|dir| dir.to_string_lossy().into_owned()).into_pyobject(py)?);
        }
        fact(py, &*self.at(py, path)?, key)
    }

    /// True if the state at a path has a child with this id.
    fn has_child(&self, py: Python<'_>, path: &str, id: &str) -> PyResult<bool> {
        let state = self.at(py, path)?;
        Ok(match &state.kind {
            Kind::Library(Library { content: LibraryContent::Found(root), .. }) => {
                root.id.as_str() == id
            }
            _ => state.container().is_some_and(|c| c.states.contains_key(&StateId::new(id))),
        })
    }

    /// True if the container at a path has a transition (or, for another `group`, a data flow) with this id.
    fn has_line(&self, py: Python<'_>, path: &str, group: &str, id: i64) -> PyResult<bool> {
        let state = self.at(py, path)?;
        let inside = state.container();
        Ok(inside.is_some_and(|inside| match group {
            "transitions" => inside.transitions.get(TransitionId(id)).is_some(),
            _ => inside.data_flows.get(DataFlowId(id)).is_some(),
        }))
    }

    /// The state at a path as a separate document, with all its children.
    fn taken(&self, py: Python<'_>, path: &str) -> PyResult<Self> {
        let (path, content) = (StatePath::parse(path), self.lock(py));
        let root = content.machine.state(&path).cloned().ok_or_else(|| missing(&path))?;
        let machine = Machine { header: Header::default(), root };
        Ok(Self::of(machine, None, Arc::clone(&content.libraries)))
    }

    /// True if the states of both documents are equal.
    fn is_like(&self, py: Python<'_>, other: &Self) -> bool {
        let own = self.lock(py).machine.root.clone();
        let other = other.lock(py).machine.root.clone();
        Arc::ptr_eq(&own, &other) || own == other
    }

    /// The id of the outermost state.
    fn root_id(&self, py: Python<'_>) -> String {
        self.lock(py).machine.root.id.to_string()
    }

    /// Replaces the root by that of another document.
    fn set_root(&self, py: Python<'_>, other: &Self) {
        let root = other.lock(py).machine.root.clone();
        self.lock(py).machine.root = root;
    }

    /// Header of the machine: creation time, the user's version, and the folder of its file.
    fn header(&self, py: Python<'_>) -> (String, Option<String>, Option<String>) {
        let content = self.lock(py);
        let Header { creation_time, version, .. } = &content.machine.header;
        let folder = content.saved.as_ref().map(|saved| saved.dir().to_string_lossy().into_owned());
        (creation_time.to_string(), version.as_ref().map(ToString::to_string), folder)
    }

    /// Sets the creation time and the version of the machine.
    fn set_header(&self, py: Python<'_>, creation_time: &str, version: Option<&str>) {
        let header = &mut self.lock(py).machine.header;
        header.creation_time = creation_time.into();
        header.version = version.map(SmolStr::new);
    }
}

/// Several changes as one edit.
pub(crate) fn batch(changes: Vec<Change<'_>>) -> PyResult<Edit> {
    let edit = |(verb, path, args): Change<'_>| {
        Request { verb: &verb, path: StatePath::parse(&path), args: &args }.edit()
    };
    changes.into_iter().map(edit).collect::<PyResult<_>>().map(Edit::Batch)
}

fn missing(path: &StatePath) -> PyErr {
    PyKeyError::new_err(format!("the state {path} no longer exists; read the machine again"))
}

/// A library state has its own value for every port from the start.
fn set_defaults(state: &mut State) {
    let (inputs, outputs) = (defaults(&state.inputs), defaults(&state.outputs));
    if let Kind::Library(library) = &mut state.kind {
        library.inputs = inputs;
        library.outputs = outputs;
    }
}

fn defaults(ports: &Ports) -> RuntimeValues {
    let value = |port: &rafcon_model::Port| match convert(&port.default, &port.data_type) {
        Conversion::Value(value) => value,
        _ => port.default.clone(),
    };
    ports.iter().map(|port| (port.id, RuntimeValue { value: value(port), used: true })).collect()
}

/// One fact about a state, as the Python package expects it.
fn fact<'py>(py: Python<'py>, state: &State, key: &str) -> PyResult<Bound<'py, PyAny>> {
    let inside = state.container();
    Ok(match key {
        "kind" => scripts::kind_name(state.kind.name()).into_pyobject(py)?.into_any(),
        "state_id" => state.id.as_str().into_pyobject(py)?.into_any(),
        "name" => state.name.as_str().into_pyobject(py)?.into_any(),
        "description" => state.description.as_deref().into_pyobject(py)?.into_any(),
        "script" => {
            let text = state.script().and_then(|script| script.text.as_deref());
            text.into_pyobject(py)?.into_any()
        }
        "outcomes" => describe::outcomes(py, state.outcomes.as_slice())?.into_any(),
        "inputs" => describe::ports(py, state.inputs.as_slice())?.into_any(),
        "outputs" => describe::ports(py, state.outputs.as_slice())?.into_any(),
        "scoped_variables" => {
            let ports = inside.map_or(&[][..], |inside| inside.scoped_variables.as_slice());
            describe::ports(py, ports)?.into_any()
        }
        "transitions" => describe::transitions(py, inside)?.into_any(),
        "data_flows" => describe::data_flows(py, inside)?.into_any(),
        "semantic_data" => describe::semantic_data(py, state)?,
        "layout" => describe::place_in_layout(state).into_pyobject(py)?.into_any(),
        "library" => describe::library(py, state)?.into_pyobject(py)?.into_any(),
        "children" => children(py, state)?.into_any(),
        "free_port_id" => state.free_port_id().0.into_pyobject(py)?.into_any(),
        "free_outcome_id" => state.free_outcome_id().0.into_pyobject(py)?.into_any(),
        other => return Err(PyKeyError::new_err(format!("the fact {other} does not exist"))),
    })
}

/// Ids of the child states; for a library state, that of its library's root.
fn children<'py>(py: Python<'py>, state: &State) -> PyResult<Bound<'py, PyList>> {
    let library = match &state.kind {
        Kind::Library(Library { content: LibraryContent::Found(root), .. }) => {
            Some(root.id.as_str())
        }
        _ => None,
    };
    let states = state.container().into_iter().flat_map(|inside| inside.states.keys());
    PyList::new(py, states.map(StateId::as_str).chain(library).collect::<Vec<_>>())
}
