//! What a run came to.

use super::Reader;
use crate::journal::JournalError;
use crate::journal::folder::EndValues;
use crate::journal::record::Record;
use rafcon_protocol::Event;
use std::path::Path;

/// All values at the end of a run that are here: from its file, else from the event of its end. `None` if it has not ended.
/// A replica has no file, so that long values are views.
pub fn results(run: &Path) -> Result<Option<EndValues>, JournalError> {
    let tail = Reader::open(run)?.tail()?;
    let mut events = tail.into_iter().rev().filter_map(|entry| match entry.record {
        Record::Told(event) => Some(*event),
        _ => None,
    });
    // A run that was resumed after its end has not ended.
    let is_mark = |event: &Event| matches!(event, Event::Finished { .. } | Event::Resumed { .. });
    let Some(Event::Finished { outputs, globals, scoped_variables, .. }) = events.find(is_mark)
    else {
        return Ok(None);
    };
    let in_file = EndValues::read(run)?;
    Ok(Some(in_file.unwrap_or(EndValues { outputs, globals, scoped_variables })))
}
