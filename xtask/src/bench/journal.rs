//! Figures of recorded runs: speed, size, and the delay of commands.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};

use super::whole_process::{Bench, RUNS, json, numbers};
use super::{Measured, middle};
use crate::process;

/// Number of states that the flat machine runs.
const FLAT_STATES: f64 = 400_000.0;

/// Measures all figures.
pub(super) fn measure(bench: &Bench) -> Result<Vec<Measured>> {
    let mut measured = speeds(bench)?;
    let sizes = (0..RUNS).map(|_| bytes_per_state(bench));
    measured.push(middle("journal_bytes_per_state", sizes.collect::<Result<_>>()?)?);
    let times = (0..RUNS).map(|_| command_ms(bench));
    measured.push(middle("command_ms", times.collect::<Result<Vec<_>>>()?.concat())?);
    Ok(measured)
}

/// Compares full recording with none. Ratios are computed within each round, then their median.
fn speeds(bench: &Bench) -> Result<Vec<Measured>> {
    let (mut full, mut over_off) = (Vec::new(), Vec::new());
    for _ in 0..RUNS {
        let runs = bench.empty_runs()?;
        let speed = bench.speed(&mut bench.run_kept("flat", "full", runs))?;
        let off = bench.speed(&mut bench.run_kept("flat", "off", runs))?;
        full.push(speed);
        over_off.push(speed / off);
    }
    Ok(vec![middle("journal_full_states_per_s", full)?, middle("journal_over_off", over_off)?])
}

/// Journal size per state without values, for the `int` counter of the flat machine.
fn bytes_per_state(bench: &Bench) -> Result<f64> {
    let runs = bench.empty_runs()?;
    bench.speed(&mut bench.run_kept("flat", "status", runs))?;
    let bytes = u32::try_from(size(runs)?).context("a run of more than 4 GiB")?;
    Ok(f64::from(bytes) / FLAT_STATES)
}

/// Bytes of all files below the folder.
fn size(folder: &Path) -> Result<u64> {
    let mut bytes = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let about = entry.metadata()?;
        bytes += if about.is_dir() { size(&entry.path())? } else { about.len() };
    }
    Ok(bytes)
}

fn command_ms(bench: &Bench) -> Result<Vec<f64>> {
    let runs = bench.empty_runs()?;
    let run = bench.run_kept("commanded", "full", runs);
    let mut commander = bench.helper("tests/bench/commander.py");
    commander.arg(runs).arg(run.get_program()).args(run.get_args());
    numbers(&json(&process::quiet(&mut commander)?)?["times_ms"])
}
