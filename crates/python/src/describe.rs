//! The parts of a state as plain Python data, for the objects that scripts see.

use crate::handle::Handle;
use crate::literals::object;
use crate::status::place;
use crate::{current, thread};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use rafcon_engine::{NodeId, PathId, Program};
use rafcon_model::edit::LayoutElement;
use rafcon_model::{
    Container, Conversion, Library, Outcome, Port, RuntimeValues, State, StateId, Value, convert,
};
use rafcon_runner::Place;

/// `rafcon._native.describe`: facts about a state, as a dictionary.
#[pyfunction]
pub(crate) fn describe(py: Python<'_>, path: u32) -> PyResult<Bound<'_, PyDict>> {
    let place = place(py, path)?;
    let driver = current::facts()?;
    let program = driver.program();
    let node = program.node(place.node);
    let state = node.state();
    let facts = PyDict::new(py);
    facts.set_item("kind", crate::scripts::kind_name(state.kind.name()))?;
    facts.set_item("state_id", state.id.as_str())?;
    facts.set_item("name", state.name.as_str())?;
    facts.set_item("description", state.description.as_deref())?;
    facts.set_item("path", &*place.text)?;
    facts.set_item("path_by_name", path_by_name(py, &place)?)?;
    facts.set_item("parent", place.parent.map_or(-1, |parent| i64::from(parent.0)))?;
    facts.set_item("children", children(py, &place)?)?;
    facts.set_item("outcomes", outcomes(py, node.outcomes())?)?;
    facts.set_item("inputs", ports(py, node.inputs())?)?;
    facts.set_item("outputs", ports(py, node.outputs())?)?;
    facts.set_item("semantic_data", semantic_data(py, state)?)?;
    facts.set_item("script", state.script().and_then(|script| script.text.as_deref()))?;
    let scripts = driver.scripts();
    let folder = scripts.files.folder(&place.text);
    facts
        .set_item("file_system_path", folder.map(|folder| folder.to_string_lossy().into_owned()))?;
    facts.set_item("free_port_id", state.free_port_id().0)?;
    facts.set_item("free_outcome_id", state.free_outcome_id().0)?;
    insides(&facts, state.container())?;
    facts.set_item("library", library(py, state)?)?;
    Ok(facts)
}

/// `rafcon._native.layout_of`: left, top, width and height; `None` without a size.
#[pyfunction]
pub(crate) fn layout_of(py: Python<'_>, path: u32) -> PyResult<Option<(f64, f64, f64, f64)>> {
    let place = place(py, path)?;
    Ok(place_in_layout(current::facts()?.program().node(place.node).state()))
}

/// Left, top, width and height of a state, if its layout has a size.
pub(crate) fn place_in_layout(state: &State) -> Option<(f64, f64, f64, f64)> {
    let layout = state.layout.json();
    let (width, height) = LayoutElement::State.size(&layout)?;
    let (x, y) = LayoutElement::State.position(&layout).unwrap_or_default();
    Some((x, y, width, height))
}

fn path_by_name(py: Python<'_>, at: &Place) -> PyResult<String> {
    let program = current::facts()?.program();
    let mut names = vec![program.node(at.node).name().to_string()];
    let mut next = at.parent;
    while let Some(parent) = next {
        let around = place(py, parent.0)?;
        names.push(program.node(around.node).name().to_string());
        next = around.parent;
    }
    names.reverse();
    Ok(names.join("/"))
}

/// Ids and places of the child states; empty in a forked process, which cannot request places.
fn children<'py>(py: Python<'py>, place: &Place) -> PyResult<Bound<'py, PyDict>> {
    let driver = current::facts()?;
    let dict = PyDict::new(py);
    if current::is_forked() {
        return Ok(dict);
    }
    let paths = thread::leave(py, || driver.children(place.path));
    for (index, path) in paths.into_iter().enumerate() {
        if let Some(id) = child_id(&driver.program(), place.node, index) {
            dict.set_item(id, path.0)?;
        }
    }
    Ok(dict)
}

fn child_id(program: &Program<Handle>, node: NodeId, index: usize) -> Option<String> {
    let child = program.node(node).child(index)?;
    Some(program.node(child).id().to_string())
}

/// Names of the outcomes, by id.
pub(crate) fn outcomes<'py>(py: Python<'py>, outcomes: &[Outcome]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for outcome in outcomes {
        dict.set_item(outcome.id.0, outcome.name.as_str())?;
    }
    Ok(dict)
}

/// Name, name of the type and default, by id.
pub(crate) fn ports<'py>(py: Python<'py>, ports: &[Port]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for port in ports {
        let type_name = port.data_type.python_name();
        let default = match convert(&port.default, &port.data_type) {
            Conversion::Value(value) => literal(py, &value),
            _ => literal(py, &port.default),
        };
        dict.set_item(port.id.0, (port.name.as_str(), type_name.as_str(), default))?;
    }
    Ok(dict)
}

/// A default as in the file; `None` if Python cannot make it.
fn literal<'py>(py: Python<'py>, value: &Value) -> Bound<'py, PyAny> {
    object(py, value).unwrap_or_else(|_unreadable| py.None().into_bound(py))
}

/// The user's notes as nested dictionaries.
pub(crate) fn semantic_data<'py>(py: Python<'py>, state: &State) -> PyResult<Bound<'py, PyAny>> {
    match &state.semantic_data {
        Some(data) => {
            let text = PyString::new(py, &rafcon_model::json::write_compact(data));
            py.import("json")?.call_method1("loads", (text,))
        }
        None => Ok(PyDict::new(py).into_any()),
    }
}

fn insides(facts: &Bound<'_, PyDict>, container: Option<&Container>) -> PyResult<()> {
    let py = facts.py();
    facts.set_item("transitions", transitions(py, container)?)?;
    facts.set_item("data_flows", data_flows(py, container)?)?;
    let scoped = container.map_or(&[][..], |container| container.scoped_variables.as_slice());
    facts.set_item("scoped_variables", ports(py, scoped)?)
}

/// The ends of each transition, by id.
pub(crate) fn transitions<'py>(
    py: Python<'py>,
    container: Option<&Container>,
) -> PyResult<Bound<'py, PyDict>> {
    let transitions = PyDict::new(py);
    for line in container.iter().flat_map(|container| container.transitions.iter()) {
        let ends = (
            line.from_state.as_ref().map(StateId::as_str),
            line.from_outcome.map(|id| id.0),
            line.to_state.as_ref().map(StateId::as_str),
            line.to_outcome.map(|id| id.0),
        );
        transitions.set_item(line.id.0, ends)?;
    }
    Ok(transitions)
}

/// The ends of each data flow, by id.
pub(crate) fn data_flows<'py>(
    py: Python<'py>,
    container: Option<&Container>,
) -> PyResult<Bound<'py, PyDict>> {
    let flows = PyDict::new(py);
    for line in container.iter().flat_map(|container| container.data_flows.iter()) {
        let ends =
            (line.from_state.as_str(), line.from_port.0, line.to_state.as_str(), line.to_port.0);
        flows.set_item(line.id.0, ends)?;
    }
    Ok(flows)
}

/// Facts of a library state about its library.
pub(crate) fn library<'py>(py: Python<'py>, state: &State) -> PyResult<Option<Bound<'py, PyDict>>> {
    let rafcon_model::Kind::Library(library) = &state.kind else { return Ok(None) };
    let facts = PyDict::new(py);
    let Library { path, name, version, inputs, outputs, content: _ } = library;
    facts.set_item("path", path.as_str())?;
    facts.set_item("name", name.as_str())?;
    facts.set_item("version", version.as_deref())?;
    for (key, values) in [("input", inputs), ("output", outputs)] {
        let (set, used) = runtime_values(py, values)?;
        facts.set_item(format!("{key}_runtime_values"), set)?;
        facts.set_item(format!("use_{key}_runtime_values"), used)?;
    }
    Ok(Some(facts))
}

type Dicts<'py> = (Bound<'py, PyDict>, Bound<'py, PyDict>);

fn runtime_values<'py>(py: Python<'py>, values: &RuntimeValues) -> PyResult<Dicts<'py>> {
    let (set, used) = (PyDict::new(py), PyDict::new(py));
    for (port, value) in values {
        set.set_item(port.0, literal(py, &value.value))?;
        used.set_item(port.0, value.used)?;
    }
    Ok((set, used))
}

/// The number of the root's place.
pub(crate) const ROOT: PathId = PathId(0);
