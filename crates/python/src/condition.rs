//! Evaluation of breakpoint conditions with copies of a state's data.

use crate::copy::copied;
use crate::handle::Handle;
use crate::runtime::Runtime;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_engine::{Check, Node};
use rafcon_model::Port;
use smol_str::SmolStr;

/// Evaluates the condition. The error is a short text for people.
pub(crate) fn check(
    py: Python<'_>,
    check: &Check<Handle>,
    node: &Node<Handle>,
) -> Result<bool, SmolStr> {
    let answer = evaluate(py, check, node);
    answer.map_err(|error| why(py, &error))
}

fn evaluate(py: Python<'_>, check: &Check<Handle>, node: &Node<Handle>) -> PyResult<bool> {
    let inputs = of_ports(py, node.inputs(), &check.inputs)?;
    let scoped = by_name(py, check.scoped_variables.iter().map(|(name, value)| (&**name, value)))?;
    let (outputs, outcome) = match &check.left {
        Some((outputs, outcome)) => {
            let name = node.outcome(*outcome).map(|outcome| outcome.name.as_str());
            (Some(of_ports(py, node.outputs(), outputs)?), name)
        }
        None => (None, None),
    };
    let text = check.condition.as_str();
    let answer =
        Runtime::get(py)?.check.bind(py).call1((text, inputs, outputs, scoped, outcome))?;
    answer.is_truthy()
}

fn of_ports<'py>(
    py: Python<'py>,
    ports: &[Port],
    values: &[Handle],
) -> PyResult<Bound<'py, PyDict>> {
    by_name(py, ports.iter().map(|port| port.name.as_str()).zip(values))
}

fn by_name<'py, 'v>(
    py: Python<'py>,
    values: impl Iterator<Item = (&'v str, &'v Handle)>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in values {
        let value = copied(py, value).unwrap_or_else(|_uncopiable| value.bind(py));
        dict.set_item(name, value)?;
    }
    Ok(dict)
}

fn why(py: Python<'_>, error: &PyErr) -> SmolStr {
    let words = Runtime::get(py).and_then(|runtime| runtime.why.call1(py, (error.value(py),)));
    let words = words.and_then(|words| words.extract::<String>(py));
    words.map_or_else(|_silent| SmolStr::new_static("it fails"), SmolStr::from)
}
