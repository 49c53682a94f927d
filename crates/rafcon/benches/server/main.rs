//! Figures of the server: one JSON object a line. Real processes of the release build: `rafcon serve`, its runners, and this
//! program as their client.
//!
//! `cargo xtask bench` runs this and compares with what is promised.
#![expect(clippy::print_stdout, reason = "the figures go to the standard output")]

mod bench_server;
mod clock;
mod command;
mod followers;
mod idle;
mod mission;
mod resume;
#[path = "../../tests/it/served.rs"]
mod served;
mod status;

use bench_server::BenchServer;
use std::process::ExitCode;

/// Measures one part.
type Measure = fn(&BenchServer) -> anyhow::Result<()>;

/// Words on the command line choose among these; without a word all are measured.
const PARTS: [(&str, Measure); 6] = [
    ("command", command::measure),
    ("status", status::measure),
    ("mission", mission::measure),
    ("resume", resume::measure),
    ("idle", idle::measure),
    ("followers", followers::measure),
];

fn main() -> anyhow::Result<ExitCode> {
    if let Some(words) = followers::asked_for() {
        followers::follow(&words)?;
        return Ok(ExitCode::SUCCESS);
    }
    let wanted = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect::<Vec<_>>();
    for (name, measure) in PARTS {
        if wanted.is_empty() || wanted.iter().any(|word| word == name) {
            measure(&BenchServer::new()?)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints one figure.
fn print(name: &str, value: f64, unit: &str) {
    println!("{}", serde_json::json!({ "name": name, "value": value, "unit": unit }));
}

/// The value that so many hundredths of the values are below; 50 is the middle.
fn percentile(mut values: Vec<f64>, hundredths: usize) -> anyhow::Result<f64> {
    values.sort_by(f64::total_cmp);
    let index = values.len() * hundredths / 100;
    values.get(index).copied().ok_or_else(|| anyhow::anyhow!("nothing was measured"))
}
