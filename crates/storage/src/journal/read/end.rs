//! The end of a run, and its results.

use super::{Entry, Reader};
use crate::journal::JournalError;
use crate::journal::folder::EndValues;
use crate::journal::record::Record;
use rafcon_protocol::Event;
use std::time::Duration;

impl Reader {
    /// Returns time and event of the end. `None` if the run has not ended, or was resumed after its end.
    pub fn last_end(&self) -> Result<Option<(Duration, Event)>, JournalError> {
        let tail = self.tail()?;
        Ok(end_in(&tail).map(|(t_ns, event)| (Duration::from_nanos(t_ns), event.clone())))
    }

    /// Returns the final values: from their file if it exists, or else from the event. `None` without an end. A replica has no
    /// file, so its long values are views.
    /// that long values are views.
    pub fn results(&self) -> Result<Option<EndValues>, JournalError> {
        let Some((_, Event::Finished { outputs, globals, scoped_variables, .. })) =
            self.last_end()?
        else {
            return Ok(None);
        };
        let in_file = EndValues::read(self.folder())?;
        Ok(Some(in_file.unwrap_or(EndValues { outputs, globals, scoped_variables })))
    }
}

/// Returns time and event of the end, if it is among the last events of a run.
pub(super) fn end_in(tail: &[Entry]) -> Option<(u64, &Event)> {
    let mut events = tail.iter().rev().filter_map(|entry| match &entry.record {
        Record::Told(event) => Some((entry.t_ns, &**event)),
        _ => None,
    });
    let is_mark = |event: &Event| matches!(event, Event::Finished { .. } | Event::Resumed { .. });
    let last = events.find(|(_, event)| is_mark(event));
    last.filter(|(_, event)| matches!(event, Event::Finished { .. }))
}
