//! The small functions of `rafcon._native`.

use crate::describe::ROOT;
use crate::early::{self, Line};
use crate::status::place;
use crate::{current, thread};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::PathId;
use rafcon_protocol::{LogLevel, Stream};

/// Logs a line, or keeps it until the run exists. `level` is a level of Python's `logging`.
#[pyfunction]
pub(crate) fn emit(path: i64, stream: &str, level: i64, message: String) -> PyResult<()> {
    let stream = match stream {
        "stdout" => Stream::Stdout,
        "stderr" => Stream::Stderr,
        "logger" => Stream::Logger,
        other => return Err(PyValueError::new_err(format!("no stream is named {other}"))),
    };
    let path = u32::try_from(path).ok().map(PathId);
    note(path, Line { level: log_level(level), stream, message })
}

/// Logs a line, or keeps it for the beginning of the run.
pub(crate) fn note(path: Option<PathId>, line: Line) -> PyResult<()> {
    let line = if current::is_expected() { early::keep(line) } else { Some(line) };
    if let Some(Line { level, stream, message }) = line {
        current::driver()?.log(path, level, stream, message);
    }
    Ok(())
}

fn log_level(level: i64) -> LogLevel {
    match level {
        40.. => LogLevel::Error,
        30..40 => LogLevel::Warning,
        20..30 => LogLevel::Info,
        10..20 => LogLevel::Debug,
        ..10 => LogLevel::Verbose,
    }
}

/// Number of the place whose script runs on this thread; -1 without one.
#[pyfunction]
pub(crate) fn current_path() -> i64 {
    thread::current_path().map_or(-1, |path| i64::from(path.0))
}

/// Number of the place that ran before this one in its container; -1 if it was the first.
#[pyfunction]
pub(crate) fn last_left(py: Python<'_>, path: u32) -> PyResult<i64> {
    Ok(place(py, path)?.previous().map_or(-1, |previous| i64::from(previous.0)))
}

/// The unique object of the state at a place.
#[pyfunction]
pub(crate) fn state_object(py: Python<'_>, path: u32) -> PyResult<Py<PyAny>> {
    let place = place(py, path)?;
    let run = current::facts()?;
    let seat = run.scripts().seat(py, &place)?;
    Ok(seat.object.clone_ref(py))
}

/// Facts about the whole machine.
#[pyfunction]
pub(crate) fn machine(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let run = current::facts()?;
    let scripts = run.scripts();
    let header = &scripts.machine.header;
    let facts = PyDict::new(py);
    let folder = scripts.files.machine().to_string_lossy();
    facts.set_item("file_system_path", (!folder.is_empty()).then_some(folder))?;
    facts.set_item("version", header.version.as_deref())?;
    facts.set_item("creation_time", header.creation_time.as_str())?;
    facts.set_item("root", ROOT.0)?;
    Ok(facts)
}
