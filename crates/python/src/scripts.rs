//! The host of Python scripts: implements the runner's port with an interpreter.

use crate::globals::{self, PythonGlobals};
use crate::handle::Handle;
use crate::literals::{self, PythonLiterals};
use crate::run::run;
use crate::runtime::Runtime;
use crate::state_objects::StateObjects;
use crate::state_table::StateSlot;
use crate::value_serializer::ValueSerializer;
use crate::{
    build_run, condition, current, graveyard, persistent, process, process_output, restore, thread,
};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rafcon_engine::{Check, Finish, Globals, Job, Literals, Program, Returned, ScriptResult};
use rafcon_model::{KindName, Machine};
use rafcon_protocol::{Keeping, LogLevel};
use rafcon_runner::{Keep, Opening, Place, Scripts, StateFiles, ValueError};
use rafcon_storage::Config;
use rafcon_storage::journal::{Kept, Stored};
use serde_json::{Map, Value};
use smol_str::SmolStr;
use std::path::Path;
use std::sync::Arc;

/// Python as the host of one machine's scripts.
#[derive(Debug)]
pub(crate) struct PythonScripts {
    /// The machine at the start.
    pub(crate) machine: Machine,
    pub(crate) files: StateFiles,
    pub(crate) config: Config,
    pub(crate) keeper: ValueSerializer,
    pub(crate) seating: StateObjects,
    globals: PythonGlobals,
}

impl PythonScripts {
    pub(crate) fn new(opening: Opening<Handle>) -> Self {
        let Opening { machine, program, files, config, keeping, values } = opening;
        let keeper = ValueSerializer::new(keeping == Keeping::Full, values);
        let seating = StateObjects::new(program);
        Self { machine, files, config, keeper, seating, globals: PythonGlobals }
    }

    fn run_at(&self, py: Python<'_>, seat: &StateSlot, job: &Job<Handle>) -> ScriptResult<Handle> {
        let script = self.script_of(py, seat);
        if !self.keeper.keeps() || seat.place.keeping != Keeping::Full {
            return run(py, &script, seat, job, &ValueSerializer::NONE);
        }
        let result = run(py, &script, seat, job, &self.keeper);
        persistent::keep(py, seat, &self.keeper);
        result
    }
}

impl Scripts for PythonScripts {
    type Value = Handle;

    fn run(&self, job: Job<Handle>, place: &Arc<Place>) -> ScriptResult<Handle> {
        Python::attach(|py| {
            process_output::script_begins(job.path);
            let result = thread::at(job.path, || match self.seat(py, place) {
                Ok(seat) => self.run_at(py, &seat, &job),
                Err(error) => failed(py, error),
            });
            if current::is_forked() {
                crate::fork::end(py, &result);
            }
            process_output::script_ended(py, job.path);
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

    fn ended(&self, finish: &Finish<Handle>) {
        build_run::ended(finish);
    }

    fn finished(&self) {
        process_output::close();
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
        if current::is_embedded() {
            return;
        }
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

    fn value(&self, json: &Value) -> Result<Handle, ValueError> {
        literals::from_json(json)
    }

    fn with_literals(&self, make: &mut dyn FnMut(&mut dyn Literals<Handle>)) {
        make(&mut PythonLiterals);
    }

    fn keep<'v>(&self, value: &'v Handle) -> Keep<'v> {
        value.keep()
    }

    fn plain(&self, kept: &Kept) -> Result<Handle, ValueError> {
        Python::attach(|py| restore::plain(py, kept))
    }

    fn restore(&self, stored: &Stored, values: &Path) -> Result<Handle, ValueError> {
        Python::attach(|py| restore::restore(py, stored, values))
    }

    fn restore_persistent(&self, path: &str, value: Handle) -> Result<(), ValueError> {
        self.seating.restore_persistent(path, value);
        Ok(())
    }

    fn lost(&self, why: &str) -> Handle {
        Python::attach(|py| Handle::lost(py, why))
    }

    fn is_lost(&self, value: &Handle) -> Option<String> {
        value.why_lost()
    }

    fn restore_global(&self, name: &str, value: Handle) -> Result<(), ValueError> {
        Python::attach(|py| globals::restore(py, name, &value))
    }

    fn check(&self, check: &Check<Handle>, place: &Arc<Place>) -> Result<bool, SmolStr> {
        let program = self.seating.program();
        let node = program.node(check.node);
        Python::attach(|py| thread::at(place.path, || condition::check(py, check, node)))
    }

    fn changed(&self, _machine: &Machine, program: &Arc<Program<Handle>>) {
        self.seating.change(Arc::clone(program));
    }

    fn note_globals(&self) {
        let noted = Python::attach(|py| Runtime::get(py)?.note_globals.call0(py).map(drop));
        if let Err(error) = noted {
            let message = format!("global variables of before the run are not kept: {error}");
            current::say(LogLevel::Error, message);
        }
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

/// The result of a script that could not start.
pub(crate) fn failed(py: Python<'_>, error: PyErr) -> ScriptResult<Handle> {
    let error = error.into_value(py).into_bound(py).into_any();
    let error = Handle::kept(error, &ValueSerializer::before_the_run());
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
