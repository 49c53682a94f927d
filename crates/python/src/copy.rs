//! Copies of values for scripts, which may change their inputs. Immutable values are not copied.

use crate::handle::{Handle, Kind};
use crate::runtime::Runtime;
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

/// A value that the caller may change. The error is the one that its own copying raised.
pub(crate) fn copied<'py>(py: Python<'py>, value: &Handle) -> PyResult<Bound<'py, PyAny>> {
    let object = value.bind(py);
    match value.kind() {
        None | Some(Kind::Bool | Kind::Int | Kind::Float | Kind::Str) => Ok(object),
        Some(kind) => copied_larger(object, kind),
    }
}

fn copied_larger<'py>(object: Bound<'py, PyAny>, kind: &Kind) -> PyResult<Bound<'py, PyAny>> {
    match kind {
        Kind::Other(class) if class.immutable => Ok(object),
        Kind::Tuple if is_plain_tuple(&object) => Ok(object),
        Kind::List => match plain_list(&object) {
            Some(list) => Ok(list),
            None => deep(&object),
        },
        Kind::Dict => match plain_dict(&object) {
            Some(dict) => dict,
            None => deep(&object),
        },
        _ if object.is_instance_of::<PyBaseException>() => Ok(object),
        _ => deep(&object),
    }
}

fn deep<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    Runtime::get(object.py())?.deep_copy.bind(object.py()).call1((object,))
}

/// True if an object can never change and holds no other objects.
fn is_plain(object: &Bound<'_, PyAny>) -> bool {
    object.is_none()
        || object.is_exact_instance_of::<PyInt>()
        || object.is_exact_instance_of::<PyFloat>()
        || object.is_exact_instance_of::<PyString>()
        || object.is_exact_instance_of::<PyBool>()
        || object.is_exact_instance_of::<PyBytes>()
}

fn is_plain_tuple(object: &Bound<'_, PyAny>) -> bool {
    object.cast::<PyTuple>().is_ok_and(|tuple| tuple.iter().all(|item| is_plain(&item)))
}

/// A copy of a list of plain values.
fn plain_list<'py>(object: &Bound<'py, PyAny>) -> Option<Bound<'py, PyAny>> {
    let list = object.cast::<PyList>().ok()?;
    list.iter().all(|item| is_plain(&item)).then(|| list.get_slice(0, list.len()).into_any())
}

/// A copy of a dictionary of plain values.
fn plain_dict<'py>(object: &Bound<'py, PyAny>) -> Option<PyResult<Bound<'py, PyAny>>> {
    let dict = object.cast::<PyDict>().ok()?;
    let plain = dict.iter().all(|(key, value)| is_plain(&key) && is_plain(&value));
    plain.then(|| dict.copy().map(Bound::into_any))
}
