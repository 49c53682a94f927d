//! Figures of whole processes: the release binary, the reference and bare CPython, in turns on one computer.
//!
//! The machines measure themselves and write their result to a file, so that the figure covers only the engine.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result};
use serde_json::Value;

use super::{Measured, journal, link, middle};
use crate::product::{Product, Profile};
use crate::reference::Reference;
use crate::{process, python, workspace};

/// Number of repetitions of each measurement.
pub(super) const RUNS: usize = 5;
/// Environment variable with the file for a machine's result.
const ANSWER: &str = "RAFCON_BENCH_ANSWER";

pub(super) struct Bench {
    product: Product,
    reference: Reference,
    machines: PathBuf,
    answer: PathBuf,
    /// Folder of recorded runs.
    runs: PathBuf,
}

/// Measures all figures.
pub(crate) fn measure() -> Result<Vec<Measured>> {
    let folder = workspace::target()?.join("bench");
    let bench = Bench {
        product: Product::build(Profile::Release)?,
        reference: Reference::installed()?,
        machines: folder.join("machines"),
        answer: folder.join("answer.json"),
        runs: folder.join("runs"),
    };
    bench.write_machines()?;
    let mut measured = bench.flat()?;
    measured.push(middle("preempt_ms", bench.times("race")?)?);
    measured.push(middle("barrier_64_ms", bench.times("gathering")?)?);
    measured.push(bench.first_state()?);
    measured.extend(journal::measure(&bench)?);
    measured.extend(link::measure(&bench)?);
    Ok(measured)
}

impl Bench {
    /// The program.
    pub(super) fn binary(&self) -> &Path {
        &self.product.binary
    }

    fn write_machines(&self) -> Result<()> {
        let mut writer = python::command(&self.reference.python);
        writer.arg("tests/bench/write_machines.py").arg(&self.machines);
        process::quiet(writer.env("PYTHONPATH", workspace::path("tests/conformance")))?;
        Ok(())
    }

    /// The three figures of the flat machine. Ratios are computed within each round, then their median.
    fn flat(&self) -> Result<Vec<Measured>> {
        let (mut ours, mut over_reference, mut over_loop) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..RUNS {
            let speed = self.speed(&mut self.run("flat"))?;
            let reference =
                self.speed(&mut self.reference.driver(&self.machines.join("flat_for_reference")))?;
            let mut floor = python::command(&self.reference.python);
            floor.arg("tests/bench/call_loop.py").arg(self.machines.join("flat"));
            let floor = number(&json(&process::quiet(&mut floor)?)?["states_per_s"])?;
            ours.push(speed);
            over_reference.push(speed / reference);
            over_loop.push(speed / floor);
        }
        Ok(vec![
            middle("python_flat_states_per_s", ours)?,
            middle("python_flat_over_reference", over_reference)?,
            middle("python_flat_over_call_loop", over_loop)?,
        ])
    }

    /// All durations that a machine measures of itself, over all runs.
    fn times(&self, machine: &str) -> Result<Vec<f64>> {
        let runs = (0..RUNS).map(|_| numbers(&self.answer(&mut self.run(machine))?["times_ms"]));
        Ok(runs.collect::<Result<Vec<_>>>()?.concat())
    }

    /// Time from the start of our process to the first state, minus the start of the bare interpreter.
    fn first_state(&self) -> Result<Measured> {
        let bare = format!(
            "import json, os, time; json.dump({{'first_ns': time.perf_counter_ns()}}, open(os.environ['{ANSWER}'], 'w'))"
        );
        let mut interpreter = Command::new(&self.reference.python);
        interpreter.args(["-c", &bare]);
        let above =
            (0..RUNS).map(|_| Ok(self.start(&self.run("first"))? - self.start(&interpreter)?));
        middle("first_state_ms", above.collect::<Result<_>>()?)
    }

    /// Time from the start of a program to its result.
    fn start(&self, program: &Command) -> Result<f64> {
        let mut stopwatch = self.helper("tests/bench/stopwatch.py");
        stopwatch.arg(program.get_program()).args(program.get_args());
        let times = json(&process::quiet(&mut stopwatch)?)?;
        numbers(&times["times_ms"])?.first().copied().context("the stopwatch took no time")
    }

    /// `rafcon run` of a machine with output to a file, without recording.
    fn run(&self, machine: &str) -> Command {
        self.run_kept(machine, "off", &self.runs)
    }

    /// `rafcon run` of a machine, recorded in `runs` at the level `keep`.
    pub(super) fn run_kept(&self, machine: &str, keep: &str, runs: &Path) -> Command {
        let mut run = process::command(&self.product.binary);
        // For users, Python caches compiled modules.
        run.env_remove("PYTHONDONTWRITEBYTECODE");
        run.arg("run").arg("--python").arg(&self.reference.python);
        run.args(["--keep", keep, "--runs"]).arg(runs).arg(self.machines.join(machine));
        run
    }

    /// An empty folder for runs.
    pub(super) fn empty_runs(&self) -> Result<&Path> {
        if self.runs.exists() {
            std::fs::remove_dir_all(&self.runs)
                .with_context(|| format!("cannot empty {}", self.runs.display()))?;
        }
        Ok(&self.runs)
    }

    /// A helper in Python, which receives the path of the result file.
    pub(super) fn helper(&self, script: &str) -> Command {
        let mut helper = python::command(&self.reference.python);
        helper.arg(script).env(ANSWER, &self.answer);
        helper
    }

    /// Speed that the machine reports of itself.
    pub(super) fn speed(&self, command: &mut Command) -> Result<f64> {
        number(&self.answer(command)?["states_per_s"])
    }

    /// Runs the command and reads the result of the machine.
    fn answer(&self, command: &mut Command) -> Result<Value> {
        remove(&self.answer)?;
        process::quiet(command.env(ANSWER, &self.answer).stdout(Stdio::null()))?;
        let text = std::fs::read_to_string(&self.answer);
        json(&text.with_context(|| format!("no answer in {}", self.answer.display()))?)
    }
}

fn remove(file: &Path) -> Result<()> {
    if file.exists() {
        std::fs::remove_file(file).with_context(|| format!("cannot remove {}", file.display()))?;
    }
    Ok(())
}

pub(super) fn json(text: &str) -> Result<Value> {
    serde_json::from_str(text).with_context(|| format!("not JSON: {text}"))
}

fn number(value: &Value) -> Result<f64> {
    value.as_f64().with_context(|| format!("not a number: {value}"))
}

pub(super) fn numbers(value: &Value) -> Result<Vec<f64>> {
    value.as_array().with_context(|| format!("not a list: {value}"))?.iter().map(number).collect()
}
