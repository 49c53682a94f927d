//! One run by `rafcon run --output json`, read line by line.

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use super::case::Case;
use super::observed::{self, Observed};
use crate::product::Product;
use crate::reference::Reference;
use crate::{process, workspace};

/// Exit code of a run that `--timeout` ended.
const TIMED_OUT: i32 = 6;

/// Runs the machine with the reference's interpreter, so that Python is identical for both.
pub(crate) fn run(product: &Product, reference: &Reference, case: &Case) -> Result<Observed> {
    let mut command = process::command(&product.binary);
    command
        .arg("run")
        .arg(&case.folder)
        .args(["--output", "json"])
        .arg("--python")
        .arg(&reference.python);
    command.env("RAFCON_RUNS", workspace::target()?.join("conformance/runs"));
    // Nobody can answer; the reference has no desktop either.
    command.env("RAFCON_DIALOGS", "missing");
    command.args(["--timeout", &case.expected.timeout_s.to_string()]);
    observed::add_common(&mut command, case);
    let (printed, code) = process::answer(&mut command)?;
    let mut seen = Observed { finished: code != Some(TIMED_OUT), ..Observed::default() };
    let mut ended = false;
    for line in printed.lines() {
        let event: Value = serde_json::from_str(line)
            .with_context(|| format!("{}: not JSON: {line}", case.name))?;
        ended |= take(&mut seen, &event);
    }
    if !ended {
        bail!("{}: `rafcon run` ended without a `finished` line; it printed\n{printed}", case.name);
    }
    Ok(seen)
}

/// Adds one event to the observations; true for the last event.
fn take(seen: &mut Observed, event: &Value) -> bool {
    match event["type"].as_str() {
        Some("entered") => seen.entered.push(event["path"].as_str().unwrap_or_default().to_owned()),
        Some("log") if is_from_script(event) => seen.log.extend(lines(event)),
        Some("finished") => {
            seen.outcome = event["outcome"].clone();
            seen.outputs = event["outputs"].clone();
            seen.globals = event["globals"].clone();
            seen.states_run = event["states_run"].as_u64();
            seen.scoped_variables = event["scoped_variables"].clone();
            return true;
        }
        _ => {}
    }
    false
}

/// False for notes of the engine, whose wording differs by intention.
fn is_from_script(event: &Value) -> bool {
    matches!(event["stream"].as_str(), Some("stdout" | "logger"))
}

fn lines(event: &Value) -> impl Iterator<Item = String> {
    event["message"].as_str().unwrap_or_default().lines().map(str::to_owned)
}
