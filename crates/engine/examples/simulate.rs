//! Runs random machines in random orders: `cargo run -p rafcon-engine --example simulate -- --seeds 10000 [--from 0]`.
//! With `--first-world`, a run has only the features of the first version of the simulation, so that old seeds fail as
//! before.
//!
//! Each seed runs twice, and both runs must produce identical output, byte for byte. A failure prints the first broken
//! promise with its seed, its machine and the last events, and exits with 1. Otherwise the program prints what was
//! exercised and exits with 0, or with 1 if a feature was hardly exercised.

use rafcon_testkit::simulation::{self, Counts, Report, Width};
use std::process::ExitCode;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "this is a command-line program")]
fn main() -> ExitCode {
    let Some(Arguments { from, count, width }) = arguments() else {
        eprintln!("usage: simulate [--seeds NUMBER] [--from SEED] [--first-world]");
        return ExitCode::from(2);
    };
    let mut counts = Counts::default();
    for seed in from..from.saturating_add(count) {
        match (simulate(seed, width), simulate(seed, width)) {
            (Ok(report), again) if again.as_ref() == Ok(&report) => counts.add(&report.counts),
            (Ok(_), _) => {
                eprintln!("seed {seed}: another run of it went otherwise");
                return ExitCode::FAILURE;
            }
            (Err(broken), _) => {
                eprintln!("{broken}");
                return ExitCode::FAILURE;
            }
        }
    }
    println!("{count} seeds from {from}: all ended, and each went twice the same way\n{counts}");
    let rare = if width == Width::Wide { counts.rare(count) } else { Vec::new() };
    if rare.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("hardly exercised: {}", rare.join(", "));
    ExitCode::FAILURE
}

fn simulate(seed: u64, width: Width) -> Result<Report, String> {
    let run = std::panic::catch_unwind(|| simulation::simulate(seed, width));
    run.unwrap_or_else(|_panic| Err(format!("seed {seed}: it panicked")))
}

/// Parsed arguments: the first seed, the number of seeds and the width of the simulation.
struct Arguments {
    from: u64,
    count: u64,
    width: Width,
}

fn arguments() -> Option<Arguments> {
    let mut found = Arguments { from: 0, count: 1_000, width: Width::Wide };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--seeds" => found.count = words.next()?.parse().ok()?,
            "--from" => found.from = words.next()?.parse().ok()?,
            "--first-world" => found.width = Width::First,
            _ => return None,
        }
    }
    Some(found)
}
