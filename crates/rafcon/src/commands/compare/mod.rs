//! `rafcon compare`: the divergence of two runs, the data that differed before, and their times.

use super::kept::{find_run_in, open_folder, out, paint, runs_folder, span};
use super::kept_at_server::Keeper;
use crate::cli;
use crate::environment::Environment;
use crate::view::{Style, TextLine, counted, harmless, outcome_style, shown};
use anyhow::Result;
use rafcon_protocol::api::{Comparison, DataChange, Happened, Parting, TimeTaken, Timing};
use rafcon_storage::journal;
use serde_json::Value;
use std::io::Write as _;
use std::process::ExitCode;
use std::time::Duration;

/// Maximum number of differences in the text output.
const SHOWN: usize = 20;

/// Compares two runs; the exit code is 1 if they diverge.
pub(super) fn compare(raw: &cli::Compare, environment: &Environment) -> Result<ExitCode> {
    let (compared, ids) = match Keeper::named(&raw.remote, &raw.runs, environment)? {
        Some(keeper) => {
            let (one, other) = (keeper.run(&raw.one)?, keeper.run(&raw.other)?);
            (keeper.compare(&one, &other)?, [one.summary.id, other.summary.id])
        }
        None => here(raw, environment)?,
    };
    let mut out = out();
    if raw.json {
        writeln!(out, "{}", serde_json::to_string(&compared)?)?;
    } else {
        for line in lines(&compared, [&*ids[0], &*ids[1]]) {
            writeln!(out, "{}", line.render(paint(environment)))?;
        }
    }
    out.flush()?;
    Ok(ExitCode::from(u8::from(!compared.parted.is_empty())))
}

/// Compares two runs of this computer; also returns their ids.
fn here(raw: &cli::Compare, environment: &Environment) -> Result<(Comparison, [String; 2])> {
    let runs = runs_folder(&raw.runs, environment)?;
    let mut one = open_folder(&find_run_in(&runs, &raw.one)?)?;
    let mut other = open_folder(&find_run_in(&runs, &raw.other)?)?;
    let compared = journal::compare(&mut one, &mut other)?;
    one.check()?;
    other.check()?;
    Ok((compared, [&one, &other].map(|reader| reader.about().id.clone())))
}

fn lines(compared: &Comparison, ids: [&str; 2]) -> Vec<TextLine> {
    let [one, other] = ids.map(harmless);
    let mut lines = vec![TextLine::of(Style::Dim, format!("A is {one}, B is {other}"))];
    lines.extend(parting(compared));
    lines.extend(heading("different data", compared.changed.len()));
    lines.extend(compared.changed.iter().take(SHOWN).flat_map(change));
    let timing: Vec<&Timing> = compared.timing.iter().filter(|timing| differs(timing)).collect();
    lines.extend(heading("time in states, largest difference first", timing.len()));
    let width = timing.iter().take(SHOWN).map(|t| t.names.chars().count()).max().unwrap_or(0);
    lines.extend(timing.into_iter().take(SHOWN).map(|timing| of_state(timing, width)));
    lines
}

fn heading(text: &str, count: usize) -> Option<TextLine> {
    let more = if count > SHOWN { format!(" ({SHOWN} of {count})") } else { String::new() };
    (count > 0).then(|| TextLine::of(Style::Strong, format!("{text}{more}")))
}

fn parting(compared: &Comparison) -> Vec<TextLine> {
    let alike = format!("{} alike", counted(compared.alike, "step"));
    if compared.parted.is_empty() {
        return vec![TextLine::of(Style::Good, format!("the runs are equal: {alike}"))];
    }
    let branches =
        counted(compared.branches_parted as u64, "branch").replace("branchs", "branches");
    let head = TextLine::of(Style::Bad, "the runs diverge")
        .and(Style::Plain, format!(" on {branches}; {alike} before"));
    let shown = compared.parted.iter().take(SHOWN);
    let more = compared.branches_parted.saturating_sub(shown.len());
    let rest = (more > 0).then(|| TextLine::of(Style::Dim, format!("  and later on {more} more")));
    std::iter::once(head).chain(shown.flat_map(on_branch)).chain(rest).collect()
}

/// The difference on one branch. The name of the root branch is left out.
fn on_branch(parting: &Parting) -> impl Iterator<Item = TextLine> {
    let is_root = !parting.branch.contains('/');
    let head = TextLine::of(Style::Plain, "  on ").and(Style::Strong, harmless(&parting.names));
    let sides = [happened("A", parting.one.as_ref()), happened("B", parting.other.as_ref())];
    (!is_root).then_some(head).into_iter().chain(sides)
}

fn happened(run: &str, step: Option<&Happened>) -> TextLine {
    let head = TextLine::of(Style::Dim, format!("  {run}  "));
    let Some(step) = step else { return head.and(Style::Plain, "was over") };
    let backwards = if step.backwards { " backwards" } else { "" };
    let head = head.and(Style::Strong, harmless(&step.names));
    let line = match &step.outcome {
        None => head.and(Style::Plain, format!(" was entered{backwards}")),
        Some(outcome) => head
            .and(Style::Plain, format!(" ended{backwards} with "))
            .and(outcome_style(outcome), harmless(&outcome.name)),
    };
    let at = span(Duration::from_nanos(step.t_ns));
    line.and(Style::Dim, format!(" (event {}, after {at})", step.sequence))
}

fn change(change: &DataChange) -> [TextLine; 3] {
    let DataChange { names, kind, port, .. } = change;
    let gap = if port.is_empty() { "" } else { " " };
    let value = |run: &str, value: &Option<Value>, sequence: u64| {
        let text = value.as_ref().map_or_else(|| "nothing".to_owned(), shown);
        TextLine::of(Style::Dim, format!("    {run}  "))
            .and(Style::Plain, harmless(&text))
            .and(Style::Dim, format!(" (event {sequence})"))
    };
    [
        TextLine::of(
            Style::Plain,
            format!("  {}: {}{gap}{}", harmless(names), kind.word(), harmless(port)),
        ),
        value("A", &change.one, change.one_sequence),
        value("B", &change.other, change.other_sequence),
    ]
}

/// True if the shown figures differ.
fn differs(timing: &Timing) -> bool {
    (timing.one.count, shown_time(timing.one)) != (timing.other.count, shown_time(timing.other))
}

fn of_state(timing: &Timing, width: usize) -> TextLine {
    let gap = width - timing.names.chars().count();
    let text = format!("{:>18}  {:>18}", shown_time(timing.one), shown_time(timing.other));
    TextLine::of(Style::Plain, format!("  {}{:gap$}", harmless(&timing.names), ""))
        .and(Style::Dim, text)
}

fn shown_time(time: TimeTaken) -> String {
    let total = Duration::from_nanos(time.total_ns);
    format!("{}x {:.3} s", time.count, total.as_secs_f64())
}
