//! A run inside a program that has built its machine, hosted by the program's own process. Knows the start of the run; the
//! rest belongs to the runner.

use crate::build::Document;
use crate::build_files::LibraryRoots;
use crate::handle::Handle;
use crate::process::{PythonHost, adopt};
use crate::value_serializer::ValueSerializer;
use crate::{current, fork, runtime::Runtime};
use parking_lot::Mutex;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::Finish;
use rafcon_runner::{Clock, ServeError, reason, serve};
use rafcon_storage::journal::Retention;
use smol_str::SmolStr;
use std::os::fd::RawFd;
use std::path::Path;

/// End of the last run of this program.
static ENDING: Mutex<Option<Ending>> = Mutex::new(None);

/// The end of a run with its values.
struct Ending {
    outcome: (i64, SmolStr),
    outputs: Vec<(SmolStr, Handle)>,
    scoped_variables: Vec<(SmolStr, Handle)>,
}

/// Stores the end of a run for the program that started it.
pub(crate) fn ended(finish: &Finish<Handle>) {
    if !current::is_embedded() {
        return;
    }
    let ending = Ending {
        outcome: (finish.outcome.0, finish.outcome_name.clone()),
        outputs: finish.outputs.clone(),
        scoped_variables: finish.scoped_variables.clone(),
    };
    let earlier = ENDING.lock().replace(ending);
    drop(earlier);
}

/// `rafcon._native.ending`: final values of the root of the last run; None if no run has ended.
#[pyfunction]
pub(crate) fn ending(py: Python<'_>) -> PyResult<Option<Bound<'_, PyDict>>> {
    let Some(Ending { outcome: (id, name), outputs, scoped_variables }) = ENDING.lock().take()
    else {
        return Ok(None);
    };
    let ending = PyDict::new(py);
    ending.set_item("final_outcome", (id, name.as_str()))?;
    ending.set_item("output_data", named(py, &outputs)?)?;
    ending.set_item("scoped_data", named(py, &scoped_variables)?)?;
    Ok(Some(ending))
}

fn named<'py>(py: Python<'py>, values: &[(SmolStr, Handle)]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in values {
        dict.set_item(name.as_str(), value.bind(py))?;
    }
    Ok(dict)
}

/// `rafcon._native.run_id`: folder name of a new run; `salt` distinguishes runs that begin in one second.
#[pyfunction]
pub(crate) fn run_id(name: &str, salt: u16) -> String {
    rafcon_storage::journal::run_id(Clock::epoch_ms(), name, salt)
}

/// `rafcon._native.give_up_old_runs`: deletes runs in this folder beyond the usual number and size.
#[pyfunction]
pub(crate) fn give_up_old_runs(py: Python<'_>, folder: &str) -> PyResult<()> {
    let prune = || Retention::default().prune(Path::new(folder), Clock::epoch_ms()).map(drop);
    py.detach(prune).map_err(|error| PyOSError::new_err(reason(&error)))
}

/// `rafcon._native.host`: runs a machine that was built here to its end, for the viewer at the other end of the socket
/// `fd`. A resumed run has its own machine. `roots` are the folders of its libraries, `inputs` those of the root. Output,
/// signals and configuration remain those of the program.
#[pyfunction]
pub(crate) fn host(
    py: Python<'_>,
    fd: RawFd,
    document: Option<&Document>,
    roots: &LibraryRoots,
    inputs: Vec<(String, Bound<'_, PyAny>)>,
) -> PyResult<()> {
    let stream = adopt(py, fd)?;
    if current::embed() {
        fork::register(&py.import("rafcon._native")?)?;
        py.import("rafcon._fork")?.call_method0("install_in_program")?;
    }
    Runtime::get(py)?.heed_plugins(py)?;
    let built = document.map(|document| document.built(py, &roots.libraries));
    let kept = |value| Handle::kept(value, &ValueSerializer::before_the_run());
    let inputs = inputs.into_iter().map(|(name, value)| (name.into(), kept(value))).collect();
    match py.detach(|| serve(stream, PythonHost::embedded(built, inputs))) {
        Ok(()) | Err(ServeError::Load(_)) => Ok(()),
        Err(error) => Err(PyRuntimeError::new_err(error.to_string())),
    }
}
