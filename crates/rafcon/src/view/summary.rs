//! The last words about a run, the same below a live picture and in plain lines.

use super::text::{Style, TextLine, counted, harmless, time};
use super::value;
use rafcon_protocol::{Event, Outcome};
use std::time::Duration;

/// Lines about an [`Event::Finished`]; none about other events.
pub(super) fn lines(machine: &str, after: Duration, event: &Event) -> Vec<TextLine> {
    let Event::Finished { outcome, outputs, states_run, .. } = event else { return Vec::new() };
    let facts = format!(" after {}, {} run", time(after), counted(*states_run, "state"));
    let mut lines = vec![
        TextLine::of(Style::Strong, harmless(machine))
            .and(Style::Plain, " ended by ")
            .and(style(outcome), format!("{} ({})", harmless(&outcome.name), outcome.id))
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

/// How good an outcome is.
pub(crate) fn style(outcome: &Outcome) -> Style {
    match outcome.id {
        0 => Style::Good,
        -1 => Style::Bad,
        _ => Style::Warning,
    }
}
