//! The run of this process, for functions called by Python. A process hosts one run at a time; only a program that embeds
//! the engine hosts several in sequence.

use crate::scripts::PythonScripts;
use crate::thread;
use parking_lot::RwLock;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rafcon_protocol::{LogLevel, Stream};
use rafcon_runner::Driver;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A run with its scripts.
pub(crate) type Run = Arc<Driver<PythonScripts>>;

static DRIVER: RwLock<Option<Run>> = RwLock::new(None);
static FORKED: AtomicBool = AtomicBool::new(false);
static EMBEDDED: AtomicBool = AtomicBool::new(false);

/// Sets the run once it is ready.
pub(crate) fn set(driver: &Run) {
    let earlier = DRIVER.write().replace(Arc::clone(driver));
    drop(earlier);
}

/// Marks the process as one that embeds runs. True at the first call.
pub(crate) fn embed() -> bool {
    !EMBEDDED.swap(true, Ordering::Relaxed)
}

/// True if the process belongs to a program that embeds the run.
pub(crate) fn is_embedded() -> bool {
    EMBEDDED.load(Ordering::Relaxed)
}

/// True if this process was started for one run and has not received it yet.
pub(crate) fn is_expected() -> bool {
    !is_forked() && !is_embedded() && DRIVER.read().is_none()
}

/// The run; an error with the reason if it cannot be reached from here.
pub(crate) fn driver() -> PyResult<Run> {
    if is_forked() {
        let why =
            "this is a forked process; only the process that runs the state machine can talk to it";
        return Err(PyRuntimeError::new_err(why));
    }
    if thread::engine_waits() {
        let why = "a global variable is being read for a port's default; the state machine cannot answer meanwhile";
        return Err(PyRuntimeError::new_err(why));
    }
    let run = DRIVER.read().clone();
    run.ok_or_else(|| PyRuntimeError::new_err("no state machine runs in this process"))
}

/// Error of a request for live data in a forked process.
pub(crate) fn forked() -> PyErr {
    let why =
        "this is a forked process; only the process that runs the state machine can talk to it";
    PyRuntimeError::new_err(why)
}

/// The run, for facts that never change; available to forked processes too.
pub(crate) fn facts() -> PyResult<Run> {
    // In a forked process another thread may have held the lock when the fork happened.
    let copy = || DRIVER.try_read().and_then(|run| run.clone());
    if is_forked() { copy().ok_or_else(forked) } else { driver() }
}

/// Logs a message of RAFCON itself for the state whose script runs on this thread.
pub(crate) fn say(level: LogLevel, message: String) {
    if let (false, Some(driver)) = (is_forked(), DRIVER.read().clone()) {
        driver.log(thread::current_path(), level, Stream::Engine, message);
    }
}

/// True if a script forked this process from the one that hosts the run.
pub(crate) fn is_forked() -> bool {
    FORKED.load(Ordering::Relaxed)
}

/// Marks this process as a fork.
pub(crate) fn fork_happened() {
    FORKED.store(true, Ordering::Relaxed);
}
