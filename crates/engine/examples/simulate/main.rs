//! Runs random machines in random orders: `cargo run -p rafcon-engine --example simulate -- --seeds 10000 [--from 0]`.
//!
//! Each seed runs twice and must say the same, byte for byte. Prints the first broken promise with its seed, its machine and
//! what happened last, and ends with 1; prints what was exercised and ends with 0 otherwise, or with 1 if some of it
//! hardly was.

mod commands;
mod counts;
mod edits;
mod history;
mod machine;
mod places;
mod random;
mod twin;
mod watch;
mod world;

use counts::Counts;
use std::process::ExitCode;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "this is a command-line program")]
fn main() -> ExitCode {
    let Some((from, count)) = arguments() else {
        eprintln!("usage: simulate [--seeds NUMBER] [--from SEED]");
        return ExitCode::from(2);
    };
    let mut counts = Counts::default();
    for seed in from..from.saturating_add(count) {
        match (simulate(seed), simulate(seed)) {
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
    let rare = counts.rare(count);
    if rare.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("hardly exercised: {}", rare.join(", "));
    ExitCode::FAILURE
}

fn simulate(seed: u64) -> Result<world::Report, String> {
    let run = std::panic::catch_unwind(|| world::simulate(seed));
    run.unwrap_or_else(|_panic| Err(format!("seed {seed}: it panicked")))
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
