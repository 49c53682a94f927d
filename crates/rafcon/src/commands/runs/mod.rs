//! `rafcon runs`: lists runs and deletes old ones.

mod at_server;

use super::kept::{out, paint, runs_folder};
use super::remote;
use crate::cli;
use crate::environment::Environment;
use crate::view::{Style, TextLine, counted, harmless, outcome_style, size, time};
use anyhow::{Context as _, Result};
use rafcon_protocol::Outcome;
use rafcon_storage::journal::{self, Retention, RunState, Summary};
use rafcon_supervisor::{Runs, clock};
use std::io::Write as _;
use std::process::ExitCode;
use std::time::Duration;

/// Lists the runs, or deletes old ones.
pub(super) fn runs(raw: &cli::ListRuns, environment: &Environment) -> Result<ExitCode> {
    if let Some(server) = remote::server(&raw.remote, environment)? {
        return at_server::runs(raw, &server, environment);
    }
    let runs = runs_folder(&raw.runs, environment)?;
    if raw.prune {
        return prune(raw, &runs);
    }
    let found = journal::runs(runs.folder()).context("cannot list the runs")?;
    let mut out = out();
    if raw.json {
        for run in &found {
            writeln!(out, "{}", serde_json::to_string(run)?)?;
        }
        out.flush()?;
        return Ok(listed(&found));
    }
    if found.is_empty() {
        writeln!(out, "no runs in {}", runs.folder().display())?;
    }
    let width = found.iter().map(|run| run.id.chars().count()).max().unwrap_or(0);
    for run in &found {
        writeln!(out, "{}", line(run, width).render(paint(environment)))?;
    }
    out.flush()?;
    Ok(listed(&found))
}

/// Exit code: 1 if a run cannot be read.
fn listed(runs: &[Summary]) -> ExitCode {
    let is_unreadable = |run: &Summary| matches!(run.state, RunState::Unreadable { .. });
    ExitCode::from(u8::from(runs.iter().any(is_unreadable)))
}

fn prune(raw: &cli::ListRuns, runs: &Runs) -> Result<ExitCode> {
    let usual = Retention::default();
    let wanted = Retention {
        count: raw.keep.unwrap_or(usual.count),
        age: raw.max_age.or(usual.age),
        bytes: raw.max_size.unwrap_or(usual.bytes),
        ..usual
    };
    let pruned =
        wanted.prune(runs.folder(), clock::since_1970_ms()).context("cannot delete old runs")?;
    let mut out = out();
    for run in &pruned {
        writeln!(out, "deleted {}", run.id)?;
    }
    let bytes = pruned.iter().map(|run| run.bytes).sum();
    writeln!(out, "{} deleted, {} freed", counted(pruned.len() as u64, "run"), size(bytes))?;
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}

/// One run: id, machine, state, length and size.
fn line(run: &Summary, width: usize) -> TextLine {
    let line = head(&run.id, &run.name, width);
    let facts = facts(run.length_ms, run.events, run.bytes);
    match &run.state {
        // The process of a replica belongs to its station.
        RunState::Live { process: _ } if run.robot.is_some() => replica(line, run),
        RunState::NotReceived => {
            replica(line, run).and(Style::Bad, ", not received by a station now")
        }
        RunState::Live { process } => line
            .and(Style::Good, "running")
            .and(Style::Dim, format!(" in process {process}{facts}")),
        RunState::Finished { outcome, .. } => ended(line, outcome, facts),
        RunState::Crashed => line.and(Style::Bad, "crashed").and(Style::Dim, facts),
        RunState::Diverged { reason } => diverged(line, reason),
        RunState::Unreadable { reason } => {
            line.and(Style::Bad, "unreadable: ").and(Style::Plain, harmless(reason))
        }
    }
}

/// A replica whose run had not ended at its newest event.
fn replica(line: TextLine, run: &Summary) -> TextLine {
    let robot = harmless(run.robot.as_deref().unwrap_or_default());
    let now_ms = clock::since_1970_ms();
    let age = run.received_ms.map(|at| Duration::from_millis(now_ms.saturating_sub(at)));
    let age = age.map(|age| format!(", newest event arrived {} ago", time(age)));
    let facts = format!(", {}, {}", counted(run.events, "event"), size(run.bytes));
    line.and(Style::Good, "running")
        .and(Style::Plain, format!(" at {robot}{}", age.unwrap_or_default()))
        .and(Style::Dim, facts)
}

fn head(id: &str, name: &str, width: usize) -> TextLine {
    let gap = width + 2 - id.chars().count();
    TextLine::of(Style::Plain, format!("{}{:gap$}", harmless(id), ""))
        .and(Style::Strong, format!("{}  ", harmless(name)))
}

fn facts(length_ms: u64, events: u64, bytes: u64) -> String {
    let length = time(Duration::from_millis(length_ms));
    format!(" after {length}, {}, {}", counted(events, "event"), size(bytes))
}

fn diverged(line: TextLine, reason: &str) -> TextLine {
    line.and(Style::Bad, "diverged: ").and(Style::Plain, harmless(reason))
}

fn ended(line: TextLine, outcome: &Outcome, facts: String) -> TextLine {
    line.and(Style::Plain, "ended with ")
        .and(outcome_style(outcome), harmless(&outcome.name))
        .and(Style::Dim, facts)
}
