//! Measures planning with the default engine: from the command to the machine, during a run, after a cancellation, and in
//! comparison with the reference's planner plugin. Uses `rafcon` as a program.

mod cancelling;
mod figures;
mod plugin;
mod pool;
mod problems;
mod replanning;

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use serde_json::{Value, json};

use crate::product::{Product, Profile};
use crate::{process, test, workspace};
use figures::Measured;

/// Options of `cargo xtask planner`.
#[derive(clap::Args, Clone, Copy)]
pub(crate) struct PlannerOptions {
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    /// Measure a debug build; its figures do not count
    #[arg(long)]
    debug: bool,
    /// Use an earlier build
    #[arg(long)]
    no_build: bool,
}

/// Minimum number of steps of the large machine.
const STEPS: usize = 463;
/// Number of packages that leads to this many steps.
const PACKAGES: usize = 56;
/// Number of repetitions of short measurements; the median counts.
const REPEATS: usize = 5;

/// Common data of the measurements.
struct PlannerBench {
    product: Product,
    /// An interpreter with the engine next to it.
    python: PathBuf,
    /// Folder of skills, problems and machines.
    folder: PathBuf,
}

/// Measures, and fails if a bar is missed.
pub(crate) fn run(options: PlannerOptions) -> Result<()> {
    let profile = if options.debug { Profile::Debug } else { Profile::Release };
    let product =
        if options.no_build { Product::built(profile)? } else { Product::build(profile)? };
    let folder = workspace::target()?.join("planner");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let bench = PlannerBench { product, python: test::engine_environment()?, folder };
    pool::write(&bench.folder.join("blocks"), problems::BLOCKS, pool::DONE)?;
    pool::write(&bench.folder.join("logistics"), problems::LOGISTICS, pool::DONE)?;
    fs::write(bench.folder.join("types.json"), problems::TYPES)?;
    let mut measured = Measured::default();
    bench.plans(&mut measured)?;
    bench.machine(&mut measured)?;
    replanning::measure(&bench, &mut measured)?;
    cancelling::measure(&bench, &mut measured)?;
    plugin::measure(&bench, &mut measured)?;
    measured.print(options.json)
}

impl PlannerBench {
    /// The program, with the default engine.
    fn rafcon(&self) -> Command {
        let mut command = process::command(&self.product.binary);
        command.env("RAFCON_PYTHON", &self.python);
        command
    }

    /// `rafcon plan` on a pool, for these facts, into a new machine.
    fn plan(&self, pool: &str, facts: &Path, machine: &Path) -> Result<Command> {
        if machine.exists() {
            fs::remove_dir_all(machine)?;
        }
        let mut command = self.rafcon();
        command.arg("plan").arg(self.folder.join(pool)).arg("--json").arg("--facts").arg(facts);
        command.arg("--types").arg(self.folder.join("types.json")).arg("--out").arg(machine);
        Ok(command)
    }

    /// Writes a problem to a file.
    fn facts(&self, name: &str, text: &str) -> Result<PathBuf> {
        let file = self.folder.join(name).with_extension("pddl");
        fs::write(&file, text)?;
        Ok(file)
    }

    /// Blocks and logistics, from the command to the plan.
    fn plans(&self, measured: &mut Measured) -> Result<()> {
        let blocks = self.facts("blocks_40", &problems::blocks(40, false))?;
        let planned = timed_plan(&mut self.plan("blocks", &blocks, &self.folder.join("a"))?)?;
        measured.note("blocks_40_ms", planned.shown);
        measured.note("blocks_40_steps", count(&planned.found));
        let logistics = self.facts("logistics_40", &problems::logistics(12, 40))?;
        let machine = self.folder.join("b");
        let planned = timed_plan(&mut self.plan("logistics", &logistics, &machine)?)?;
        measured.note("logistics_12_40_ms", planned.shown);
        measured.note("logistics_12_40_steps", count(&planned.found));
        Ok(())
    }

    /// Measures a long plan from an engine that prints it at once, so that only our own work counts.
    fn machine(&self, measured: &mut Measured) -> Result<()> {
        let facts = self.facts("logistics_many", &problems::logistics(12, PACKAGES))?;
        let machine = self.folder.join("many");
        let found = timed_plan(&mut self.plan("logistics", &facts, &machine)?)?.found;
        let steps = found["steps"].as_array().context("a plan has steps")?;
        if steps.len() < STEPS {
            bail!("the plan has {} steps, not {STEPS}: take more packages", steps.len());
        }
        let said: Vec<_> = steps.iter().map(|step| json!({ "action": action(step) })).collect();
        let python =
            pool::engine_that_says(&self.folder.join("parrot"), &json!({ "steps": said }))?;
        let (mut shown, mut saved) = (Vec::new(), Vec::new());
        for _ in 0..REPEATS {
            let mut plan = self.plan("logistics", &facts, &machine)?;
            let planned = timed_plan(plan.env("RAFCON_PYTHON", &python))?;
            shown.push(planned.found["after_ms"].as_f64().context("no time")?);
            saved.push(planned.done);
        }
        measured.note("machine_ms", middle(shown));
        measured.note("machine_steps", count(&found));
        measured.note("machine_saved_ms", middle(saved));
        let root = format!("logistics={}", self.folder.join("logistics").display());
        let mut check = self.rafcon();
        check.arg("check").arg(&machine).args(["--library-path", &root, "--format", "json"]);
        measured.note("machine_notes", lines(&process::quiet(&mut check)?));
        Ok(())
    }
}

/// An action in the syntax of engines.
fn action(step: &Value) -> String {
    let objects = step["objects"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let words: Vec<&str> = step["action"].as_str().into_iter().chain(objects).collect();
    format!("({})", words.join(" "))
}

/// Number of steps of a plan.
#[expect(clippy::cast_precision_loss, reason = "plans are short")]
fn count(found: &Value) -> f64 {
    found["steps"].as_array().map_or(0, Vec::len) as f64
}

#[expect(clippy::cast_precision_loss, reason = "texts are short")]
fn lines(text: &str) -> f64 {
    text.lines().count() as f64
}

/// Output of `rafcon plan --json`, with its times.
struct Planned {
    /// Time in ms until the plan was printed.
    shown: f64,
    /// Time in ms until the program ended.
    done: f64,
    found: Value,
}

/// Runs `rafcon plan --json`.
fn timed_plan(command: &mut Command) -> Result<Planned> {
    let begin = now();
    let mut child = command.stdout(Stdio::piped()).spawn().context("rafcon does not start")?;
    let mut out = BufReader::new(child.stdout.take().context("the output of rafcon is not piped")?);
    let mut line = String::new();
    out.read_line(&mut line)?;
    let shown = since(begin);
    std::io::copy(&mut out, &mut std::io::sink())?;
    let status = child.wait()?;
    let done = since(begin);
    let found: Value = serde_json::from_str(&line).context("no events")?;
    if found["event"] != "found" || !status.success() {
        bail!("no plan: {found}");
    }
    Ok(Planned { shown, done, found })
}

#[expect(clippy::disallowed_methods, reason = "a measurement of whole programs")]
fn now() -> Instant {
    Instant::now()
}

/// Time in ms since `begin`.
fn since(begin: Instant) -> f64 {
    begin.elapsed().as_secs_f64() * 1000.0
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
