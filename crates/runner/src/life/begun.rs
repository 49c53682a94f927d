//! The start state of a resumed run, from its journal: the state in the launch or in a later command, and whether the
//! run reached it. This module knows events; the engine knows the consequences.

use crate::drive::prepare::behind;
use crate::life::resume::latest;
use rafcon_engine::{BegunAt, Then};
use rafcon_model::StatePath;
use rafcon_protocol::{Answer, Beginning, Command, Event};
use rafcon_storage::journal::{Entry, Moment, Places, Reader, Record};

/// The last start state of the run, if it still matters. A run that started before the latest events has reached it.
pub(crate) fn begun_at(
    reader: &mut Reader,
    last: &Moment,
    beginning: &Beginning,
) -> Option<BegunAt> {
    let entries = latest(reader, last).ok()?;
    let begun_again = entries.iter().rposition(|entry| begins(&entry.record));
    let (wanted, since) = match begun_again {
        // Entries that follow from a command are recorded before the command.
        Some(at) => (wanted(&entries[at].record), root_before(&entries[..at], last.places())),
        None => (launched(beginning), 0),
    };
    let (path, then) = wanted?;
    let is_told = begun_again.is_some() || entries.first()?.sequence == 1;
    let mut moves = entries[since..].iter().filter_map(|entry| {
        let (place, comes) = match &entry.record {
            Record::Entered { place, .. } => (place, true),
            Record::Left { place, undoes: Some(_), .. } => (place, false),
            _ => return None,
        };
        (last.places().get(*place)?.path == path).then_some(comes)
    });
    let is_reached = moves.next_back().unwrap_or(!is_told);
    let matters = !is_reached || then != Then::GoOn;
    matters.then(|| BegunAt { path: StatePath::parse(&path), is_reached, then })
}

fn begins(record: &Record) -> bool {
    match record {
        Record::WentBack { .. } => true,
        Record::Told(event) => {
            matches!(&**event, Event::Commanded { envelope, answer: Answer::Applied } if matches!(
                envelope.command,
                Command::Start { .. } | Command::RunSelected { .. } | Command::RunOnlySelected { .. }
            ))
        }
        _ => false,
    }
}

fn wanted(record: &Record) -> Option<(String, Then)> {
    let Record::Told(event) = record else { return None };
    let Event::Commanded { envelope, .. } = &**event else { return None };
    match &envelope.command {
        Command::Start { from, .. } => Some((from.clone()?, Then::GoOn)),
        Command::RunSelected { path, .. } => Some((path.clone(), Then::Hold)),
        Command::RunOnlySelected { path, .. } => Some((path.clone(), Then::Stop)),
        _ => None,
    }
}

fn launched(beginning: &Beginning) -> Option<(String, Then)> {
    Some((beginning.start_from.clone()?, behind(beginning.afterwards)))
}

/// Index of the last entry of the root.
fn root_before(entries: &[Entry], places: &Places) -> usize {
    let is_root = |entry: &Entry| {
        let Record::Entered { place, undoes: None, .. } = &entry.record else { return false };
        places.get(*place).is_some_and(|place| !place.path.contains('/'))
    };
    entries.iter().rposition(is_root).unwrap_or(0)
}
