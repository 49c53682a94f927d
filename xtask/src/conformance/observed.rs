//! Observations of one run, in a common form for both engines.

use std::process::Command;

use anyhow::{Context as _, Result};
use serde_json::Value;

use super::case::Case;
use crate::reference::Reference;
use crate::{process, workspace};

/// All that a user sees of one run.
#[derive(Debug, Default)]
pub(crate) struct Observed {
    /// True if it ended by itself.
    pub(crate) finished: bool,
    /// `{"id", "name"}` of the root.
    pub(crate) outcome: Value,
    /// The root's outputs by name.
    pub(crate) outputs: Value,
    /// The global variables by name.
    pub(crate) globals: Value,
    /// The root's scoped variables by name; null if it can have none.
    pub(crate) scoped_variables: Value,
    /// Paths of the entered states, in order.
    pub(crate) entered: Vec<String>,
    /// Number of states run, if known.
    pub(crate) states_run: Option<u64>,
    /// Log and output of scripts, one entry a line.
    pub(crate) log: Vec<String>,
    /// Paths of the library states and concurrency states of the machine; available only from the reference.
    pub(crate) places: Places,
}

/// Paths for the comparison.
#[derive(Debug, Default)]
pub(crate) struct Places {
    /// States that refer to a library; their one child is the library's root.
    pub(crate) libraries: Vec<String>,
    /// States with concurrent children.
    pub(crate) concurrency: Vec<String>,
}

/// Runs the reference and returns its answer.
pub(crate) fn reference(reference: &Reference, case: &Case) -> Result<Value> {
    let mut driver = reference.driver(&case.folder);
    driver.args(["--timeout", &case.expected.timeout_s.to_string()]);
    add_common(&mut driver, case);
    let answer = process::quiet(&mut driver)?;
    serde_json::from_str(&answer)
        .with_context(|| format!("{}: the reference's driver printed {answer:?}", case.name))
}

/// The common options of the driver and `rafcon run`.
pub(crate) fn add_common(command: &mut Command, case: &Case) {
    for library in &case.libraries {
        command.args(["--library-path", library]);
    }
    if let Some(path) = &case.expected.start_from {
        command.args(["--start-from", path]);
    }
}

impl Observed {
    /// Parses the driver's answer, or a recorded run in that format.
    pub(crate) fn of_reference(answer: &Value) -> Result<Self> {
        let printed = answer["stdout"].as_str().unwrap_or_default().lines().map(str::to_owned);
        let logged = answer["log"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(|record| record["message"].as_str());
        Ok(Self {
            finished: answer["finished"]
                .as_bool()
                .context("no `finished` in the reference's answer")?,
            outcome: answer["outcome"].clone(),
            outputs: answer["outputs"].clone(),
            globals: answer["globals"].clone(),
            scoped_variables: answer["scoped_variables"].clone(),
            entered: entered(&answer["trace"]),
            states_run: answer["states_run"].as_u64(),
            log: logged.flat_map(str::lines).map(str::to_owned).chain(printed).collect(),
            places: Places {
                libraries: texts(&answer["libraries"]),
                concurrency: texts(&answer["concurrency"]),
            },
        })
    }
}

/// The entered states of a history: a container has two entries, the root only one as a container.
fn entered(trace: &Value) -> Vec<String> {
    let mut entered = Vec::new();
    let mut called = "";
    for event in trace.as_array().into_iter().flatten() {
        let (path, what) =
            (event[0].as_str().unwrap_or_default(), event[1].as_str().unwrap_or_default());
        if what == "call:EXECUTE" || what == "call:CONTAINER" && path != called {
            entered.push(path.to_owned());
        }
        called = if what == "call:EXECUTE" { path } else { "" };
    }
    entered
}

fn texts(value: &Value) -> Vec<String> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
}

/// The recorded runs of the reference for the machines that it ships.
const RECORDED: &str = "tests/conformance/recorded/shipped.jsonl";

/// The recorded run of this machine, if it is deterministic.
pub(crate) fn recorded(machine: &str) -> Result<Option<Observed>> {
    for line in workspace::read(RECORDED)?.lines() {
        let run: Value =
            serde_json::from_str(line).with_context(|| format!("{RECORDED}: not JSON"))?;
        if run["machine"] == machine && run["deterministic"] == true {
            return Observed::of_reference(&run).map(Some);
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_entered_once_however_often_the_history_names_it() {
        let trace = serde_json::json!([
            ["R", "start"],
            ["R", "call:CONTAINER"],
            ["R/A", "call:EXECUTE"],
            ["R/A", "call:CONTAINER"],
            ["R/A", "return:CONTAINER>success"],
            ["R/A", "return:EXECUTE>success"],
            ["R/A", "call:EXECUTE"],
        ]);
        assert_eq!(entered(&trace), ["R", "R/A", "R/A"]);
    }
}
