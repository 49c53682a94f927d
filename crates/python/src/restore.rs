//! Restoration of kept values. A value that was not kept is an error that names it: no placeholder reaches a script.

use crate::handle::Handle;
use crate::runtime::Runtime;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use rafcon_runner::ValueError;
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{Kept, Stored};
use serde_json::{Map, Value};
use std::fs;
use std::path::Path;

/// The value kept in the event itself.
pub(crate) fn plain(py: Python<'_>, kept: &Kept) -> Result<Handle, ValueError> {
    let object = match kept {
        Kept::None => return Ok(Handle::default()),
        Kept::Bool(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        Kept::Int(number) => PyInt::new(py, *number).into_any(),
        Kept::Float(number) => PyFloat::new(py, *number).into_any(),
        Kept::Text(text) => PyString::new(py, text).into_any(),
        Kept::Absent => return Err("there is no value: its script left the port out".into()),
        Kept::Value(number) => return Err(format!("value {} stands elsewhere", number.0).into()),
    };
    Ok(Handle::new(object))
}

/// A value kept by number; `values` is the folder of large values.
pub(crate) fn restore(
    py: Python<'_>,
    stored: &Stored,
    values: &Path,
) -> Result<Handle, ValueError> {
    let made = match &stored.content {
        Content::View => from_view(py, &stored.view),
        Content::Pickle(pickle) => unpickled(py, pickle),
        Content::File { hash, size } => {
            large(&values.join(hash), hash, *size).and_then(|pickle| unpickled(py, &pickle))
        }
        Content::Nothing(why) => Err(PyValueError::new_err(why.clone())),
    };
    match made.or_else(|error| stand_in(py, &stored.view).ok_or(error)) {
        Ok(object) => Ok(Handle::restored(object, stored.clone())),
        Err(error) => Err(format!(
            "the value {} of type {} cannot be made again: {}",
            shown(&stored.view),
            stored.type_name,
            error.value(py)
        )
        .into()),
    }
}

/// The object of a complete view.
pub(crate) fn from_view<'py>(py: Python<'py>, view: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match view {
        Value::Null => py.None().into_bound(py),
        Value::Bool(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        Value::Number(number) => match number.as_i64() {
            Some(int) => PyInt::new(py, int).into_any(),
            None => PyFloat::new(py, number.as_f64().unwrap_or_default()).into_any(),
        },
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Array(items) => PyList::new(py, objects(py, items)?)?.into_any(),
        Value::Object(members) => tagged(py, members)?,
    })
}

fn tagged<'py>(py: Python<'py>, members: &Map<String, Value>) -> PyResult<Bound<'py, PyAny>> {
    let only = members.iter().next().filter(|_| members.len() == 1);
    Ok(match only.map(|(tag, inner)| (tag.as_str(), inner)) {
        Some(("__tuple__", Value::Array(items))) => {
            PyTuple::new(py, objects(py, items)?)?.into_any()
        }
        Some(("__dict__", Value::Array(pairs))) => from_pairs(py, pairs)?.into_any(),
        Some(("__int__", Value::String(digits))) => py.get_type::<PyInt>().call1((digits,))?,
        Some(("__float__", Value::String(text))) => py.get_type::<PyFloat>().call1((text,))?,
        _ => dict(py, members)?.into_any(),
    })
}

fn from_pairs<'py>(py: Python<'py>, pairs: &[Value]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for pair in pairs {
        let Some([key, value]) = pair.as_array().map(Vec::as_slice) else {
            return Err(PyValueError::new_err("a pair of `__dict__` is no key and value"));
        };
        dict.set_item(from_view(py, key)?, from_view(py, value)?)?;
    }
    Ok(dict)
}

fn dict<'py>(py: Python<'py>, members: &Map<String, Value>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (key, value) in members {
        dict.set_item(key, from_view(py, value)?)?;
    }
    Ok(dict)
}

fn objects<'py>(py: Python<'py>, items: &[Value]) -> PyResult<Vec<Bound<'py, PyAny>>> {
    items.iter().map(|item| from_view(py, item)).collect()
}

fn unpickled<'py>(py: Python<'py>, pickle: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    Runtime::get(py)?.unpickle.bind(py).call1((PyBytes::new(py, pickle),))
}

fn large(file: &Path, hash: &str, size: u64) -> PyResult<Vec<u8>> {
    let pickle = fs::read(file).map_err(|error| {
        PyValueError::new_err(format!("{} cannot be read: {error}", file.display()))
    })?;
    if pickle.len() as u64 == size && blake3::hash(&pickle).to_hex().as_str() == hash {
        return Ok(pickle);
    }
    Err(PyValueError::new_err(format!("{} is damaged", file.display())))
}

/// Replacement for an exception that cannot be restored, so that handlers still receive its class and message.
fn stand_in<'py>(py: Python<'py>, view: &Value) -> Option<Bound<'py, PyAny>> {
    let (class, text) = (view.get("__exc__")?.as_str()?, view.get("msg")?.as_str()?);
    let error = PyRuntimeError::new_err(format!("{class}: {text}"));
    Some(error.into_value(py).into_bound(py).into_any())
}

fn shown(view: &Value) -> String {
    match view.get("__repr__").and_then(Value::as_str) {
        Some(text) => text.to_owned(),
        None => view.to_string(),
    }
}
