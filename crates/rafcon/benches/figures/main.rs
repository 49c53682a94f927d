//! Figures of speed and memory that are measured inside one program: one JSON object a line, medians of several runs.
//!
//! `cargo xtask bench` runs this and compares with what is promised. Knows the public interfaces of model, storage and
//! engine, and the `rafcon` binary, which makes the machines that are loaded.
#![expect(clippy::print_stdout, reason = "the figures go to the standard output")]

mod build;
mod clock;
mod disk;
mod flat;
mod journal;
mod machines;
mod memory;

use std::path::Path;
use std::process::ExitCode;

/// Every figure is the median of so many runs.
const RUNS: usize = 5;

/// Measures one part; the folder is for machines.
type Measure = fn(&Path) -> anyhow::Result<()>;

/// Words on the command line choose among these; without a word all are measured.
const PARTS: [(&str, Measure); 5] = [
    ("flat", |_| flat::measure()),
    ("build", |_| build::measure()),
    ("disk", disk::measure),
    ("memory", memory::measure),
    ("journal", journal::measure),
];

fn main() -> anyhow::Result<ExitCode> {
    if let Some(path) = memory::asked_for() {
        println!("{}", memory::taken_by(&path)?);
        return Ok(ExitCode::SUCCESS);
    }
    let folder = tempfile::tempdir()?;
    let wanted = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect::<Vec<_>>();
    for (name, measure) in PARTS {
        if wanted.is_empty() || wanted.iter().any(|word| word == name) {
            measure(folder.path())?;
        }
    }
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
