//! `rafcon._native.ask`: questions of scripts to people.

use crate::status::place;
use crate::{current, thread};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rafcon_protocol::{Closing, Form};
use rafcon_runner::Asked;
use serde_json::Value;

/// Asks a question and waits for its end. Returns the kind of end, and the answer as JSON if one was given. `form` and
/// `default` are JSON as in the protocol. The times are the timeouts for an answer and for contact with the ground, in ms.
#[pyfunction]
#[pyo3(signature = (message, form, times_ms, default))]
pub(crate) fn ask(
    py: Python<'_>,
    message: String,
    form: &str,
    times_ms: (Option<u64>, Option<u64>),
    default: Option<&str>,
) -> PyResult<(&'static str, Option<String>)> {
    let path = thread::current_path().ok_or_else(|| {
        PyRuntimeError::new_err("only the thread of a state's script can ask a question")
    })?;
    let place = place(py, path.0)?;
    let form: Form = serde_json::from_str(form).map_err(wrong)?;
    let default = default.map(serde_json::from_str::<Value>).transpose().map_err(wrong)?;
    let (timeout_ms, lost_link_ms) = times_ms;
    let asked = Asked { message, form, timeout_ms, lost_link_ms, default };
    let closed = current::driver()?
        .ask(&place, asked)
        .map_err(|why| PyValueError::new_err(why.to_string()))?;
    let how = match closed.how {
        Closing::Answered => "answered",
        Closing::TimedOut => "timed_out",
        Closing::Withdrawn => "withdrawn",
    };
    Ok((how, closed.answer.map(|answer| answer.to_string())))
}

#[expect(clippy::needless_pass_by_value, reason = "the shape that `map_err` wants")]
fn wrong(error: serde_json::Error) -> PyErr {
    PyValueError::new_err(format!("the question cannot be asked: {error}"))
}
