//! Processes that scripts make by forking: they are copies that must never touch the run.

use crate::current;
use crate::handle::Handle;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::{Returned, ScriptResult};
use std::os::fd::RawFd;
use std::sync::atomic::{AtomicI32, Ordering};

/// The socket to the viewer.
static CONTROL: AtomicI32 = AtomicI32::new(-1);

/// Lets every forked copy know what it is, and that the socket `control` is not its own.
pub(crate) fn register(module: &Bound<'_, PyModule>, control: RawFd) -> PyResult<()> {
    CONTROL.store(control, Ordering::Relaxed);
    let options = PyDict::new(module.py());
    options.set_item("after_in_child", module.getattr("after_fork_in_child")?)?;
    module.py().import("os")?.getattr("register_at_fork")?.call((), Some(&options))?;
    Ok(())
}

/// This process is a copy from now on. It lets go of the socket: a viewer sees the end of the run by the socket's end.
#[pyfunction]
pub(crate) fn after_fork_in_child(py: Python<'_>) -> PyResult<()> {
    current::fork_happened();
    let control = CONTROL.swap(-1, Ordering::Relaxed);
    if control >= 0 {
        py.import("os")?.call_method1("close", (control,))?;
    }
    Ok(())
}

/// Ends a copy whose script has returned: the state machine lives elsewhere. As Python does it for a child of
/// `multiprocessing`, nothing is cleaned up that belongs to the parent.
pub(crate) fn end(py: Python<'_>, result: &ScriptResult<Handle>) -> ! {
    let flushed = ["stdout", "stderr"]
        .iter()
        .try_for_each(|name| py.import("sys")?.getattr(*name)?.call_method0("flush").map(drop));
    let failed = flushed.is_err() || result.returned == Returned::Raised;
    signal_hook::low_level::exit(i32::from(failed))
}
