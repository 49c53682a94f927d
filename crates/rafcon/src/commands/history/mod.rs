//! `rafcon history` and `rafcon log`: what happened in a run, as far as it is wanted.

mod found;
mod words;

use super::kept::{nanos, open, out, paint};
use super::kept_at_server::Keeper;
use crate::cli;
use crate::environment::Environment;
use crate::view::log_lines;
use anyhow::Result;
use found::{each_found, json};
use rafcon_protocol::{Event, LogLevel};
use rafcon_storage::journal::{Filter, Found};
use std::io::Write as _;
use std::process::ExitCode;

/// Prints the events that are wanted.
pub(super) fn history(raw: &cli::History, environment: &Environment) -> Result<ExitCode> {
    let filter = Filter {
        state: raw.state.clone(),
        outcome: raw.outcome.clone(),
        text: raw.text.clone(),
        kinds: raw.kinds.clone(),
        level: None,
        from_ns: raw.from.map(nanos),
        to_ns: raw.to.map(nanos),
    };
    let paint = paint(environment);
    let text = |found: &Found| {
        let lines = words::lines(found, raw.values);
        lines.iter().map(|line| line.render(paint)).collect()
    };
    let json = |found: &Found| json(found, raw.values);
    print(&raw.run, &filter, raw.last, if raw.json { &json } else { &text }, environment)
}

/// Prints the lines of the log that are wanted.
pub(super) fn log(raw: &cli::Log, environment: &Environment) -> Result<ExitCode> {
    let filter = Filter {
        state: raw.state.clone(),
        kinds: vec!["log".to_owned()],
        level: Some(least(raw.level)),
        ..Filter::default()
    };
    let paint = paint(environment);
    let text = |found: &Found| match &found.event {
        Event::Log { level, message, .. } => {
            let lines = log_lines(found.time(), &found.names, *level, message);
            lines.iter().map(|line| line.render(paint)).collect()
        }
        Event::Damaged { .. } => {
            words::lines(found, false).iter().map(|line| line.render(paint)).collect()
        }
        _ => Vec::new(),
    };
    let json = |found: &Found| json(found, false);
    print(&raw.run, &filter, raw.last, if raw.json { &json } else { &text }, environment)
}

/// Prints what is found, each as the lines that `shown` gives.
fn print(
    run: &cli::KeptRun,
    filter: &Filter,
    last: Option<usize>,
    shown: &dyn Fn(&Found) -> Vec<String>,
    environment: &Environment,
) -> Result<ExitCode> {
    let mut out = out();
    let mut show = |found: &Found| -> Result<()> {
        for line in shown(found) {
            writeln!(out, "{line}")?;
        }
        Ok(())
    };
    let whole = if let Some(keeper) = Keeper::named(&run.remote, &run.runs, environment)? {
        let kept = keeper.run(&run.run)?;
        each_found(|show| kept.find(filter, show), last, &mut show)?
    } else {
        let mut reader = open(run, environment)?;
        each_found(|show| reader.find_all(filter, show).map(Ok), last, &mut show)?
            .and_then(|()| Ok(reader.check()?))
    };
    out.flush()?;
    whole.map(|()| ExitCode::SUCCESS)
}

fn least(level: cli::LogLevel) -> LogLevel {
    match level {
        cli::LogLevel::Verbose => LogLevel::Verbose,
        cli::LogLevel::Debug => LogLevel::Debug,
        cli::LogLevel::Info => LogLevel::Info,
        cli::LogLevel::Warning => LogLevel::Warning,
        cli::LogLevel::Error => LogLevel::Error,
    }
}
