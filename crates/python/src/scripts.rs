//! The host of Python scripts: the port of the runner, filled by an interpreter.

use crate::codes::Codes;
use crate::handle::Handle;
use crate::literals::{self, PythonLiterals};
use crate::run::run;
use crate::runtime::Runtime;
use crate::script::{How, Script};
use crate::seat::{Seat, Seats};
use crate::signals::Signals;
use crate::{current, graveyard, process, thread};
use parking_lot::RwLock;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rafcon_engine::{Globals, Job, Literals, NodeId, Program, Returned, ScriptResult};
use rafcon_model::{KindName, Machine};
use rafcon_protocol::LogLevel;
use rafcon_runner::{Opening, Place, Scripts, StateFiles};
use rafcon_storage::Config;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Python as the host of one machine's scripts.
#[derive(Debug)]
pub(crate) struct PythonScripts {
    pub(crate) machine: Machine,
    program: Arc<Program<Handle>>,
    pub(crate) files: StateFiles,
    pub(crate) config: Config,
    scripts: RwLock<BTreeMap<NodeId, Arc<Script>>>,
    codes: Arc<Codes>,
    seats: Seats,
    globals: PythonGlobals,
}

impl PythonScripts {
    pub(crate) fn new(opening: Opening<Handle>) -> Self {
        let Opening { machine, program, files, config, .. } = opening;
        Self {
            machine,
            program,
            files,
            config,
            scripts: RwLock::default(),
            codes: Arc::default(),
            seats: Seats::default(),
            globals: PythonGlobals,
        }
    }

    /// The kinds of the states that run scripts, each once.
    pub(crate) fn script_kinds(&self) -> BTreeSet<&'static str> {
        let nodes = self.program.nodes().filter(|(_, node)| node.is_script());
        nodes.map(|(_, node)| kind_name(node.state().kind.name())).collect()
    }

    /// What Python keeps for a place, made at the first call.
    pub(crate) fn seat(&self, py: Python<'_>, place: &Arc<Place>) -> PyResult<Arc<Seat>> {
        match self.seats.get(place.path) {
            Some(seat) => Ok(seat),
            None => self.make_seat(py, place),
        }
    }

    fn make_seat(&self, py: Python<'_>, place: &Arc<Place>) -> PyResult<Arc<Seat>> {
        let kind = kind_name(self.program.node(place.node).state().kind.name());
        let signals = Py::new(py, Signals::new(Arc::clone(place)))?;
        let object = Runtime::get(py)?.new_state.call1(py, (place.path.0, kind, signals))?;
        let is_script = self.program.node(place.node).is_script();
        let script = is_script.then(|| self.script(py, place));
        Ok(self.seats.insert(Seat::new(object, script, Arc::clone(place))))
    }

    fn script(&self, py: Python<'_>, place: &Place) -> Arc<Script> {
        let known = self.scripts.read().get(&place.node).cloned();
        known.unwrap_or_else(|| {
            let how = How {
                file: self.files.script(&place.text),
                recompile: self.config.recompile_scripts,
                codes: Arc::clone(&self.codes),
            };
            let script = Arc::new(Script::new(py, &self.program, place.node, how));
            Arc::clone(self.scripts.write().entry(place.node).or_insert(script))
        })
    }
}

impl Scripts for PythonScripts {
    type Value = Handle;

    fn run(&self, job: Job<Handle>, place: &Arc<Place>) -> ScriptResult<Handle> {
        Python::attach(|py| {
            let result = thread::at(job.path, || match self.seat(py, place) {
                Ok(seat) => run(py, &seat, &job),
                Err(error) => failed(py, error),
            });
            if current::is_forked() {
                crate::fork::end(py, &result);
            }
            result
        })
    }

    fn failure(&self, reason: &str) -> ScriptResult<Handle> {
        let failed = |py: Python<'_>| failed(py, PyRuntimeError::new_err(reason.to_owned()));
        thread::while_engine_waits(|| Python::attach(failed))
    }

    fn inhabit(&self, life: &mut (dyn FnMut() + Send)) {
        thread::inhabit(&mut || {
            let adopted = Python::attach(|py| Runtime::get(py)?.adopt_thread.call0(py));
            if let Err(error) = adopted {
                let message = format!("threads that scripts start here end with the run: {error}");
                current::say(LogLevel::Warning, message);
            }
            life();
        });
    }

    fn park(&self, wait: &mut (dyn FnMut() + Send)) {
        thread::park(wait);
    }

    fn settle(&self) {
        if thread::is_inside() {
            Python::attach(graveyard::clear);
        } else {
            graveyard::leave_to_others();
        }
    }

    fn globals(&self) -> &dyn Globals<Handle> {
        &self.globals
    }

    fn finished(&self) {
        let told = Python::attach(|py| -> PyResult<()> {
            let runtime = Runtime::get(py)?;
            runtime.hooks.call_method0(py, "finished")?;
            runtime.flush_all.call0(py)?;
            Ok(())
        });
        if let Err(error) = told {
            current::say(
                LogLevel::Error,
                format!("a plugin failed at the end of the run: {error}"),
            );
        }
    }

    fn released(&self) {
        if let Err(error) = Python::attach(process::default_signals) {
            current::say(LogLevel::Warning, format!("signals are ignored from now on: {error}"));
        }
    }

    fn encode(&self, value: &Handle) -> Value {
        Python::attach(|py| {
            let encoded =
                Runtime::get(py).and_then(|runtime| runtime.encode.call1(py, (value.bind(py),)));
            to_json(py, encoded)
        })
    }

    fn value(&self, json: &Value) -> Result<Handle, String> {
        literals::from_json(json)
    }

    fn with_literals(&self, make: &mut dyn FnMut(&mut dyn Literals<Handle>)) {
        make(&mut PythonLiterals);
    }

    fn encode_globals(&self) -> Map<String, Value> {
        let encoded = Python::attach(|py| {
            let encoded = Runtime::get(py).and_then(|runtime| runtime.encode_globals.call0(py));
            to_json(py, encoded)
        });
        match encoded {
            Value::Object(members) => members,
            _ => Map::new(),
        }
    }
}

/// The answer for a script that could not begin.
pub(crate) fn failed(py: Python<'_>, error: PyErr) -> ScriptResult<Handle> {
    let error = Handle::new(error.into_value(py).into_bound(py).into_any());
    ScriptResult { returned: Returned::Raised, outputs: Vec::new(), error: Some(error) }
}

fn to_json(py: Python<'_>, encoded: PyResult<Py<PyAny>>) -> Value {
    let text = encoded.and_then(|encoded| {
        let text = Runtime::get(py)?.write_json.call1(py, (encoded,))?;
        text.extract::<String>(py)
    });
    let text = text.unwrap_or_else(|error| {
        current::say(LogLevel::Error, format!("a value cannot be shown: {error}"));
        String::new()
    });
    serde_json::from_str(&text).unwrap_or_default()
}

pub(crate) fn kind_name(kind: KindName) -> &'static str {
    match kind {
        KindName::Execution => "execution",
        KindName::Decider => "decider",
        KindName::Hierarchy => "hierarchy",
        KindName::Barrier => "barrier",
        KindName::Preemptive => "preemptive",
        KindName::Library => "library",
    }
}

/// The global variables, which live in Python.
#[derive(Debug, Clone, Copy)]
struct PythonGlobals;

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

fn resolve(py: Python<'_>, name: &str) -> PyResult<Option<Handle>> {
    let answer = Runtime::get(py)?.resolve_global.bind(py).call1((name,))?;
    let (found, value): (bool, Bound<'_, PyAny>) = answer.extract()?;
    Ok(found.then(|| Handle::new(value)))
}
