//! Conversion of a script's return value to an outcome's id or name, by Python's own equality.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyInt, PyString};
use rafcon_engine::Returned;
use rafcon_model::Outcome;
use smol_str::{SmolStr, format_smolstr};

/// Remedy for `async def execute`.
const WITHOUT_ASYNC: &str = "write `def execute`, and run coroutines with `asyncio.run(…)` inside";
/// Maximum length of a value's own text in messages.
const SHOWN_MAX: usize = 200;

/// Reads a return value. The error is the one that its comparison raised, or that it is not hashable.
pub(crate) fn returned(value: &Bound<'_, PyAny>, outcomes: &[Outcome]) -> PyResult<Returned> {
    if value.is_none() {
        return Ok(Returned::Other("None".into()));
    }
    if value.is_exact_instance_of::<PyInt>() {
        return Ok(value.extract().map_or_else(|_too_large| other(value), Returned::Id));
    }
    if let Ok(name) = value.cast_exact::<PyString>() {
        let name = SmolStr::new(name.to_string_lossy());
        let is_short = name.chars().nth(SHOWN_MAX).is_none();
        let is_outcome = is_short || outcomes.iter().any(|outcome| outcome.name == name);
        return Ok(if is_outcome { Returned::Name(name) } else { other(value) });
    }
    if let Ok(truth) = value.cast_exact::<PyBool>() {
        return Ok(Returned::Id(i64::from(truth.is_true())));
    }
    by_equality(value, outcomes)
}

/// Finds the outcome like a lookup in a dictionary of ids, then of names: hash and equality must both match.
fn by_equality(value: &Bound<'_, PyAny>, outcomes: &[Outcome]) -> PyResult<Returned> {
    let (py, hash) = (value.py(), value.hash()?);
    for outcome in outcomes {
        let id = PyInt::new(py, outcome.id.0);
        if id.hash()? == hash && value.eq(&id)? {
            return Ok(Returned::Id(outcome.id.0));
        }
    }
    for outcome in outcomes {
        let name = PyString::new(py, &outcome.name);
        if name.hash()? == hash && value.eq(&name)? {
            return Ok(Returned::Name(outcome.name.clone()));
        }
    }
    Ok(other(value))
}

fn other(value: &Bound<'_, PyAny>) -> Returned {
    let text = value.repr().map(|text| text.to_string_lossy().into_owned());
    let text = text.unwrap_or_else(|_failing| "something that cannot be shown".to_owned());
    let shown: String = text.chars().take(SHOWN_MAX).collect();
    if !is_coroutine(value) {
        return Returned::Other(shown.into());
    }
    // A closed coroutine does not warn that it was never awaited.
    drop(value.call_method0("close"));
    Returned::Other(format_smolstr!("{shown} (`execute` is `async`; {WITHOUT_ASYNC})"))
}

fn is_coroutine(value: &Bound<'_, PyAny>) -> bool {
    value.get_type().name().is_ok_and(|name| name == "coroutine")
}
