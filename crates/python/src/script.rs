//! The script of one state. It is compiled once; its module's body runs at each entry.

use crate::module;
use crate::runtime::Runtime;
use parking_lot::Mutex;
use pyo3::exceptions::{PyAttributeError, PyRuntimeError, PySyntaxError};
use pyo3::prelude::*;
use pyo3::types::{PyCode, PyDict, PyString};
use rafcon_engine::{Node, NodeId, Program};
use rafcon_model::{CONFLICT_REMEDY, DataType, Outcome, Port, State, conflict_line};
use smol_str::SmolStr;
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

use crate::class;
use crate::codes::Codes;
use crate::handle::Handle;

/// Everything needed to run the script of one node, prepared once.
#[derive(Debug)]
pub(crate) struct Script {
    /// The file that tracebacks name.
    pub(crate) file: String,
    text: Option<Arc<str>>,
    codes: Arc<Codes>,
    /// Names of the input ports.
    pub(crate) inputs: Box<[Py<PyString>]>,
    /// Names of the output ports.
    pub(crate) outputs: Box<[Py<PyString>]>,
    /// True if one of the output ports is named `error`.
    pub(crate) has_error_output: bool,
    /// The outcomes of the state.
    pub(crate) outcomes: Box<[Outcome]>,
    /// The state for which it was prepared.
    state: Arc<State>,
    code: OnceLock<Py<PyCode>>,
    /// The built-in names for the script.
    builtins: OnceLock<Py<PyAny>>,
    /// The module's dictionary, if its body runs only once.
    kept: Option<OnceLock<Py<PyDict>>>,
    /// Ports whose value could not be copied, as already reported.
    reported: Mutex<BTreeSet<SmolStr>>,
}

/// Options for compiling and running a script.
#[derive(Debug)]
pub(crate) struct CompileContext {
    /// The file that tracebacks name.
    pub(crate) file: String,
    /// True if the module's body runs at each entry of the state.
    pub(crate) recompile: bool,
    /// Cache of compiled scripts.
    pub(crate) codes: Arc<Codes>,
}

impl Script {
    /// Declares the types of the ports. The script is compiled later.
    pub(crate) fn new(
        py: Python<'_>,
        program: &Program<Handle>,
        node: NodeId,
        how: CompileContext,
    ) -> Self {
        let node: &Node<Handle> = program.node(node);
        declare_types(py, node.inputs());
        declare_types(py, node.outputs());
        Self {
            file: how.file,
            codes: how.codes,
            text: node.state().script().and_then(|script| script.text.clone()),
            inputs: names(py, node.inputs()),
            outputs: names(py, node.outputs()),
            has_error_output: node.outputs().iter().any(|port| port.name == "error"),
            outcomes: node.outcomes().into(),
            state: Arc::clone(node.state()),
            code: OnceLock::new(),
            builtins: OnceLock::new(),
            kept: (!how.recompile).then(OnceLock::new),
            reported: Mutex::default(),
        }
    }

    /// True if the script and its ports match this node of the current machine.
    pub(crate) fn is_of(&self, node: &Node<Handle>) -> bool {
        Arc::ptr_eq(&self.state, node.state())
    }

    /// The function `execute` of the module. The module's body runs first, at each call or only once, depending on the
    /// configuration.
    pub(crate) fn execute<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.globals(py)?.get_item(pyo3::intern!(py, "execute"))?.ok_or_else(|| {
            PyAttributeError::new_err(
                "the script has no function execute(self, inputs, outputs, gvm)",
            )
        })
    }

    /// The function `backward_execute`, if the script has one.
    pub(crate) fn backward_execute<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.globals(py)?.get_item(pyo3::intern!(py, "backward_execute"))
    }

    fn globals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        match &self.kept {
            None => self.run_body(py),
            Some(kept) => {
                let kept = once(kept, || self.run_body(py).map(Bound::unbind))?;
                Ok(kept.bind(py).clone())
            }
        }
    }

    /// True if the value of this port was not yet reported as impossible to copy.
    pub(crate) fn is_news(&self, port: &str) -> bool {
        self.reported.lock().insert(port.into())
    }

    fn run_body<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let code = once(&self.code, || self.compile(py))?;
        let text = self.text.as_deref().unwrap_or_default();
        let builtins = once(&self.builtins, || Runtime::get(py)?.builtins_for(py, text))?;
        module::run_body(code.bind(py), builtins.bind(py))
    }

    fn compile(&self, py: Python<'_>) -> PyResult<Py<PyCode>> {
        let text = self.text.as_ref().ok_or_else(|| {
            PyRuntimeError::new_err("the state has no script: add a script.py to its folder")
        })?;
        let compiled = self.codes.get(py, text, &self.file);
        compiled.map_err(|error| conflict_error(text, &self.file).unwrap_or(error))
    }
}

/// The error about conflict markers in a script that does not compile.
fn conflict_error(text: &str, file: &str) -> Option<PyErr> {
    let line = conflict_line(text)?;
    let index = usize::try_from(line).ok()?.checked_sub(1)?;
    let shown = text.lines().nth(index).unwrap_or_default().to_owned();
    let what = format!("the script has conflict markers of a merge: {CONFLICT_REMEDY}");
    Some(PySyntaxError::new_err((what, (file.to_owned(), line, 1, shown))))
}

/// Value of `cell`, created at the first call. Two threads may create it concurrently; one value is kept.
fn once<T>(cell: &OnceLock<T>, make: impl FnOnce() -> PyResult<T>) -> PyResult<&T> {
    if let Some(made) = cell.get() {
        return Ok(made);
    }
    let made = make()?;
    Ok(cell.get_or_init(|| made))
}

fn names(py: Python<'_>, ports: &[Port]) -> Box<[Py<PyString>]> {
    ports.iter().map(|port| PyString::intern(py, &port.name).unbind()).collect()
}

/// Resolves the named types of ports, so that type checks need no Python.
fn declare_types(py: Python<'_>, ports: &[Port]) {
    for port in ports {
        if let DataType::Named(name) = &port.data_type {
            class::declare(name, || real_name(py, name).ok().flatten());
        }
    }
}

/// Real name of a type; `None` for an abstract class, which accepts objects of other classes too.
fn real_name(py: Python<'_>, name: &str) -> PyResult<Option<SmolStr>> {
    let found = Runtime::get(py)?.resolve_type.bind(py).call1((name,))?;
    let abstract_class = py.import("abc")?.getattr("ABCMeta")?;
    let is_abstract = found.is_instance(&abstract_class)?;
    Ok((!is_abstract).then(|| class::dotted(&found)))
}
