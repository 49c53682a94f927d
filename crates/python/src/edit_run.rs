//! Changes of the running machine by its own scripts. Knows the run; never the execution of a change.

use crate::build::{Change, Document, batch};
use crate::build_value::PythonTypes;
use crate::edit::refused;
use crate::status::place;
use crate::{current, thread};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use rafcon_model::edit::apply;
use rafcon_model::{Header, Machine, StatePath};
use std::sync::Arc;

/// `rafcon._native.revision`: differs after every change of the running machine.
#[pyfunction]
pub(crate) fn revision() -> PyResult<u64> {
    Ok(current::facts()?.scripts().seating.generation())
}

/// `rafcon._native.edit`: applies changes, all or none. The machine has them on return, and uses them from its next step
/// on. Parts in use cannot be removed: `MachineChangeRefused`.
#[pyfunction]
pub(crate) fn edit(py: Python<'_>, changes: Vec<Change<'_>>) -> PyResult<()> {
    let driver = current::driver()?;
    let mut what: Vec<String> = changes.iter().map(|(verb, path, _)| words(verb, path)).collect();
    // Report a repeated change once.
    what.dedup();
    let edit = batch(changes)?;
    let mut tried = driver.machine().as_ref().clone();
    apply(&mut tried, edit.clone(), &PythonTypes).map_err(|error| refused(&error))?;
    let answer = thread::leave(py, || driver.edit(&[edit], &what.join(", "), false));
    answer.map(drop).or_else(|refused| Err(in_use(py, refused.to_string())?))
}

/// `rafcon._native.has_kept_changes`: true if a run that is resumed after a crash applies all changes made until now.
#[pyfunction]
pub(crate) fn has_kept_changes() -> PyResult<bool> {
    Ok(current::driver()?.has_kept_changes())
}

/// The exception for a change that the running machine refuses.
fn in_use(py: Python<'_>, reason: String) -> PyResult<PyErr> {
    let class = py.import("rafcon.core.custom_exceptions")?.getattr("MachineChangeRefused")?;
    Ok(PyErr::from_value(class.call1((reason,))?))
}

/// A change in words, for the run's record.
fn words(verb: &str, path: &str) -> String {
    let (what, done) = verb.split_once('.').unwrap_or((verb, ""));
    let part = match what {
        "children" => "states",
        "flow" => "data flow",
        "runtime" => "runtime value",
        other => other,
    };
    format!("{part} {done} at {path}")
}

/// `rafcon._native.taken`: the state at a place as a separate document, with all its children.
#[pyfunction]
pub(crate) fn taken(py: Python<'_>, path: u32) -> PyResult<Document> {
    let place = place(py, path)?;
    let driver = current::driver()?;
    let state = driver.machine().state(&StatePath::parse(&place.text)).cloned();
    let gone = || PyKeyError::new_err(format!("the state {} no longer exists", place.text));
    let machine = Machine { header: Header::default(), root: state.ok_or_else(gone)? };
    Ok(Document::of(machine, None, Arc::default()))
}

/// `rafcon._native.settle`: assigns the object of an independently built state to a place of the run.
#[pyfunction]
pub(crate) fn settle(py: Python<'_>, path: u32, object: &Bound<'_, PyAny>) -> PyResult<()> {
    let place = place(py, path)?;
    current::driver()?.scripts().seat_with(object, &place)
}
