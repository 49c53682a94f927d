//! Values of files as Python objects.

use crate::handle::Handle;
use crate::runtime::Runtime;
use crate::value_serializer::ValueSerializer;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PySet, PyString, PyTuple};
use rafcon_engine::{Literals, failed};
use rafcon_model::{Conversion, DataType, Value, convert, convert_runtime_value, json};
use rafcon_runner::ValueError;
use smol_str::SmolStr;

/// Converts values of files to Python objects. Python itself parses texts that only it can read.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PythonLiterals;

impl Literals<Handle> for PythonLiterals {
    fn literal(&mut self, value: &Value, data_type: &DataType) -> Result<Handle, SmolStr> {
        made(convert(value, data_type), value, data_type)
    }

    fn runtime_literal(&mut self, value: &Value, data_type: &DataType) -> Result<Handle, SmolStr> {
        made(convert_runtime_value(value, data_type), value, data_type)
    }

    fn error(&mut self, text: &str) -> Option<Handle> {
        let error = PyRuntimeError::new_err(text.to_owned());
        Some(Python::attach(|py| kept(error.into_value(py).into_bound(py).into_any())))
    }
}

fn made(conversion: Conversion, value: &Value, data_type: &DataType) -> Result<Handle, SmolStr> {
    let made = |py: Python<'_>, value: &Value| match object(py, value) {
        Ok(object) => Ok(kept(object)),
        Err(error) => Err(SmolStr::new(error.value(py).to_string())),
    };
    Python::attach(|py| match conversion {
        Conversion::Value(converted) => made(py, &converted),
        Conversion::Global(_) => made(py, value),
        Conversion::NeedsPython => by_python(py, value, data_type)
            .map(kept)
            .map_err(|error| SmolStr::new(error.value(py).to_string())),
        Conversion::Fails(reason) => made(py, failed(value, reason)?),
    })
}

fn kept(object: Bound<'_, PyAny>) -> Handle {
    Handle::kept(object, &ValueSerializer::before_the_run())
}

fn by_python<'py>(
    py: Python<'py>,
    value: &Value,
    data_type: &DataType,
) -> PyResult<Bound<'py, PyAny>> {
    let name = data_type.python_name();
    Runtime::get(py)?.convert.bind(py).call1((object(py, value)?, name.as_str()))
}

/// The Python object for a value from a client, encoded as in `docs/protocol.md`. Imports nothing: a class other than plain
/// data is an error.
pub(crate) fn from_json(json: &serde_json::Value) -> Result<Handle, ValueError> {
    Python::attach(|py| {
        let value = Runtime::get(py)
            .and_then(|runtime| runtime.decode_plain.bind(py).call1((json.to_string(),)));
        value.map(kept).map_err(|error| error.value(py).to_string().into())
    })
}

/// The Python object for a value.
pub(crate) fn object<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    let objects = |items: &[Value]| -> PyResult<Vec<Bound<'py, PyAny>>> {
        items.iter().map(|item| object(py, item)).collect()
    };
    Ok(match value {
        Value::None => py.None().into_bound(py),
        Value::Bool(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        Value::Int(number) => PyInt::new(py, *number).into_any(),
        Value::BigInt(digits) => py.get_type::<PyInt>().call1((digits.as_str(),))?,
        Value::Float(number) => PyFloat::new(py, *number).into_any(),
        Value::Str(text) => PyString::new(py, text).into_any(),
        Value::List(items) => PyList::new(py, objects(items)?)?.into_any(),
        Value::Tuple(items) => PyTuple::new(py, objects(items)?)?.into_any(),
        Value::Set(items) => PySet::new(py, objects(items)?)?.into_any(),
        Value::Dict(members) => dict(py, members)?,
        Value::Type(name) => Runtime::get(py)?.resolve_type.bind(py).call1((name.as_str(),))?,
        Value::Encoded(document) => {
            Runtime::get(py)?.decode.bind(py).call1((json::write_compact(document),))?
        }
    })
}

fn dict<'py>(py: Python<'py>, members: &[(Value, Value)]) -> PyResult<Bound<'py, PyAny>> {
    let dict = PyDict::new(py);
    for (key, value) in members {
        dict.set_item(object(py, key)?, object(py, value)?)?;
    }
    Ok(dict.into_any())
}
