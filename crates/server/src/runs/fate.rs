//! How a runner ended, from what it left: whether a script was cut off, whether somebody killed it, what ran. Knows journals
//! and marks; decides nothing.

use super::launch::OUTPUT_FILE;
use super::output::last_lines;
use rafcon_protocol::{Answer, Command, Event};
use rafcon_storage::journal::{Reader, Record};
use rafcon_supervisor::{Death, Exit, remains};
use std::path::Path;

/// So many of its last lines are kept.
const LINES: usize = 12;

/// How a runner ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fate {
    /// What is known of it.
    pub(super) death: Death,
    /// Somebody wanted it to end at once.
    pub(super) is_killed: bool,
}

/// How the last runner of the run in `folder` ended; `exit` is known of a process of our own.
pub(super) fn of(folder: &Path, exit: Option<Exit>) -> Fate {
    let reason = exit
        .map_or_else(|| "its runner ended before the run did".to_owned(), |exit| exit.to_string());
    let last = Reader::open(folder).and_then(|reader| reader.tail()).unwrap_or_default();
    let last = last.iter().rev().filter_map(|entry| match &entry.record {
        Record::Told(event) => Some(&**event),
        _ => None,
    });
    let mut last = last.take_while(|event| !matches!(event, Event::Resumed { .. }));
    let by = last.find(|event| matches!(event, Event::CutOff { .. }) || is_kill(event));
    let is_cut_off = matches!(by, Some(Event::CutOff { .. })) || exit.is_some_and(Exit::is_cut_off);
    let is_killed = by.is_some_and(is_kill);
    let said = last_lines(&folder.join(OUTPUT_FILE), LINES);
    let death = Death { reason, active: remains::running(folder), said, is_cut_off };
    Fate { death, is_killed }
}

fn is_kill(event: &Event) -> bool {
    let Event::Commanded { envelope, answer } = event else { return false };
    envelope.command == Command::Kill && *answer == Answer::Applied
}
