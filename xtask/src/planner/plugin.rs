//! The example of the reference's planner plugin, planned by us and run, and planned by the plugin with the default engine
//! as well. The plugin is a black box in the reference's own environment.

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use super::figures::Measured;
use super::{Planned, PlannerBench, REPEATS, middle, timed_plan};
use crate::reference::Reference;
use crate::{process, python, test, workspace};

/// Program that runs the plugin.
const PROGRAM: &str = include_str!("plugin.py");

/// Measures our planning and the plugin's.
pub(super) fn measure(bench: &PlannerBench, measured: &mut Measured) -> Result<()> {
    let plugin = test::planner()?;
    let example = plugin.join("examples/restaurant_tutorial");
    let pool = example.join("restaurant_state_pool");
    let machine = bench.folder.join("lunch");
    let (mut planned, mut built) = (Vec::new(), Vec::new());
    for _ in 0..REPEATS {
        if machine.exists() {
            std::fs::remove_dir_all(&machine)?;
        }
        let mut plan = bench.rafcon();
        plan.arg("plan").arg(&pool).arg("--json").arg("--facts").arg(example.join("facts.pddl"));
        plan.arg("--types").arg(example.join("rtpp-typehierarchy.json")).arg("--out").arg(&machine);
        let Planned { shown, done, .. } = timed_plan(&mut plan)?;
        planned.push(shown);
        built.push(done - shown);
    }
    measured.note("restaurant_plan_ms", middle(planned));
    measured.note("restaurant_save_ms", middle(built));
    let mut run = bench.rafcon();
    run.arg("run").arg(&machine).args(["--keep", "off", "--output", "json", "--library-path"]);
    let said = process::quiet(run.arg(format!("restaurant_state_pool={}", pool.display())))?;
    let end: Value = serde_json::from_str(said.lines().last().unwrap_or_default())?;
    ensure!(end["outcome"]["name"] == "success", "the restaurant's machine ended so: {end}");
    let reference = Reference::installed()?;
    let (mut plan, mut build) = (Vec::new(), Vec::new());
    for _ in 0..REPEATS {
        let mut command = python::command(&reference.python);
        command.args(["-c", PROGRAM]).arg(&plugin).arg(bench.python.with_file_name("kairos"));
        let said = process::quiet(command.current_dir(workspace::target()?))?;
        let said: Value = serde_json::from_str(said.lines().last().unwrap_or_default())
            .context("the plugin printed no JSON")?;
        ensure!(said["steps"] == 9, "the plugin plans otherwise: {said}");
        plan.push(said["plan_ms"].as_f64().context("no time")?);
        build.push(said["build_ms"].as_f64().context("no time")?);
    }
    measured.note("plugin_plan_ms", middle(plan));
    measured.note("plugin_build_ms", middle(build));
    Ok(())
}
