//! Values that a state keeps from one of its runs to the next, written whenever a script has changed them.

use crate::current;
use crate::handle::Handle;
use crate::state_table::StateSlot;
use crate::value_serializer::ValueSerializer;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_protocol::LogLevel;
use rafcon_runner::Keep;

/// Keeps the persistent variables of the state at `seat`, if they have changed.
pub(crate) fn keep(py: Python<'_>, seat: &StateSlot, keeper: &ValueSerializer) {
    if current::is_forked() {
        return;
    }
    if let Err(error) = changed(py, seat, keeper) {
        let message = format!("the persistent variables cannot be kept: {error}");
        current::say(LogLevel::Error, message);
    }
}

fn changed(py: Python<'_>, seat: &StateSlot, keeper: &ValueSerializer) -> PyResult<()> {
    let variables = seat.object.bind(py).getattr(intern!(py, "persistent_variables"))?;
    let before = seat.persistent();
    if before.is_none() && variables.cast_exact::<PyDict>().is_ok_and(PyDictMethods::is_empty) {
        return Ok(());
    }
    let now = Handle::kept(variables, keeper);
    if !before.is_some_and(|before| is_same(&before, &now)) {
        current::driver()?.persistent(&seat.place, &now);
        seat.set_persistent(now);
    }
    Ok(())
}

fn is_same(before: &Handle, now: &Handle) -> bool {
    match (before.keep(), now.keep()) {
        (Keep::Plain(before), Keep::Plain(now)) => before == now,
        (Keep::Stored(before), Keep::Stored(now)) => before.stored() == now.stored(),
        _ => false,
    }
}
