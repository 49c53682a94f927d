//! A moment as lines: the active states as a tree, each with its data. Knows pictures of moments, not journals.

use crate::commands::kept::span;
use crate::view::{Style, TextLine, counted, harmless, outcome_style, shown, time};
use rafcon_protocol::api::{Moment, MomentEnd, MomentState};
use rafcon_protocol::{RunStatus, Values};
use serde_json::Value;
use std::time::Duration;

/// The whole moment; `last` is the number of the run's last event.
pub(super) fn lines(machine: &str, picture: &Moment, last: u64) -> Vec<TextLine> {
    let mut lines = vec![head(machine, picture, last)];
    for state in &picture.active {
        lines.extend(of_state(state, picture));
    }
    lines.extend(picture.questions.iter().map(|question| {
        let text = format!("asks: {} (question {})", question.message, question.id);
        TextLine::of(Style::Warning, harmless(&format!("{} {text}", question.path)))
    }));
    lines.extend(section("global", &picture.globals));
    lines.extend(section("remembered by", &picture.persistent));
    lines.extend(picture.breakpoints.iter().map(|breakpoint| {
        let off = if breakpoint.enabled { "" } else { " (disabled)" };
        let text = format!("breakpoint {} at {}{off}", breakpoint.id, breakpoint.path);
        TextLine::of(Style::Plain, harmless(&text))
    }));
    lines
}

fn head(machine: &str, picture: &Moment, last: u64) -> TextLine {
    let at = format!(" at event {} of {last}, ", picture.sequence);
    let after = time(Duration::from_nanos(picture.t_ns));
    let run = counted(picture.states_run, "state");
    let line = TextLine::of(Style::Strong, harmless(machine))
        .and(Style::Plain, at)
        .and(Style::Dim, format!("{after} after the start, {run} run; "));
    match (&picture.outcome, picture.status) {
        (Some(outcome), _) => line
            .and(Style::Plain, "ended with ")
            .and(outcome_style(outcome), format!("{} ({})", harmless(&outcome.name), outcome.id)),
        (None, RunStatus::Running) => line.and(Style::Good, "running"),
        (None, RunStatus::Paused) => line.and(Style::Warning, "paused"),
        (None, RunStatus::Stepping) => line.and(Style::Warning, "step by step"),
        (None, RunStatus::Stopping) => line.and(Style::Warning, "stopping"),
        (None, RunStatus::Finished) => line.and(Style::Plain, "ended"),
    }
}

fn of_state(state: &MomentState, picture: &Moment) -> Vec<TextLine> {
    let indent = "  ".repeat(state.depth);
    let name = state.names.rsplit('/').next().unwrap_or_default();
    let since = Duration::from_nanos(picture.t_ns.saturating_sub(state.since_ns));
    let facts = format!("  for {} (event {})", span(since), state.entered);
    let mut head = TextLine::of(Style::Plain, indent.clone())
        .and(Style::Strong, harmless(name))
        .and(Style::Dim, facts);
    if let Some(reason) = picture.waiting.get(&state.path) {
        head = head.and(Style::Warning, harmless(&format!("  waits: {reason}")));
    }
    for held in picture.held.iter().filter(|held| held.path == state.path) {
        let next = held.next.as_deref().unwrap_or_default();
        let next = next.rsplit('/').next().unwrap_or_default();
        head = head.and(Style::Warning, harmless(&format!("  paused before {next}")));
    }
    let mut lines = vec![head];
    match &state.inputs {
        Some(inputs) => lines.extend(values(&indent, "input", inputs)),
        None => lines.push(TextLine::of(Style::Dim, format!("{indent}  inputs not recorded"))),
    }
    lines.extend(values(&indent, "scoped", &state.scoped));
    lines.extend(state.ended.iter().map(|end| of_end(&indent, end)));
    lines
}

fn of_end(indent: &str, end: &MomentEnd) -> TextLine {
    let name = end.names.rsplit('/').next().unwrap_or_default();
    let line = TextLine::of(Style::Dim, format!("{indent}  {} ended with ", harmless(name)))
        .and(outcome_style(&end.outcome), harmless(&end.outcome.name))
        .and(Style::Dim, format!(" (event {})", end.sequence));
    let outputs = end.outputs.iter().flatten().map(|(name, value)| set(name, value));
    let outputs = outputs.collect::<Vec<_>>().join(", ");
    let gap = if outputs.is_empty() { "" } else { ": " };
    let line = line.and(Style::Plain, format!("{gap}{outputs}"));
    match &end.error {
        Some(error) => line.and(Style::Bad, format!(", {}", harmless(&shown(error)))),
        None => line,
    }
}

fn values(indent: &str, kind: &str, values: &Values) -> Vec<TextLine> {
    let line = |(name, value): (&String, &Value)| {
        TextLine::of(Style::Dim, format!("{indent}  {kind} ")).and(Style::Plain, set(name, value))
    };
    values.iter().map(line).collect()
}

fn section(kind: &str, of: &Values) -> Vec<TextLine> {
    let line = |(name, value): (&String, &Value)| {
        TextLine::of(Style::Dim, format!("{kind} ")).and(Style::Plain, set(name, value))
    };
    of.iter().map(line).collect()
}

fn set(name: &str, value: &Value) -> String {
    format!("{} = {}", harmless(name), harmless(&shown(value)))
}
