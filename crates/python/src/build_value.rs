//! Conversion of values and types from Python to the model, as in files. Knows the encoding of files; never the caller.

use crate::class::dotted;
use crate::runtime::Runtime;
use pyo3::exceptions::{PyRecursionError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PySet, PyString, PyTuple, PyType};
use rafcon_model::{Answer, DataType, Json, Types, Value};
use smol_str::SmolStr;
use std::sync::Arc;

/// Maximum nesting depth of values, as in files.
const DEPTH_MAX: usize = 190;

/// The type with a dotted name.
pub(crate) fn model_type(name: &str) -> DataType {
    DataType::from_file(name)
}

/// The value in the form of files; `TypeError` for an object that files cannot contain.
pub(crate) fn model_value(object: &Bound<'_, PyAny>) -> PyResult<Value> {
    value(object, DEPTH_MAX)
}

fn value(object: &Bound<'_, PyAny>, depth: usize) -> PyResult<Value> {
    if depth == 0 {
        return Err(PyRecursionError::new_err(format!(
            "the value is nested deeper than {DEPTH_MAX} levels, which no file keeps; make it flatter"
        )));
    }
    if object.is_none() {
        Ok(Value::None)
    } else if let Ok(truth) = object.cast::<PyBool>() {
        Ok(Value::Bool(truth.is_true()))
    } else if object.is_instance_of::<PyInt>() {
        int(object)
    } else if let Ok(number) = object.cast::<PyFloat>() {
        Ok(Value::Float(number.value()))
    } else if let Ok(text) = object.cast::<PyString>() {
        Ok(Value::str(&text.extract::<String>()?))
    } else {
        larger(object, depth - 1)
    }
}

fn int(object: &Bound<'_, PyAny>) -> PyResult<Value> {
    match object.extract() {
        Ok(number) => Ok(Value::Int(number)),
        Err(_too_large) => Ok(Value::BigInt(SmolStr::new(object.str()?.to_string_lossy()))),
    }
}

fn larger(object: &Bound<'_, PyAny>, depth: usize) -> PyResult<Value> {
    if object.is_exact_instance_of::<PyList>() {
        items(object, depth).map(Value::List)
    } else if object.is_exact_instance_of::<PyTuple>() {
        items(object, depth).map(Value::Tuple)
    } else if object.is_exact_instance_of::<PySet>() {
        items(object, depth).map(Value::Set)
    } else if let Ok(dict) = object.cast::<PyDict>() {
        dictionary(dict, depth)
    } else if object.is_instance_of::<PyType>() {
        Ok(Value::Type(dotted(object)))
    } else {
        encoded(object, depth)
    }
}

fn items(object: &Bound<'_, PyAny>, depth: usize) -> PyResult<Arc<[Value]>> {
    object.try_iter()?.map(|item| value(&item?, depth)).collect()
}

fn dictionary(dict: &Bound<'_, PyDict>, depth: usize) -> PyResult<Value> {
    let (mut members, mut texts) = (Vec::new(), 0);
    for (key, member) in dict.iter() {
        let key = value(&key, depth)?;
        texts += match &key {
            Value::Str(_) => 1,
            Value::Int(_) => 0,
            _ => return Err(unkept("a dictionary whose keys are neither all `str` nor all `int`")),
        };
        members.push((key, value(&member, depth)?));
    }
    if texts != 0 && texts != members.len() {
        return Err(unkept("a dictionary whose keys are neither all `str` nor all `int`"));
    }
    Ok(Value::Dict(members.into()))
}

/// An array of numpy, or an object whose class converts it to a dictionary.
fn encoded(object: &Bound<'_, PyAny>, depth: usize) -> PyResult<Value> {
    let class = dotted(object.get_type().as_any());
    let members = if class == "numpy.ndarray" {
        let list = value(&object.call_method0("tolist")?, depth)?;
        vec![(SmolStr::new_static("items"), list.to_json())]
    } else if object.hasattr("to_dict")? && object.get_type().hasattr("from_dict")? {
        match value(&object.call_method0("to_dict")?, depth)?.to_json() {
            Json::Object(members) => members,
            _ => return Err(unkept(&format!("an object of {class}, whose `to_dict` gives none"))),
        }
    } else {
        return Err(unkept(&format!("an object of {class}")));
    };
    let name = (SmolStr::new_static("__jsonqualname__"), Json::Str(class));
    let members = std::iter::once(name).chain(members).collect();
    Ok(Value::Encoded(Arc::new(Json::Object(members))))
}

fn unkept(what: &str) -> PyErr {
    PyTypeError::new_err(format!(
        "the file of a state machine cannot keep {what}; leave the default None and set the value in a script"
    ))
}

/// Types for the model, with Python's help for unknown ones.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PythonTypes;

impl Types for PythonTypes {
    fn is_subclass(&self, sub: &DataType, base: &DataType) -> Answer {
        let answer = Python::attach(|py| {
            let resolve = |of: &DataType| {
                let name = of.python_name();
                Runtime::get(py)?.resolve_type.bind(py).call1((name.as_str(),))
            };
            resolve(sub)?.cast_into::<PyType>()?.is_subclass(&resolve(base)?)
        });
        match answer {
            Ok(true) => Answer::Yes,
            Ok(false) => Answer::No,
            Err(_unknown_here) => Answer::Unknown,
        }
    }
}
