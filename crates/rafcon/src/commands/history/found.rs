//! Events of a run as lines of JSON, and the last of those that are wanted. Knows journals, not how events are shown to people.

use anyhow::Result;
use rafcon_protocol::{Event, without_values};
use rafcon_storage::journal::{Filter, Found, Reader};
use serde::Serialize;
use std::collections::VecDeque;

/// An event as a line of JSON; without `values`, inputs and outputs of states are left out, and errors are short.
pub(super) fn json(found: &Found, values: bool) -> Vec<String> {
    let mut event = found.event.clone();
    if !values {
        without_values(&mut event);
    }
    let line = Numbered { sequence: found.sequence, t_ns: found.t_ns, event: &event };
    serde_json::to_string(&line).into_iter().collect()
}

/// An event as it stands in a line.
#[derive(Debug, Serialize)]
struct Numbered<'e> {
    sequence: u64,
    t_ns: u64,
    event: &'e Event,
}

/// Shows the events that the filter wants; with `last`, only so many of the last.
pub(super) fn each_found(
    reader: &mut Reader,
    filter: &Filter,
    last: Option<usize>,
    mut show: impl FnMut(&Found) -> Result<()>,
) -> Result<()> {
    let Some(count) = last else { return reader.find_all(filter, |found| show(&found)) };
    let mut found_last = VecDeque::new();
    reader.find_all(filter, |found| -> Result<()> {
        found_last.push_back(found);
        if found_last.len() > count {
            found_last.pop_front();
        }
        Ok(())
    })?;
    found_last.iter().try_for_each(show)
}
