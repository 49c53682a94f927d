//! Entry point of the extension: creates the module, or raises an error that names why this interpreter is not supported.
#![expect(unsafe_code, reason = "an interpreter looks for a C function of this name")]

use crate::{
    build_files, build_run, config, describe, edit_run, fork, functions, planning, polled_events,
    process, questions, status,
};
use pyo3::ffi;
use pyo3::prelude::*;
use std::ffi::CStr;

/// The module's content. Its own entry function is reached through [`PyInit__native`].
#[pymodule]
mod _rafcon {
    #[pymodule_export]
    use super::build_files::{load_document, save_document};
    #[pymodule_export]
    use super::build_run::{ending, give_up_old_runs, host, run_id};
    #[pymodule_export]
    use super::config::read_config;
    #[pymodule_export]
    use super::describe::{describe, layout_of};
    #[pymodule_export]
    use super::edit_run::{edit, has_kept_changes, revision, settle, taken};
    #[pymodule_export]
    use super::fork::after_fork_in_child;
    #[pymodule_export]
    use super::functions::{current_path, emit, last_left, machine, state_object};
    #[pymodule_export]
    use super::planning::{Planning, save_plan};
    #[pymodule_export]
    use super::polled_events::{command, past};
    #[pymodule_export]
    use super::process::{main, serve_package};
    #[pymodule_export]
    use super::questions::ask;
    #[pymodule_export]
    use super::status::{run_status, status};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::process::fill(module)
    }
}

const FREE_THREADED: &CStr =
    c"rafcon needs a Python with the global interpreter lock; this is a free-threaded build. \
    Choose another interpreter by --python or RAFCON_PYTHON.";

/// Called by the interpreter when it loads the extension. A free-threaded build has another object layout, so it is refused
/// before any object is accessed.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn PyInit__native() -> *mut ffi::PyObject {
    // SAFETY: the interpreter calls this function with itself attached. Its version is a constant text, and its exception
    // classes exist.
    unsafe {
        let version = CStr::from_ptr(ffi::Py_GetVersion());
        if version.to_bytes().windows(14).any(|part| part == b"free-threading") {
            ffi::PyErr_SetString(ffi::PyExc_ImportError, FREE_THREADED.as_ptr());
            return std::ptr::null_mut();
        }
        _rafcon::__pyo3_init()
    }
}
