//! `rafcon._native.command` and `rafcon._native.past`: commands of scripts for the run, and access to its past events.

use crate::{current, thread};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rafcon_protocol::{Answer, Breakpoint, Command, Envelope, Event, Scope, Unattended, When};
use rafcon_runner::PastEvent;
use std::sync::atomic::{AtomicU64, Ordering};

/// Executes a command; an error with the reason if it is refused. `path` and `number` (of an event, or the id of a
/// breakpoint) are used by the commands that need them.
#[pyfunction]
#[pyo3(signature = (name, path=None, number=0))]
pub(crate) fn command(
    py: Python<'_>,
    name: &str,
    path: Option<String>,
    number: u64,
) -> PyResult<()> {
    static COUNT: AtomicU64 = AtomicU64::new(1);
    let id = format!("script {}", COUNT.fetch_add(1, Ordering::Relaxed));
    let command = named(name, path.unwrap_or_default(), number)?;
    let envelope = Envelope::new(id, author(), command);
    let driver = current::driver()?;
    match thread::leave(py, || driver.obey(&envelope)) {
        Answer::Applied => Ok(()),
        Answer::Refused { reason } | Answer::Unknown { reason } => {
            Err(PyRuntimeError::new_err(reason))
        }
        Answer::Expired => Err(PyRuntimeError::new_err("the command arrived too late")),
    }
}

/// The state whose script sends the command.
fn author() -> String {
    let path = thread::current_path();
    let place = path.and_then(|path| current::driver().ok()?.places().get(path).cloned());
    place.map_or_else(
        || "a thread of a script".to_owned(),
        |place| format!("script of {}", place.text),
    )
}

fn named(name: &str, path: String, number: u64) -> PyResult<Command> {
    let data = Vec::new();
    Ok(match name {
        "pause" => Command::Pause,
        "resume" => Command::Resume { branch: None },
        "stop" => Command::Stop,
        "step_mode" => Command::StepMode,
        "step_into" => Command::StepInto { branch: None },
        "step_over" => Command::StepOver { branch: None },
        "step_out" => Command::StepOut { branch: None },
        "step_back" => Command::StepBack { branch: None },
        "run_to" => Command::RunTo { path },
        "run_selected" => Command::RunSelected { path, data },
        "run_only_selected" => Command::RunOnlySelected { path, data },
        "start_from_history" => Command::StartFromHistory { sequence: number },
        "set_breakpoint" => Command::SetBreakpoint { breakpoint: breakpoint(number, path) },
        "remove_breakpoint" => Command::RemoveBreakpoint { id: number },
        other => return Err(PyValueError::new_err(format!("the command {other} does not exist"))),
    })
}

/// A breakpoint that holds the whole run before a state, as those of programs do.
fn breakpoint(id: u64, path: String) -> Breakpoint {
    Breakpoint {
        id,
        path,
        when: When::Before,
        condition: None,
        hit_count: 0,
        scope: Scope::Run,
        unattended: Unattended::Hold,
        lost_link_ms: None,
        enabled: true,
    }
}

/// Number, time (s since 1970), path, name and id of the outcome (none for an entry), values as JSON, flag for a step back.
type PolledEvent = (u64, f64, String, Option<(i64, String)>, String, bool);

/// The entries and exits of states, oldest first.
#[pyfunction]
pub(crate) fn past(py: Python<'_>) -> PyResult<Vec<PolledEvent>> {
    let driver = current::driver()?;
    let past = thread::leave(py, || driver.past());
    Ok(past.into_iter().filter_map(told).collect())
}

#[expect(clippy::cast_precision_loss, reason = "Python's times are floats")]
fn told(past: PastEvent) -> Option<PolledEvent> {
    let time = past.epoch_ms as f64 / 1000.0;
    let json = |values| serde_json::Value::Object(values).to_string();
    match past.event {
        Event::Entered { path, inputs, undoes } => {
            let inputs = json(inputs.unwrap_or_default());
            Some((past.sequence, time, path, None, inputs, undoes.is_some()))
        }
        Event::Left { path, outcome, outputs, undoes, .. } => {
            let (outputs, outcome) =
                (json(outputs.unwrap_or_default()), (outcome.id, outcome.name));
            Some((past.sequence, time, path, Some(outcome), outputs, undoes.is_some()))
        }
        _ => None,
    }
}
