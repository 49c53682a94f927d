//! Live data of a place: what a state holds and how it ended, for scripts that ask.

use crate::handle::Handle;
use crate::{current, thread};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::{Activity, Inspection, Node, PathId};
use rafcon_model::Port;
use rafcon_runner::Place;
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

/// `rafcon._native.status`
#[pyfunction]
pub(crate) fn status(py: Python<'_>, path: u32) -> PyResult<Bound<'_, PyDict>> {
    let place = place(py, path)?;
    let driver = current::driver()?;
    let held = thread::leave(py, || driver.inspect(place.path));
    let program = driver.program();
    let node = program.node(place.node);
    let status = PyDict::new(py);
    status.set_item("active", held.is_some())?;
    status.set_item("phase", held.as_ref().map_or("inactive", phase))?;
    status.set_item("final_outcome", final_outcome(node, &place))?;
    status.set_item("run_count", place.runs())?;
    data(py, &status, node, &place, held.as_ref())?;
    Ok(status)
}

fn phase(held: &Inspection<Handle>) -> &'static str {
    match held.activity {
        Activity::Script => "active",
        Activity::Inside | Activity::Held | Activity::Checking => "children",
        Activity::Waiting(_) => "waiting",
    }
}

fn final_outcome(node: &Node<Handle>, place: &Place) -> Option<(i64, String)> {
    let outcome = node.outcome(place.outcome()?)?;
    Some((outcome.id.0, outcome.name.to_string()))
}

/// The data of the script that runs or ran there, or of the active container.
fn data(
    py: Python<'_>,
    status: &Bound<'_, PyDict>,
    node: &Node<Handle>,
    place: &Arc<Place>,
    held: Option<&Inspection<Handle>>,
) -> PyResult<()> {
    let run = current::driver()?;
    let scripts = run.scripts();
    let scoped = PyDict::new(py);
    let (inputs, outputs) = match (scripts.seat(py, place)?.data(py), held) {
        (Some(data), _) => data,
        (None, Some(held)) => {
            for (name, value) in &held.scoped_variables {
                scoped.set_item(name.as_str(), value.bind(py))?;
            }
            (named(py, node.inputs(), &held.inputs)?, named(py, node.outputs(), &held.outputs)?)
        }
        (None, None) => (PyDict::new(py), PyDict::new(py)),
    };
    status.set_item("input_data", inputs)?;
    status.set_item("output_data", outputs)?;
    status.set_item("scoped_data", scoped)
}

fn named<'py>(py: Python<'py>, ports: &[Port], values: &[Handle]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (port, value) in ports.iter().zip(values) {
        dict.set_item(port.name.as_str(), value.bind(py))?;
    }
    Ok(dict)
}
