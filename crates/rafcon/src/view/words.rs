//! Texts about a run, common to the live picture and plain lines: notable events besides the log, and the summary of its
//! end.

use super::text::{Style, TextLine, counted, harmless, time};
use super::value;
use rafcon_protocol::{Event, HeldBy, LogLevel, Outcome};
use std::time::Duration;

/// Summary for an [`Event::Finished`]; empty for other events.
pub(super) fn summary(machine: &str, after: Duration, event: &Event) -> Vec<TextLine> {
    let Event::Finished { outcome, outputs, states_run, .. } = event else { return Vec::new() };
    let facts = format!(" after {}, {} run", time(after), counted(*states_run, "state"));
    let mut lines = vec![
        TextLine::of(Style::Strong, harmless(machine))
            .and(Style::Plain, " ended with ")
            .and(outcome_style(outcome), format!("{} ({})", harmless(&outcome.name), outcome.id))
            .and(Style::Dim, facts),
    ];
    let width = outputs.keys().map(|name| name.chars().count()).max().unwrap_or(0);
    lines.extend(outputs.iter().map(|(name, value)| {
        let style = if name == "error" { Style::Bad } else { Style::Plain };
        TextLine::of(Style::Dim, format!("  {:width$} = ", harmless(name)))
            .and(style, harmless(&value::shown(value)))
    }));
    lines
}

/// Style of an outcome by its severity.
pub(crate) fn outcome_style(outcome: &Outcome) -> Style {
    match outcome.id {
        0 => Style::Good,
        -1 => Style::Bad,
        _ => Style::Warning,
    }
}

/// State (empty for the run), severity and text of a notable event; `None` for other events.
pub(super) fn notable(event: &Event) -> Option<(&str, LogLevel, String)> {
    Some(match event {
        Event::Waiting { path, reason } => (path, LogLevel::Warning, format!("waiting: {reason}")),
        Event::Hit { breakpoint, path, held: true, .. } => {
            (path, LogLevel::Warning, format!("breakpoint {breakpoint}"))
        }
        Event::Held { path, by: HeldBy::RunTo, .. } => {
            (path, LogLevel::Info, "target state reached".to_owned())
        }
        Event::Forced { path, outcome } => {
            (path, LogLevel::Warning, format!("ended by a command with outcome {}", outcome.name))
        }
        Event::DeadlinePassed { path, deadline_ms } => (
            path,
            LogLevel::Warning,
            format!("missed its deadline of {deadline_ms} ms and is preempted"),
        ),
        Event::LossRecovery { path, .. } => {
            (path, LogLevel::Warning, "is preempted: the ground is silent".to_owned())
        }
        Event::Held { path, by: HeldBy::Loss { .. }, .. } => {
            (path, LogLevel::Warning, "paused: the ground is silent".to_owned())
        }
        Event::CutOff { path, grace_ms } => (
            path,
            LogLevel::Error,
            format!("did not end within {grace_ms} ms; the runner is killed"),
        ),
        Event::Asked { question } => {
            (&question.path, LogLevel::Warning, format!("asks: {}", question.message))
        }
        event => return of_the_run(event).map(|(level, words)| ("", level, words)),
    })
}

fn of_the_run(event: &Event) -> Option<(LogLevel, String)> {
    Some(match event {
        Event::Paused { paused: true } => (LogLevel::Info, "paused".to_owned()),
        Event::Paused { paused: false } => (LogLevel::Info, "continues".to_owned()),
        Event::Stopping => (LogLevel::Info, "stopping".to_owned()),
        Event::Resumed { life, crash, .. } => {
            (LogLevel::Warning, format!("resumed by runner {life} after a crash: {}", crash.reason))
        }
        _ => return None,
    })
}
