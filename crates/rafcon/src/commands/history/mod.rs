//! `rafcon history` and `rafcon log`: events of a run, filtered.

mod words;

use super::kept::{nanos, open, out, paint};
use super::kept_at_server::Keeper;
use crate::cli;
use crate::environment::Environment;
use crate::view::log_lines;
use anyhow::Result;
use rafcon_protocol::{Event, LogLevel, without_values};
use rafcon_storage::journal::{Filter, Found};
use serde::Serialize;
use std::collections::VecDeque;
use std::io::Write as _;
use std::process::ExitCode;

/// Prints the selected events.
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

/// Prints the selected lines of the log.
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

/// Prints each result as the lines of `shown`.
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

/// An event as a line of JSON; without `values`, inputs and outputs of states are left out, and errors are short.
fn json(found: &Found, values: bool) -> Vec<String> {
    let mut event = found.event.clone();
    if !values {
        without_values(&mut event);
    }
    let line = Numbered { sequence: found.sequence, t_ns: found.t_ns, event: &event };
    serde_json::to_string(&line).into_iter().collect()
}

/// An event with its number and time.
#[derive(Debug, Serialize)]
struct Numbered<'e> {
    sequence: u64,
    t_ns: u64,
    event: &'e Event,
}

/// Shows the results of `find`; with `last`, only this many of the last. Returns the damage that `find` reports.
fn each_found(
    find: impl FnOnce(&mut dyn FnMut(Found) -> Result<()>) -> Result<Result<()>>,
    last: Option<usize>,
    mut show: impl FnMut(&Found) -> Result<()>,
) -> Result<Result<()>> {
    let Some(count) = last else { return find(&mut |found| show(&found)) };
    let mut found_last = VecDeque::new();
    let whole = find(&mut |found| {
        found_last.push_back(found);
        if found_last.len() > count {
            found_last.pop_front();
        }
        Ok(())
    })?;
    found_last.iter().try_for_each(show)?;
    Ok(whole)
}
