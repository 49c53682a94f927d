//! Events that people should read about besides the log, in words: the same in a live picture and in plain lines.

use rafcon_protocol::{Event, HeldBy, LogLevel};

/// The state that it is about (empty for the run), how much it matters, and the words; nothing about other events.
pub(super) fn words(event: &Event) -> Option<(&str, LogLevel, String)> {
    Some(match event {
        Event::Waiting { path, reason } => (path, LogLevel::Warning, format!("waiting: {reason}")),
        Event::Hit { breakpoint, path, held: true, .. } => {
            (path, LogLevel::Warning, format!("breakpoint {breakpoint}"))
        }
        Event::Held { path, by: HeldBy::RunTo, .. } => {
            (path, LogLevel::Info, "run to here".to_owned())
        }
        Event::Forced { path, outcome } => {
            (path, LogLevel::Warning, format!("ended by hand: {}", outcome.name))
        }
        Event::DeadlinePassed { path, deadline_ms } => (
            path,
            LogLevel::Warning,
            format!("its deadline of {deadline_ms} ms is over; it is preempted"),
        ),
        Event::CutOff { path, grace_ms } => (
            path,
            LogLevel::Error,
            format!("did not end within {grace_ms} ms; its runner is ended"),
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
        Event::Paused { paused: false } => (LogLevel::Info, "goes on".to_owned()),
        Event::Stopping => (LogLevel::Info, "stopping".to_owned()),
        Event::Resumed { life, crash, .. } => (
            LogLevel::Warning,
            format!("taken up by runner {life} after a crash: {}", crash.reason),
        ),
        _ => return None,
    })
}
