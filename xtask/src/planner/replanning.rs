//! Measures the time between a failed step and the next plan, in a run whose world has changed. Knows the events of
//! journals.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, bail, ensure};
use serde_json::Value;

use super::figures::Measured;
use super::{PlannerBench, count, pool, problems, timed_plan};
use crate::{process, workspace};

/// Number of blocks that leads to plans of 20 steps and more.
const BLOCKS: usize = 12;
const STEPS: f64 = 20.0;

/// A script that fails in the first step of a run.
const SLIPS: &str = r#"def execute(self, inputs, outputs, gvm):
    if gvm.variable_exist("slipped"):
        return "success"
    gvm.set_variable("slipped", True)
    raise RuntimeError("it slips")
"#;

/// Measures the time of replanning.
pub(super) fn measure(bench: &PlannerBench, measured: &mut Measured) -> Result<()> {
    let folder = bench.folder.join("shaken");
    pool::write(&folder, problems::BLOCKS, SLIPS)?;
    pool::observer(&folder.join("observe"), &problems::blocks(BLOCKS, true))?;
    let planning = format!("planning={}", workspace::path("libraries/planning").display());
    let (machine, runs) = (bench.folder.join("shaken_machine"), bench.folder.join("runs"));
    let facts = bench.facts("shaken", &problems::blocks(BLOCKS, false))?;
    let mut plan = bench.plan("shaken", &facts, &machine)?;
    plan.args(["--then", "replan", "--observe", "shaken/observe", "--library-path", &planning]);
    let found = timed_plan(&mut plan)?.found;
    let mut run = bench.rafcon();
    run.arg("run").arg(&machine).args(["--library-path", &planning, "--library-path"]);
    run.arg(format!("shaken={}", folder.display())).arg("--runs").arg(&runs);
    process::quiet(&mut run)?;
    let run = only_one(&runs)?;
    let mut history = bench.rafcon();
    history.arg("history").arg(&run).arg("--json").arg("--runs").arg(&runs);
    let events = process::quiet(&mut history)?;
    let events: Vec<Value> =
        events.lines().map(serde_json::from_str).collect::<Result<_, _>>().context("no history")?;
    let (ms, steps) = replanned(&events)?;
    measured.note("replan_ms", ms);
    measured.note("replan_steps", count(&found));
    measured.note("replan_new_steps", steps);
    ensure!(steps >= STEPS, "the new plan has {steps} steps: take more blocks");
    Ok(())
}

/// The name of the only run.
fn only_one(runs: &Path) -> Result<String> {
    let mut folders = fs::read_dir(runs)?.collect::<Result<Vec<_>, _>>()?;
    folders.retain(|entry| entry.path().is_dir());
    let [run] = folders.as_slice() else { bail!("{} has not one run", runs.display()) };
    Ok(run.file_name().to_string_lossy().into_owned())
}

/// Time in ms between the first failure and the first step after the last change of the machine, with the number of steps
/// at that time.
fn replanned(events: &[Value]) -> Result<(f64, f64)> {
    let kind = |event: &Value, kind: &str| event["event"]["type"] == kind;
    let time = |event: &Value| event["t_ns"].as_f64().context("an event without time");
    let failed = events.iter().find(|event| {
        kind(event, "left") && event["event"]["outcome"]["id"].as_i64().is_some_and(|id| id < 0)
    });
    let changed = events.iter().rposition(|event| kind(event, "root")).context("no change")?;
    // A step is a library state: the root, the step, its content.
    let is_step = |event: &&Value| {
        let path = event["event"]["path"].as_str().unwrap_or_default();
        kind(event, "entered") && path.matches('/').count() == 1
    };
    let mut steps = events[changed..].iter().filter(is_step);
    let first = steps.next().context("nothing ran after the change")?;
    let ms = (time(first)? - time(failed.context("nothing failed")?)?) / 1e6;
    #[expect(clippy::cast_precision_loss, reason = "plans are short")]
    let count = (steps.count() + 1) as f64;
    Ok((ms, count))
}
