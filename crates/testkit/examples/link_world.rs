//! Runs robots and stations in virtual worlds: `cargo run -p rafcon-testkit --example link_world -- --seeds 100 [--from 0] [--json]`.
//!
//! Every tenth seed is one of servers that die again and again. Prints the first broken promise and ends with 1; else prints the
//! gate's table, and ends with 1 if a bar is missed.

use rafcon_testkit::link_world::{Figure, Measures, Scenario, run, run_watched};
use std::process::ExitCode;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "this is a command-line program")]
fn main() -> ExitCode {
    let Some(Arguments { from, count, json }) = arguments() else {
        eprintln!("usage: link_world [--seeds NUMBER] [--from SEED] [--json]");
        return ExitCode::from(2);
    };
    let mut measures = Measures::default();
    for seed in from..from.saturating_add(count) {
        match measure(seed) {
            Ok(one) => measures.add(&one),
            Err(broken) => {
                eprintln!("{broken}");
                return ExitCode::FAILURE;
            }
        }
    }
    let figures = measures.figures();
    for Figure { name, value, unit, bar } in &figures {
        if json {
            println!(
                r#"{{"name": "{name}", "value": {value:.3}, "unit": "{unit}", "bar": {bar:.3}}}"#
            );
        } else {
            let missed = if value > bar { "  MISSED" } else { "" };
            println!("{name:28} {value:10.3} {unit:5} at most {bar:9.3}{missed}");
        }
    }
    if !json {
        println!("of the bytes for each event, and how many datagrams:");
        for (kind, bytes) in measures.breakdown() {
            println!("  {kind:26} {bytes:10.3}");
        }
        let Measures { kills, commands, events, .. } = measures;
        println!("{count} seeds from {from}: {kills} kills, {commands} commands, {events} events");
    }
    let is_met = figures.iter().all(|figure| figure.value <= figure.bar);
    if is_met { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Every tenth mission is also run with one operator who watches it, and with five.
fn measure(seed: u64) -> Result<Measures, String> {
    let scenario = if seed % 10 == 9 { Scenario::Kills } else { Scenario::SpaceBotCamp };
    let measures = run(seed, scenario)?;
    let watched = if seed.is_multiple_of(10) {
        [run_watched(seed, 1)?, run_watched(seed, 5)?]
    } else {
        [0; 2]
    };
    Ok(Measures { watched, ..measures })
}

struct Arguments {
    from: u64,
    count: u64,
    json: bool,
}

fn arguments() -> Option<Arguments> {
    let mut found = Arguments { from: 0, count: 100, json: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--seeds" => found.count = words.next()?.parse().ok()?,
            "--from" => found.from = words.next()?.parse().ok()?,
            "--json" => found.json = true,
            _ => return None,
        }
    }
    Some(found)
}
