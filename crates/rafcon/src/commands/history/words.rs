//! Events as text, one line each. Knows the terms for people, but not the source of events.

use crate::commands::kept::span;
use crate::view::{Style, TextLine, harmless, outcome_style, shown};
use rafcon_protocol::{
    Answer, Breakpoint, Closing, Command, Event, HeldBy, LogLevel, Loss, OnCrash, Outcome, Values,
    When,
};
use rafcon_storage::journal::Found;
use serde_json::Value;

/// The lines of an event: its number, time, state and description.
pub(super) fn lines(found: &Found, values: bool) -> Vec<TextLine> {
    let head = format!("{:>7} {:9.3}  ", found.sequence, found.time().as_secs_f64());
    let below = " ".repeat(head.len());
    let gap = if found.names.is_empty() { "" } else { "  " };
    let head = TextLine::of(Style::Dim, head)
        .and(Style::Strong, format!("{}{gap}", harmless(&found.names)));
    let Event::Log { level, message, .. } = &found.event else {
        return vec![head.followed_by(what(found, values))];
    };
    let style = level_style(*level);
    let mut text = message.lines();
    let first = head.and(style, harmless(text.next().unwrap_or_default()));
    let rest = text.map(|text| TextLine::of(style, format!("{below}{}", harmless(text))));
    std::iter::once(first).chain(rest).collect()
}

fn what(found: &Found, values: bool) -> TextLine {
    match &found.event {
        Event::Entered { inputs, undoes, .. } => {
            let text = if undoes.is_some() { "entered backwards" } else { "entered" };
            TextLine::of(Style::Dim, text).followed_by(with(inputs.as_ref().filter(|_| values)))
        }
        Event::Left { outcome, outputs, error, undoes, .. } => {
            let text = if undoes.is_some() { "left backwards" } else { "ended with " };
            let line = TextLine::of(Style::Dim, text);
            let line = if undoes.is_some() { line } else { line.followed_by(named(outcome)) };
            let after = found.lasted.map(|lasted| format!(" after {}", span(lasted)));
            let line = line.and(Style::Dim, after.unwrap_or_default());
            let line = line.followed_by(with(outputs.as_ref().filter(|_| values)));
            match error {
                Some(error) => line.and(Style::Bad, format!(", {}", value(error))),
                None => line,
            }
        }
        Event::Scoped { name, value: v, .. } => TextLine::of(Style::Plain, set(name, v)),
        Event::Global { name, value: Some(v) } => {
            TextLine::of(Style::Plain, format!("global {}", set(name, v)))
        }
        Event::Global { name, value: None } => {
            TextLine::of(Style::Plain, format!("global {} deleted", harmless(name)))
        }
        Event::Persistent { value: v, .. } => {
            TextLine::of(Style::Plain, format!("remembers {}", value(v)))
        }
        Event::Finished { outcome, outputs, .. } => {
            TextLine::of(Style::Plain, "the run ended with ")
                .followed_by(named(outcome))
                .followed_by(with(Some(outputs).filter(|_| values)))
        }
        Event::Held { by, .. } => {
            let before = found.next.as_ref().map(|next| format!(" before {}", harmless(next)));
            let text = format!("paused{}{}", before.unwrap_or_default(), reason_of_hold(*by));
            TextLine::of(Style::Warning, text)
        }
        other => rest(other),
    }
}

/// Text of the less frequent events.
fn rest(event: &Event) -> TextLine {
    let (style, text) = match event {
        Event::Hit { breakpoint, hits, held, .. } => {
            let held = if *held { "" } else { ", without a pause" };
            (
                Style::Warning,
                format!("breakpoint {breakpoint} passed, {hits} times until now{held}"),
            )
        }
        Event::BreakpointSet { breakpoint } => (Style::Plain, set_breakpoint(breakpoint)),
        Event::BreakpointRemoved { id } => (Style::Plain, format!("breakpoint {id} removed")),
        Event::Forced { outcome, .. } => {
            (Style::Warning, format!("ended by a command with outcome {}", outcome.name))
        }
        Event::Dropped { .. } => {
            (Style::Warning, "dropped: the run starts at another state".to_owned())
        }
        Event::WentBack { sequence } => {
            (Style::Warning, format!("the run restarts at event {sequence}"))
        }
        Event::Root { hash, change } if change.is_empty() => {
            (Style::Dim, format!("the machine is {}", short(hash)))
        }
        Event::Root { hash, change } => {
            (Style::Plain, format!("the machine is {} from now on: {change}", short(hash)))
        }
        Event::ChangeWaits { change, .. } => {
            (Style::Warning, format!("a change takes effect when the state ends: {change}"))
        }
        Event::Asked { question } => (Style::Plain, format!("asks: {}", question.message)),
        Event::Waiting { reason, .. } => (Style::Warning, format!("waiting: {reason}")),
        Event::DeadlinePassed { deadline_ms, .. } => {
            (Style::Bad, format!("missed its deadline of {deadline_ms} ms"))
        }
        Event::LossRecovery { loss, .. } => {
            (Style::Bad, format!("preempted, {}", reason_of_loss(*loss)))
        }
        Event::CutOff { grace_ms, .. } => {
            (Style::Bad, format!("did not end within {grace_ms} ms; the script was cut off"))
        }
        Event::Paused { paused: true } => (Style::Warning, "paused".to_owned()),
        Event::Paused { paused: false } => (Style::Plain, "continues".to_owned()),
        Event::Stopping => (Style::Warning, "stopping".to_owned()),
        other => of_the_run(other),
    };
    TextLine::of(style, harmless(&text))
}

/// Text of events of the whole run.
fn of_the_run(event: &Event) -> (Style, String) {
    match event {
        Event::Commanded { envelope, answer } => {
            let command = asked_for(&envelope.command);
            let author =
                if envelope.author.is_empty() { "an unknown user" } else { &envelope.author };
            let (style, answer) = match answer {
                Answer::Applied => (Style::Plain, String::new()),
                Answer::Refused { reason } => (Style::Warning, format!(", refused: {reason}")),
                Answer::Expired => (Style::Warning, ", too late".to_owned()),
                Answer::Unknown { reason } => (Style::Warning, format!(", fate unknown: {reason}")),
            };
            let epoch =
                envelope.epoch.map_or_else(String::new, |epoch| format!(" (epoch {epoch})"));
            (style, format!("{author} gave the command {command}{epoch}{answer}"))
        }
        Event::Closed { id, how, answer, author } => {
            let answer = answer.as_ref().map(value).unwrap_or_default();
            let text = match how {
                Closing::Answered => format!("question {id} answered by {author}: {answer}"),
                Closing::TimedOut => format!("question {id} timed out: {answer}"),
                Closing::Withdrawn => format!("question {id} withdrawn"),
            };
            (Style::Plain, text)
        }
        Event::Resumed { life, crash, policy } => {
            let policy = match policy {
                OnCrash::Ask => "wait for a decision",
                OnCrash::Abort => "are aborted",
                OnCrash::Restart => "run again",
            };
            let reason = &crash.reason;
            let text = format!("resumed by runner {life}: {reason}; interrupted scripts {policy}");
            (Style::Warning, text)
        }
        Event::Silence { link_ms: 0, command_ms: 0 } => {
            (Style::Plain, "signals from the ground are received".to_owned())
        }
        Event::Silence { link_ms, command_ms } => {
            let text = format!(
                "no signal from the ground for {link_ms} ms, no command for {command_ms} ms"
            );
            (Style::Warning, text)
        }
        Event::Damaged { what, .. } => (Style::Bad, format!("damaged: {what}")),
        Event::Thinned { before } => {
            (Style::Dim, format!("details before event {before} were deleted"))
        }
        other => (Style::Plain, serde_json::to_string(other).unwrap_or_default()),
    }
}

/// A command in the syntax of `rafcon tell`.
fn asked_for(command: &Command) -> String {
    let Ok(Value::Object(mut fields)) = serde_json::to_value(command) else {
        return String::new();
    };
    let name = fields.remove("type").unwrap_or_default();
    let fields = fields.iter().filter(|(_, value)| !value.is_null());
    let name = name.as_str().unwrap_or_default().to_owned();
    fields.fold(name, |words, (field, v)| words + " " + field + "=" + &value(v))
}

fn reason_of_hold(by: HeldBy) -> String {
    match by {
        HeldBy::Pause => String::new(),
        HeldBy::Step => ", step finished".to_owned(),
        HeldBy::RunTo => ", target state reached".to_owned(),
        HeldBy::Breakpoint { id } => format!(", breakpoint {id}"),
        HeldBy::Start => ", start of the run".to_owned(),
        HeldBy::Loss { loss } => format!(", {}", reason_of_loss(loss)),
    }
}

fn reason_of_loss(loss: Loss) -> &'static str {
    match loss {
        Loss::Link => "no signal from the ground",
        Loss::Command => "no command received",
    }
}

fn set_breakpoint(breakpoint: &Breakpoint) -> String {
    let when = match breakpoint.when {
        When::Before => "before",
        When::After => "after",
    };
    let condition = breakpoint.condition.as_ref().map(|text| format!(" if {text}"));
    let off = if breakpoint.enabled { "" } else { ", disabled" };
    format!("breakpoint {} {when} it{}{off}", breakpoint.id, condition.unwrap_or_default())
}

fn named(outcome: &Outcome) -> TextLine {
    TextLine::of(outcome_style(outcome), harmless(&outcome.name))
}

fn with(values: Option<&Values>) -> TextLine {
    let list: Vec<String> = values.into_iter().flatten().map(|(name, v)| set(name, v)).collect();
    if list.is_empty() {
        TextLine::default()
    } else {
        TextLine::of(Style::Plain, format!(": {}", list.join(", ")))
    }
}

fn set(name: &str, v: &Value) -> String {
    format!("{} = {}", harmless(name), value(v))
}

fn value(value: &Value) -> String {
    harmless(&shown(value))
}

fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}

fn level_style(level: LogLevel) -> Style {
    match level {
        LogLevel::Verbose | LogLevel::Debug => Style::Dim,
        LogLevel::Info => Style::Plain,
        LogLevel::Warning => Style::Warning,
        LogLevel::Error => Style::Bad,
    }
}
