//! Processes that scripts fork: copies that must never access the run.

use crate::handle::Handle;
use crate::{current, process_output};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::{Returned, ScriptResult};

/// Registers a handler that marks forked processes.
pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let options = PyDict::new(module.py());
    options.set_item("after_in_child", module.getattr("after_fork_in_child")?)?;
    module.py().import("os")?.getattr("register_at_fork")?.call((), Some(&options))?;
    Ok(())
}

/// Marks this process as a fork and closes the sockets and the lock of the run: viewers detect the end of the run when
/// these close. A fork of a fork has none to close.
#[pyfunction]
pub(crate) fn after_fork_in_child(py: Python<'_>) -> PyResult<()> {
    if current::is_forked() {
        return Ok(());
    }
    current::fork_happened();
    let close = py.import("os")?.getattr("close")?;
    let open = rafcon_runner::descriptors().into_iter().chain(process_output::forget());
    open.into_iter().try_for_each(|open| close.call1((open,)).map(drop))
}

/// Ends a fork whose script has returned, after its threads: the state machine runs in the parent. As in Python's
/// `multiprocessing`, objects of the parent are not cleaned up.
pub(crate) fn end(py: Python<'_>, result: &ScriptResult<Handle>) -> ! {
    let has_failed = result.returned == Returned::Raised;
    let error = result.error.as_ref().filter(|_| has_failed).map(|error| error.bind(py));
    let code = py
        .import("rafcon._fork")
        .and_then(|module| module.call_method1("finish", (error,))?.extract::<i32>());
    signal_hook::low_level::exit(code.unwrap_or(1))
}
