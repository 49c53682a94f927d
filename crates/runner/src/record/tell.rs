//! Maps events of the engine to those of the protocol. This module knows both formats, but no listeners.

use rafcon_engine::{Datum, Engine, Event, HeldBy, Level, Note, PathId, WaitReason};
use rafcon_model::{Loss, OutcomeId};
use rafcon_protocol as protocol;
use rafcon_protocol::{LogLevel, Stream};
use rafcon_storage::journal::{PlaceNumber, Record};

/// An error with its causes, on one line.
pub fn reason(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(source) = cause {
        text = format!("{text}: {source}");
        cause = source.source();
    }
    text
}

/// A line that reports a defect of this program.
pub(crate) fn defect(what: &str) -> Record {
    log(String::new(), LogLevel::Error, format!("a defect of RAFCON, please report it: {what}"))
}

/// A line from the engine itself.
pub(crate) fn log(path: String, level: LogLevel, message: String) -> Record {
    let stream = Stream::Engine;
    if path.is_empty() {
        Record::Log { place: None, level, stream, message }
    } else {
        told(protocol::Event::Log { path, level, stream, message })
    }
}

/// The record of a protocol event.
pub(crate) fn told(event: protocol::Event) -> Record {
    Record::Told(Box::new(event))
}

/// The record of an event without values.
pub(crate) fn rare<D: Datum>(event: &Event<D>, engine: &Engine<D>) -> Option<Record> {
    Some(match event {
        Event::Waiting { path, reason } => told(protocol::Event::Waiting {
            path: engine.path_text(*path).to_string(),
            reason: waiting(reason, engine),
        }),
        Event::Paused(paused) => told(protocol::Event::Paused { paused: *paused }),
        Event::Stopping => told(protocol::Event::Stopping),
        Event::Held { path, next, by } => told(protocol::Event::Held {
            path: engine.path_text(*path).to_string(),
            next: next.map(|next| engine.path_text(next).to_string()),
            by: held_by(*by),
        }),
        Event::Hit { breakpoint, path, hits, held } => told(protocol::Event::Hit {
            breakpoint: *breakpoint,
            path: engine.path_text(*path).to_string(),
            hits: *hits,
            held: *held,
        }),
        Event::Forced { path, outcome } => told(protocol::Event::Forced {
            path: engine.path_text(*path).to_string(),
            outcome: protocol::Outcome {
                id: outcome.0,
                name: outcome_name(*path, *outcome, engine).unwrap_or_default(),
            },
        }),
        Event::LossRecovery { path, loss } => told(protocol::Event::LossRecovery {
            path: engine.path_text(*path).to_string(),
            loss: loss_in_protocol(*loss),
        }),
        Event::Dropped { path } => {
            told(protocol::Event::Dropped { path: engine.path_text(*path).to_string() })
        }
        Event::Entered { .. }
        | Event::Left { .. }
        | Event::Scoped { .. }
        | Event::Note { .. }
        | Event::Changed
        | Event::ChangeWaits { .. }
        | Event::Finished { .. } => {
            return None;
        }
    })
}

/// The line of a note about the state at `place`.
pub(crate) fn note(place: PlaceNumber, level: Level, note: &Note) -> Record {
    let (level, message) = (log_level(level), text(note));
    Record::Log { place: Some(place), level, stream: Stream::Engine, message }
}

fn log_level(level: Level) -> LogLevel {
    match level {
        Level::Warning => LogLevel::Warning,
        Level::Error => LogLevel::Error,
    }
}

fn waiting<D: Datum>(reason: &WaitReason, engine: &Engine<D>) -> String {
    match reason {
        WaitReason::NoTransition { child, outcome } => format!(
            "the outcome {} of {} leads nowhere: connect it, or stop the run",
            outcome_text(*child, *outcome, engine),
            name_text(*child, engine)
        ),
        WaitReason::Interrupted => {
            "its script was interrupted by a crash: decide whether it aborts or runs again, or force an outcome"
                .to_owned()
        }
        WaitReason::NoStart => {
            "there is no start state: connect the income, or stop the run".to_owned()
        }
        WaitReason::NoChildren => {
            "a preemptive concurrency state without children never ends: add one, or stop the run"
                .to_owned()
        }
    }
}

/// The missing condition of a waiting state, to follow "waits for".
pub(crate) fn awaited<D: Datum>(reason: &WaitReason, engine: &Engine<D>) -> String {
    match reason {
        WaitReason::NoTransition { child, outcome } => format!(
            "a transition from the outcome {} of {}",
            outcome_text(*child, *outcome, engine),
            name_text(*child, engine)
        ),
        WaitReason::NoStart => "a start state".to_owned(),
        WaitReason::NoChildren => "a child".to_owned(),
        WaitReason::Interrupted => "a decision: a crash interrupted its script".to_owned(),
    }
}

/// The user's name of a state, or its path after its removal.
fn name_text<D: Datum>(path: PathId, engine: &Engine<D>) -> String {
    let node = engine.path_node(path).map(|node| engine.program().node(node));
    node.map_or_else(|| engine.path_text(path).to_string(), |node| format!("\"{}\"", node.name()))
}

fn outcome_text<D: Datum>(path: PathId, outcome: OutcomeId, engine: &Engine<D>) -> String {
    let name = outcome_name(path, outcome, engine);
    name.map_or_else(|| outcome.to_string(), |name| format!("\"{name}\""))
}

fn outcome_name<D: Datum>(path: PathId, outcome: OutcomeId, engine: &Engine<D>) -> Option<String> {
    let node = engine.path_node(path).map(|node| engine.program().node(node))?;
    Some(node.outcome(outcome)?.name.to_string())
}

pub(crate) fn held_by(by: HeldBy) -> protocol::HeldBy {
    match by {
        HeldBy::Pause => protocol::HeldBy::Pause,
        HeldBy::Step => protocol::HeldBy::Step,
        HeldBy::RunTo => protocol::HeldBy::RunTo,
        HeldBy::Breakpoint(id) => protocol::HeldBy::Breakpoint { id },
        HeldBy::Start => protocol::HeldBy::Start,
        HeldBy::Loss(loss) => protocol::HeldBy::Loss { loss: loss_in_protocol(loss) },
    }
}

fn loss_in_protocol(loss: Loss) -> protocol::Loss {
    match loss {
        Loss::Link => protocol::Loss::Link,
        Loss::Command => protocol::Loss::Command,
    }
}

fn text(note: &Note) -> String {
    match note {
        Note::TypeMismatch { port, expected, found } => format!(
            "\"{port}\" got a value of type {found} but declares {expected}; the value is passed on anyway"
        ),
        Note::NoSuchOutcome { returned } => format!(
            "the script returned {returned}, which is neither the id nor the name of an outcome; the state aborts"
        ),
        Note::NoSuchGlobal { name } => {
            format!("there is no global variable \"{name}\"; None is used instead")
        }
        Note::BadDefault { port, reason } => {
            format!("the default of \"{port}\" cannot be used: {reason}; None is used instead")
        }
        Note::MissingLibrary { reason } => {
            format!("the library is missing: {reason}; the state aborts")
        }
        Note::DamagedState { reason } => {
            format!("the state cannot be read: {reason}; it aborts before it does anything")
        }
        Note::BadCondition { breakpoint, reason } => format!(
            "the condition of breakpoint {breakpoint} cannot be evaluated ({reason}); it holds as if the condition were true"
        ),
        Note::NoSuchInput { name } => {
            format!("the root state has no input port \"{name}\"; its start value is ignored")
        }
    }
}
