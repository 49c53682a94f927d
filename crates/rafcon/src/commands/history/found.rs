//! Events of a run as lines of JSON, and the last of those that are wanted. Knows events, not how they are shown to people.

use anyhow::Result;
use rafcon_protocol::{Event, without_values};
use rafcon_storage::journal::Found;
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

/// Shows what `find` finds; with `last`, only so many of the last. Answers with what is wrong with the rest, as `find` does.
pub(super) fn each_found(
    find: impl FnOnce(&mut dyn FnMut(Found) -> Result<()>) -> Result<Result<()>>,
    last: Option<usize>,
    mut show: impl FnMut(&Found) -> Result<()>,
) -> Result<Result<()>> {
    let Some(count) = last else { return find(&mut |found| show(&found)) };
    let mut found_last = VecDeque::new();
    let whole = find(&mut |found| {
        found_last.push_back(found);
        if found_last.len() > count {
            found_last.pop_front();
        }
        Ok(())
    })?;
    found_last.iter().try_for_each(show)?;
    Ok(whole)
}
