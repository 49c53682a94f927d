//! Compiled scripts by their text. Each text is compiled once, regardless of the number of states with it; tracebacks of
//! each state name the state's own file.

use crate::runtime::Runtime;
use parking_lot::Mutex;
use pyo3::prelude::*;
use pyo3::types::{PyCode, PyDict, PyString, PyTuple};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Cache of compiled scripts.
#[derive(Debug, Default)]
pub(crate) struct Codes(Mutex<BTreeMap<Arc<str>, Py<PyCode>>>);

impl Codes {
    /// The code of a text, with the name of a file.
    pub(crate) fn get(&self, py: Python<'_>, text: &Arc<str>, file: &str) -> PyResult<Py<PyCode>> {
        if file.starts_with('<') {
            remember_source(py, text, file)?;
        }
        let known = self.0.lock().get(text).map(|code| code.clone_ref(py));
        if let Some(code) = known {
            return relocated(code.bind(py), file).map(Bound::unbind);
        }
        let code = compile(py, text, file)?;
        self.0.lock().insert(Arc::clone(text), code.clone_ref(py));
        Ok(code)
    }
}

fn compile(py: Python<'_>, text: &str, file: &str) -> PyResult<Py<PyCode>> {
    let options = PyDict::new(py);
    options.set_item("dont_inherit", true)?;
    let compile = Runtime::get(py)?.builtins.bind(py).get_item("compile")?;
    let code = compile.call((text, file, "exec"), Some(&options))?;
    Ok(code.cast_into::<PyCode>()?.unbind())
}

/// Lets tracebacks show the lines of a script without a file.
fn remember_source(py: Python<'_>, text: &str, file: &str) -> PyResult<()> {
    let lines = PyString::new(py, text).call_method1("splitlines", (true,))?;
    let cache = py.import("linecache")?.getattr("cache")?;
    cache.set_item(file, (text.len(), py.None(), lines, file))
}

/// The code, and the code of all functions in it, with the name of another file.
fn relocated<'py>(code: &Bound<'py, PyCode>, file: &str) -> PyResult<Bound<'py, PyCode>> {
    let py = code.py();
    let constants = code.getattr(pyo3::intern!(py, "co_consts"))?.cast_into::<PyTuple>()?;
    let moved = constants.iter().map(|constant| match constant.cast::<PyCode>() {
        Ok(inner) => relocated(inner, file).map(Bound::into_any),
        Err(_other) => Ok(constant.clone()),
    });
    let moved = PyTuple::new(py, moved.collect::<PyResult<Vec<_>>>()?)?;
    let changes = PyDict::new(py);
    changes.set_item(pyo3::intern!(py, "co_filename"), file)?;
    changes.set_item(pyo3::intern!(py, "co_consts"), moved)?;
    let code = code.call_method(pyo3::intern!(py, "replace"), (), Some(&changes))?;
    Ok(code.cast_into::<PyCode>()?)
}
