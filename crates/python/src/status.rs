//! Live data of a place for scripts: the values of a state, and its end.

use crate::handle::Handle;
use crate::{current, thread};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::{Activity, Inspection, Node, PathId, Status};
use rafcon_model::Port;
use rafcon_runner::Place;
use smol_str::SmolStr;
use std::sync::Arc;

/// The place with this number.
pub(crate) fn place(py: Python<'_>, path: u32) -> PyResult<Arc<Place>> {
    let driver = current::facts()?;
    let place = if current::is_forked() {
        driver.places().get(PathId(path)).cloned()
    } else {
        thread::leave(py, || driver.place(PathId(path)))
    };
    place.ok_or_else(|| PyKeyError::new_err(format!("no state has the number {path}")))
}

/// `rafcon._native.status`: activity and data of a state, as a dictionary.
#[pyfunction]
pub(crate) fn status(py: Python<'_>, path: u32) -> PyResult<Bound<'_, PyDict>> {
    let place = place(py, path)?;
    let driver = current::driver()?;
    let held = thread::leave(py, || driver.inspect(place.path));
    let program = driver.program();
    let node = program.node(place.node);
    let phase = match &held {
        Some(held) => phase(held, &place),
        None if is_last_of_held(py, &place)? => "waiting",
        None => "inactive",
    };
    let status = PyDict::new(py);
    status.set_item("active", held.is_some())?;
    status.set_item("phase", phase)?;
    status.set_item("final_outcome", final_outcome(node, &place))?;
    status.set_item("run_count", place.runs())?;
    status.set_item("entered_ns", place.entered_ns())?;
    data(py, &status, node, &place, held.as_ref())?;
    Ok(status)
}

/// `rafcon._native.run_status`: activity of the whole run.
#[pyfunction]
pub(crate) fn run_status(py: Python<'_>) -> PyResult<&'static str> {
    let driver = current::driver()?;
    let status = thread::leave(py, || driver.status());
    Ok(match status.unwrap_or(Status::Finished) {
        Status::Idle | Status::Running => "running",
        Status::Paused => "paused",
        Status::Stepping => "stepping",
        Status::Stopping => "stopping",
        Status::Finished => "finished",
    })
}

fn phase(held: &Inspection<Handle>, place: &Place) -> &'static str {
    match held.activity {
        Activity::Script => "active",
        Activity::Held if place.left_last().is_none() => "waiting",
        Activity::Inside | Activity::Held | Activity::Checking => "children",
        Activity::Waiting(_) => "waiting",
    }
}

/// True if the state was the last to end in a container that is now held before the next state.
fn is_last_of_held(py: Python<'_>, at: &Place) -> PyResult<bool> {
    let Some(parent) = at.parent else { return Ok(false) };
    let around = place(py, parent.0)?;
    if around.left_last() != Some(at.path) || !around.is_active() {
        return Ok(false);
    }
    let driver = current::driver()?;
    let held = thread::leave(py, || driver.inspect(around.path));
    Ok(held.is_some_and(|held| matches!(held.activity, Activity::Held)))
}

fn final_outcome(node: &Node<Handle>, place: &Place) -> Option<(i64, String)> {
    let outcome = node.outcome(place.outcome()?)?;
    Some((outcome.id.0, outcome.name.to_string()))
}

/// The data of the script at the place, running or ended, or of the container or library state.
fn data(
    py: Python<'_>,
    status: &Bound<'_, PyDict>,
    node: &Node<Handle>,
    place: &Arc<Place>,
    held: Option<&Inspection<Handle>>,
) -> PyResult<()> {
    let run = current::driver()?;
    let scoped = PyDict::new(py);
    let (inputs, outputs) = match (run.scripts().seat(py, place)?.data(py), held) {
        (Some(data), _) => data,
        (None, Some(held)) => {
            for (name, value) in &held.scoped_variables {
                scoped.set_item(name.as_str(), value.bind(py))?;
            }
            (ports(py, node.inputs(), &held.inputs)?, ports(py, node.outputs(), &held.outputs)?)
        }
        (None, None) => match thread::leave(py, || run.last(place.path)) {
            Some(last) => {
                scoped.update(named(py, last.scoped_variables())?.as_mapping())?;
                let outputs = named(py, last.outputs())?;
                if let Some(error) = last.error() {
                    outputs.set_item("error", error.bind(py))?;
                }
                (named(py, last.inputs())?, outputs)
            }
            None => (PyDict::new(py), PyDict::new(py)),
        },
    };
    status.set_item("input_data", inputs)?;
    status.set_item("output_data", outputs)?;
    status.set_item("scoped_data", scoped)
}

fn ports<'py>(py: Python<'py>, ports: &[Port], values: &[Handle]) -> PyResult<Bound<'py, PyDict>> {
    named(py, ports.iter().map(|port| &port.name).zip(values))
}

fn named<'py, 'v>(
    py: Python<'py>,
    values: impl Iterator<Item = (&'v SmolStr, &'v Handle)>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in values {
        dict.set_item(name.as_str(), value.bind(py))?;
    }
    Ok(dict)
}
