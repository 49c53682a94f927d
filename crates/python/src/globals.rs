//! The global variables, which Python stores, for the engine and the journal.

use crate::handle::Handle;
use crate::runtime::Runtime;
use crate::value_serializer::ValueSerializer;
use crate::{current, thread};
use pyo3::prelude::*;
use rafcon_engine::Globals;
use rafcon_protocol::LogLevel;
use rafcon_runner::ValueError;

/// The global variables as the engine reads them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PythonGlobals;

impl Globals<Handle> for PythonGlobals {
    fn get(&self, name: &str) -> Option<Handle> {
        let found = thread::while_engine_waits(|| Python::attach(|py| resolve(py, name)));
        found.unwrap_or_else(|error| {
            let message = format!("the global variable \"{name}\" cannot be read: {error}");
            current::say(LogLevel::Error, message);
            None
        })
    }
}

/// The engine is locked during this call, so the value is kept as it was when the variable was set.
fn resolve(py: Python<'_>, name: &str) -> PyResult<Option<Handle>> {
    type Found<'py> = (bool, Bound<'py, PyAny>, Option<Bound<'py, Kept>>);
    let answer = Runtime::get(py)?.resolve_global.bind(py).call1((name,))?;
    let (found, value, kept): Found<'_> = answer.extract()?;
    Ok(found.then(|| match kept {
        Some(kept) => kept.get().value.like(value),
        None => Handle::new(value),
    }))
}

/// Restores a variable from its kept value.
pub(crate) fn restore(py: Python<'_>, name: &str, value: &Handle) -> Result<(), ValueError> {
    let put = || Runtime::get(py)?.restore_global.bind(py).call1((name, value.bind(py)));
    put().map(drop).map_err(|error| error.value(py).to_string().into())
}

/// Starts keeping the changes of variables.
pub(crate) fn keep(py: Python<'_>, keeper: &ValueSerializer) -> PyResult<()> {
    if keeper.keeps() {
        let journal = Journal { keeper: keeper.clone() };
        Runtime::get(py)?.keep_globals.call1(py, (journal,))?;
    }
    Ok(())
}

/// Starts or stops keeping the changes of variables, for one of several runs in this process.
pub(crate) fn keep_embedded(py: Python<'_>, keeper: &ValueSerializer) -> PyResult<()> {
    let journal = keeper.keeps().then(|| Journal { keeper: keeper.clone() });
    Runtime::get(py)?.keep_globals.call1(py, (journal,))?;
    Ok(())
}

/// A kept value of a variable.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
struct Kept {
    /// The value without declarations.
    value: Handle,
    /// The value with all declarations of the variable.
    variable: Handle,
}

/// The journal for the global variables.
#[pyclass(frozen, module = "rafcon._native")]
#[derive(Debug)]
struct Journal {
    keeper: ValueSerializer,
}

#[pymethods]
impl Journal {
    /// Keeps a value. `carrier` is the variable if it holds more than a copied value.
    fn keep(&self, value: &Bound<'_, PyAny>, carrier: Option<&Bound<'_, PyAny>>) -> Kept {
        let plain = Handle::kept(value.clone(), &self.keeper);
        let variable = carrier.map_or_else(
            || plain.clone(),
            |carrier| Handle::carried(value.clone(), carrier, &self.keeper),
        );
        Kept { value: plain, variable }
    }

    /// True if this thread can write to the run now.
    #[expect(clippy::unused_self, reason = "Python asks the journal")]
    fn is_open(&self) -> bool {
        current::driver().is_ok()
    }

    /// Records the new value of a variable, or its removal.
    #[expect(clippy::unused_self, reason = "Python asks the journal")]
    fn write(&self, py: Python<'_>, name: &str, kept: Option<&Bound<'_, Kept>>) -> PyResult<()> {
        let driver = current::driver()?;
        let value = kept.map(|kept| kept.get().variable.clone());
        thread::outside(py, || driver.global(name, value.as_ref()));
        Ok(())
    }
}
