//! Runs random machines in random orders: `cargo run -p rafcon-engine --example simulate -- --seeds 10000 [--from 0]`.
//!
//! Prints the first broken promise with its seed and machine and ends with 1; prints a summary and ends with 0 otherwise.

mod machine;
mod random;
mod world;

use std::process::ExitCode;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "this is a command-line program")]
fn main() -> ExitCode {
    let Some((from, count)) = arguments() else {
        eprintln!("usage: simulate [--seeds NUMBER] [--from SEED]");
        return ExitCode::from(2);
    };
    let (mut states, mut by_itself) = (0, 0);
    for seed in from..from.saturating_add(count) {
        match world::simulate(seed) {
            Ok(report) => {
                states += report.states;
                by_itself += u64::from(report.by_itself);
            }
            Err(broken) => {
                eprintln!("{broken}");
                return ExitCode::FAILURE;
            }
        }
    }
    println!("{count} seeds: all ended, {by_itself} by themselves, {states} states run");
    ExitCode::SUCCESS
}

/// The first seed and how many.
fn arguments() -> Option<(u64, u64)> {
    let (mut from, mut count) = (0, 1_000);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let number = words.next()?.parse().ok()?;
        match word.as_str() {
            "--seeds" => count = number,
            "--from" => from = number,
            _ => return None,
        }
    }
    Some((from, count))
}
