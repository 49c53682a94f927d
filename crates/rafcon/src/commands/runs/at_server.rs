//! The runs of a server.

use super::{diverged, ended, facts, head};
use crate::cli;
use crate::client::Server;
use crate::commands::kept::{out, paint};
use crate::commands::remote::{refuse, refuse_runs};
use crate::environment::Environment;
use crate::view::{Style, TextLine, counted, harmless, time};
use anyhow::Result;
use rafcon_protocol::api::{RunPhase, RunSummary, RunWait};
use rafcon_supervisor::clock;
use std::io::Write as _;
use std::process::ExitCode;
use std::time::Duration;

/// Lists them, the newest last. The exit code is 1 if one cannot be read.
pub(super) fn runs(
    raw: &cli::ListRuns,
    server: &Server,
    environment: &Environment,
) -> Result<ExitCode> {
    refuse_runs(&raw.runs, environment)?;
    refuse(raw.prune, "--prune", "the server's administrator decides which runs it keeps")?;
    let mut found = server.runs()?;
    found.sort_by(|a, b| a.id.cmp(&b.id));
    let mut out = out();
    let width = found.iter().map(|run| run.id.chars().count()).max().unwrap_or(0);
    for run in &found {
        if raw.json {
            writeln!(out, "{}", serde_json::to_string(run)?)?;
        } else {
            writeln!(out, "{}", line(run, width).render(paint(environment)))?;
        }
    }
    if found.is_empty() && !raw.json {
        writeln!(out, "no runs at {}", server.address)?;
    }
    out.flush()?;
    let is_unreadable = |run: &RunSummary| matches!(run.phase, RunPhase::Unreadable { .. });
    Ok(ExitCode::from(u8::from(found.iter().any(is_unreadable))))
}

fn line(run: &RunSummary, width: usize) -> TextLine {
    let line = head(&run.id, &run.name, width);
    let facts = facts(run.length_ms, run.events, run.bytes);
    match &run.phase {
        RunPhase::Starting => line.and(Style::Good, "starting"),
        RunPhase::Live => live(line, run),
        RunPhase::Finished { outcome, .. } => ended(line, outcome, facts),
        RunPhase::Crashed => line.and(Style::Bad, "crashed").and(Style::Dim, facts),
        RunPhase::Diverged { reason } => diverged(line, reason),
        RunPhase::NotStarted { reason } => {
            line.and(Style::Bad, "did not start: ").and(Style::Plain, harmless(reason))
        }
        RunPhase::Unreadable { reason } => {
            line.and(Style::Bad, "unreadable: ").and(Style::Plain, harmless(reason))
        }
    }
}

/// Status and length of an active run. Its size on disk is unknown until it ends.
fn live(line: TextLine, run: &RunSummary) -> TextLine {
    let line = match run.waits {
        None => line.and(Style::Good, "running"),
        Some(RunWait::Answer) => line.and(Style::Warning, "waits for an answer"),
        Some(RunWait::Decision) => line.and(Style::Warning, "waits for a decision after a crash"),
        Some(RunWait::Paused) => line.and(Style::Plain, "paused"),
        Some(RunWait::Other) => line.and(Style::Plain, "waiting"),
    };
    let length = time(Duration::from_millis(run.length_ms));
    let line = line.and(Style::Dim, format!(" after {length}, {}", counted(run.events, "event")));
    match run.unheard_since_ms {
        None => line,
        Some(heard_ms) => {
            let ago = Duration::from_millis(clock::since_1970_ms().saturating_sub(heard_ms));
            line.and(Style::Warning, format!(", no signal for {}", time(ago)))
        }
    }
}
