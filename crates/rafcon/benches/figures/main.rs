//! Figures of speed and memory that are measured inside one program: one JSON object a line, medians of several runs.
//!
//! `cargo xtask bench` runs this and compares with what is promised. Knows the public interfaces of model, storage and
//! engine, and the `rafcon` binary, which makes the machines that are loaded.
#![expect(clippy::print_stdout, reason = "the figures go to the standard output")]

mod clock;
mod disk;
mod flat;
mod machines;
mod memory;

use std::process::ExitCode;

/// Every figure is the median of so many runs.
const RUNS: usize = 5;

fn main() -> anyhow::Result<ExitCode> {
    if let Some(path) = memory::asked_for() {
        println!("{}", memory::taken_by(&path)?);
        return Ok(ExitCode::SUCCESS);
    }
    let folder = tempfile::tempdir()?;
    flat::measure();
    disk::measure(folder.path())?;
    memory::measure(folder.path())?;
    Ok(ExitCode::SUCCESS)
}

/// Prints one figure.
fn print(name: &str, value: f64, unit: &str) {
    println!("{}", serde_json::json!({ "name": name, "value": value, "unit": unit }));
}

/// The middle of [`RUNS`] values.
fn median<E>(mut run: impl FnMut() -> Result<f64, E>) -> Result<f64, E> {
    let mut values = (0..RUNS).map(|_| run()).collect::<Result<Vec<_>, _>>()?;
    values.sort_by(f64::total_cmp);
    Ok(values[values.len() / 2])
}
