//! Execution of one script, from its inputs to its result.

use crate::copy::copied;
use crate::handle::Handle;
use crate::returned::returned;
use crate::runtime::Runtime;
use crate::script::Script;
use crate::state_table::StateSlot;
use crate::value_serializer::ValueSerializer;
use crate::{current, module, scripts};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use rafcon_engine::{Job, Returned, ScriptResult, Verdicts};
use rafcon_model::OutcomeId;
use rafcon_protocol::LogLevel;
use rafcon_runner::signals::PREEMPTED;

/// Runs the script of the state at `seat`. An exception becomes its result.
pub(crate) fn run(
    py: Python<'_>,
    script: &Script,
    seat: &StateSlot,
    job: &Job<Handle>,
    keeper: &ValueSerializer,
) -> ScriptResult<Handle> {
    let outcome = Runtime::get(py).and_then(|runtime| {
        let call = Call { py, runtime, script, seat, job, keeper };
        let result = if job.backward { call.run_backward() } else { call.run() };
        flush(py, runtime);
        result
    });
    outcome.unwrap_or_else(|error| scripts::failed(py, error))
}

/// Logs output of the script without a final newline.
fn flush(py: Python<'_>, runtime: &Runtime) {
    if !runtime.pending.bind(py).is_empty()
        && let Err(error) = runtime.flush_capture.call0(py)
    {
        current::say(LogLevel::Error, format!("the last output of the script is lost: {error}"));
    }
}

/// A script with everything needed to run it.
struct Call<'c, 'py> {
    py: Python<'py>,
    runtime: &'c Runtime,
    script: &'c Script,
    seat: &'c StateSlot,
    job: &'c Job<Handle>,
    keeper: &'c ValueSerializer,
}

impl<'py> Call<'_, 'py> {
    fn run(&self) -> PyResult<ScriptResult<Handle>> {
        let (inputs, outputs) = (self.inputs()?, self.outputs()?);
        self.seat.begin(&inputs, &outputs);
        if let Some(verdicts) = &self.job.verdicts {
            self.tell_verdicts(verdicts)?;
        }
        let returned = self.call(&inputs, &outputs);
        let (returned, raised) = match returned {
            Ok(returned) => (returned, None),
            Err(error) => self.raised(error),
        };
        let error = match raised {
            Some(error) => Some(error),
            None => self.declared_error(&outputs)?,
        };
        Ok(ScriptResult { returned, outputs: self.collect(&outputs)?, error })
    }

    /// Runs `backward_execute`, if it exists. Its return value is ignored.
    fn run_backward(&self) -> PyResult<ScriptResult<Handle>> {
        let (inputs, outputs) = (self.inputs()?, self.outputs()?);
        self.seat.begin(&inputs, &outputs);
        let done = self.call_backward(&inputs, &outputs);
        let (returned, error) = match done {
            Ok(()) => (Returned::Id(0), None),
            Err(error) => self.raised(error),
        };
        Ok(ScriptResult { returned, outputs: vec![None; self.script.outputs.len()], error })
    }

    fn call_backward(
        &self,
        inputs: &Bound<'py, PyDict>,
        outputs: &Bound<'py, PyDict>,
    ) -> PyResult<()> {
        let Some(function) = self.script.backward_execute(self.py)? else { return Ok(()) };
        let state = self.seat.object.bind(self.py);
        let variables = self.runtime.global_variables.bind(self.py);
        let flag = intern!(self.py, "_backward");
        state.setattr(flag, true)?;
        let done = module::call(&function, [state, inputs, outputs, variables]);
        state.setattr(flag, false)?;
        done.map(drop)
    }

    fn inputs(&self) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(self.py);
        for (name, value) in self.script.inputs.iter().zip(self.job.inputs.iter()) {
            dict.set_item(name, self.for_script(name, value))?;
        }
        if let Some(error) = &self.job.error {
            let name = intern!(self.py, "error");
            dict.set_item(name, self.for_script(name.as_unbound(), error))?;
        }
        Ok(dict)
    }

    fn outputs(&self) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(self.py);
        for (name, value) in self.script.outputs.iter().zip(self.job.outputs.iter()) {
            dict.set_item(name, self.for_script(name, value))?;
        }
        Ok(dict)
    }

    /// A copy, or the object itself if it cannot be copied. This is reported once for each port.
    fn for_script(&self, name: &Py<PyString>, value: &Handle) -> Bound<'py, PyAny> {
        copied(self.py, value).unwrap_or_else(|error| {
            let name = name.bind(self.py).to_string_lossy();
            if self.script.is_news(&name) {
                current::say(
                    LogLevel::Warning,
                    format!("the value of \"{name}\" cannot be copied ({error}); the script gets the object itself"),
                );
            }
            value.bind(self.py)
        })
    }

    fn tell_verdicts(&self, verdicts: &Verdicts<Handle>) -> PyResult<()> {
        let tell = |verdict: &rafcon_engine::Verdict<Handle>| {
            let error = verdict.error.as_ref().map(|error| error.bind(self.py));
            let (state, outcome) = (verdict.state.as_str(), verdict.outcome_name.as_str());
            (
                state.to_owned(),
                verdict.name.to_string(),
                verdict.outcome.0,
                outcome.to_owned(),
                error,
            )
        };
        let told: Vec<_> = verdicts.children.iter().map(tell).collect();
        self.runtime.set_verdicts.call1(self.py, (&self.seat.object, told))?;
        Ok(())
    }

    fn call(
        &self,
        inputs: &Bound<'py, PyDict>,
        outputs: &Bound<'py, PyDict>,
    ) -> PyResult<Returned> {
        let hooks = self.runtime.script_hooks(self.py);
        if let Some(hooks) = hooks {
            hooks.call_method0(intern!(self.py, "pre_script"))?;
        }
        let execute = self.script.execute(self.py)?;
        let state = self.seat.object.bind(self.py);
        let variables = self.runtime.global_variables.bind(self.py);
        let value = module::call(&execute, [state, inputs, outputs, variables])?;
        if let Some(hooks) = hooks {
            hooks.call_method0(intern!(self.py, "post_script"))?;
        }
        if self.seat.place.signals.any(PREEMPTED) {
            return Ok(Returned::Id(OutcomeId::PREEMPTED.0));
        }
        returned(&value, &self.script.outcomes)
    }

    fn raised(&self, error: PyErr) -> (Returned, Option<Handle>) {
        if error.matches(self.py, &self.runtime.state_preempted).unwrap_or(false) {
            return (Returned::Id(OutcomeId::PREEMPTED.0), None);
        }
        let value = error.into_value(self.py).into_bound(self.py).into_any();
        let shown = self.runtime.format_error.call1(self.py, (&value, &self.script.file));
        let shown = shown.and_then(|text| text.extract::<String>(self.py));
        let text =
            shown.unwrap_or_else(|failing| format!("(its traceback cannot be shown: {failing})"));
        current::say(LogLevel::Error, text);
        (Returned::Raised, Some(Handle::kept(value, self.keeper)))
    }

    /// The entry `error` of the outputs, if it is true.
    fn declared_error(&self, outputs: &Bound<'py, PyDict>) -> PyResult<Option<Handle>> {
        if outputs.len() <= self.script.outputs.len() && !self.script.has_error_output {
            return Ok(None);
        }
        let error = outputs.get_item(intern!(self.py, "error"))?;
        Ok(match error {
            Some(error) if error.is_truthy()? => Some(Handle::kept(error, self.keeper)),
            _ => None,
        })
    }

    fn collect(&self, outputs: &Bound<'py, PyDict>) -> PyResult<Vec<Option<Handle>>> {
        let mut found = 0;
        let mut values = Vec::with_capacity(self.script.outputs.len());
        for (name, default) in self.script.outputs.iter().zip(self.job.outputs.iter()) {
            let value = outputs.get_item(name)?;
            found += usize::from(value.is_some());
            values.push(value.map(|value| self.handle(value, default)));
        }
        if outputs.len() > found {
            self.report_undeclared(outputs)?;
        }
        Ok(values)
    }

    fn report_undeclared(&self, outputs: &Bound<'py, PyDict>) -> PyResult<()> {
        let declared = |key: &Bound<'py, PyAny>| {
            self.script.outputs.iter().any(|name| key.eq(name).unwrap_or(false))
        };
        for (key, _) in outputs.iter() {
            if !declared(&key) && !key.eq(intern!(self.py, "error"))? {
                let name = key.str()?.to_string_lossy().into_owned();
                let message = format!(
                    "the script set the output \"{name}\", but the state has no such port; the value is lost"
                );
                current::say(LogLevel::Warning, message);
            }
        }
        Ok(())
    }

    /// A handle for a value that a script left in its outputs; the handle of the default, if the script left the default.
    fn handle(&self, value: Bound<'py, PyAny>, default: &Handle) -> Handle {
        if default.is(&value) { default.clone() } else { Handle::kept(value, self.keeper) }
    }
}
