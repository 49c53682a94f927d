//! Fresh modules and function calls, through the fastest functions of CPython's stable interface.
#![expect(
    unsafe_code,
    reason = "PyO3 reaches these functions only by a detour that costs a third of a script's call"
)]

use pyo3::ffi;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyCode, PyDict, PyModule};
use std::io::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of the next script module; makes names unique.
static COUNT: AtomicU64 = AtomicU64::new(1);

/// Runs `code` as the body of a fresh module and returns the module's dictionary.
pub(crate) fn run_body<'py>(
    code: &Bound<'py, PyCode>,
    builtins: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = code.py();
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let globals = PyModule::new(py, name(number, &mut [0; NAME_BYTES]))?.dict();
    globals.set_item(intern!(py, "__builtins__"), builtins)?;
    // SAFETY: all three are live objects of the right type and this thread is attached; the result is an owned reference
    // or null with an exception set, which is what `from_owned_ptr_or_err` takes.
    let result = unsafe {
        let result = ffi::PyEval_EvalCode(code.as_ptr(), globals.as_ptr(), globals.as_ptr());
        Bound::from_owned_ptr_or_err(py, result)
    };
    result.map(|_none| globals)
}

/// Buffer size for `script` and any number.
const NAME_BYTES: usize = 26;

/// `script` and the number.
fn name(number: u64, room: &mut [u8; NAME_BYTES]) -> &str {
    let mut rest = &mut room[..];
    let written = write!(rest, "script{number}").map(|()| NAME_BYTES - rest.len());
    std::str::from_utf8(&room[..written.unwrap_or(0)]).unwrap_or("script")
}

/// `function(a, b, c, d)`.
pub(crate) fn call<'py>(
    function: &Bound<'py, PyAny>,
    [a, b, c, d]: [&Bound<'py, PyAny>; 4],
) -> PyResult<Bound<'py, PyAny>> {
    let end = std::ptr::null_mut::<ffi::PyObject>();
    // SAFETY: the list of live objects ends with null, as the function asks; this thread is attached, and the result is an
    // owned reference or null with an exception set.
    unsafe {
        let result = ffi::PyObject_CallFunctionObjArgs(
            function.as_ptr(),
            a.as_ptr(),
            b.as_ptr(),
            c.as_ptr(),
            d.as_ptr(),
            end,
        );
        Bound::from_owned_ptr_or_err(function.py(), result)
    }
}
