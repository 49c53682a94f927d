//! The end of a run that its runner had kept and could not tell any more. Knows the run's journal.

use crate::supervisor::End;
use rafcon_protocol::Event;
use rafcon_storage::journal::{Reader, Record};
use std::path::Path;
use std::time::Duration;

/// When and how the run in this folder ended, if it did.
pub(super) fn find(folder: &Path) -> Option<(Duration, Event)> {
    let events = Reader::open(folder).ok()?.tail().ok()?;
    let end = events.into_iter().rev().find_map(|entry| match entry.record {
        Record::Told(event) => Some((Duration::from_nanos(entry.t_ns), *event)),
        _ => None,
    });
    end.filter(|(_, event)| matches!(event, Event::Finished { .. }))
}

/// The same as the end of this program's work.
pub(super) fn as_end(event: &Event) -> Option<End> {
    let Event::Finished { outcome, .. } = event else { return None };
    Some(End::Finished { outcome: outcome.clone(), timed_out: false })
}
