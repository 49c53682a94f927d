//! Search in the page: entries of states by their names, ends by their outcomes, lines of the log by their text. Each name is
//! compared once, so that searching a long run takes no longer than reading it.

use super::{Entry, Looked, Reader, outcome_of};
use crate::journal::folder::JournalError;
use crate::journal::record::{PlaceNumber, Record};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// A text in lower case, and cached results of its comparison.
#[derive(Debug)]
struct Wanted {
    text: String,
    states: BTreeMap<PlaceNumber, bool>,
    outcomes: BTreeMap<(PlaceNumber, i64), bool>,
}

impl Reader {
    /// Returns at most `count` hits among `look` events from number `from` on, and the progress of the search.
    pub fn hits(
        &mut self,
        text: &str,
        from: u64,
        count: usize,
        look: u64,
    ) -> Result<(Vec<Entry>, Looked), JournalError> {
        let mut wanted = Wanted {
            text: text.trim().to_lowercase(),
            states: BTreeMap::new(),
            outcomes: BTreeMap::new(),
        };
        let from = from.max(1);
        let (mut hits, mut looked) = (Vec::new(), Looked { next: from, is_past: false });
        self.each(from, |reader, entry| {
            looked.next = entry.sequence + 1;
            if wanted.is(reader, &entry) {
                hits.push(entry);
            }
            if hits.len() >= count || looked.next - from >= look {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })?;
        Ok((hits, looked))
    }
}

impl Wanted {
    fn is(&mut self, reader: &Reader, entry: &Entry) -> bool {
        let text = &self.text;
        let has = |said: &str| said.to_lowercase().contains(text);
        let places = reader.known_places();
        match &entry.record {
            Record::Entered { place, .. } => {
                let name = || places.get(*place).map_or("", |place| last_of(&place.names));
                *self.states.entry(*place).or_insert_with(|| has(name()))
            }
            Record::Left { place, outcome, .. } => {
                let known = places.get(*place).map(|place| &**place);
                let name = || outcome_of(known, *outcome).name;
                *self.outcomes.entry((*place, *outcome)).or_insert_with(|| has(&name()))
            }
            Record::Log { message, .. } => has(message),
            _ => false,
        }
    }
}

fn last_of(names: &str) -> &str {
    names.rsplit('/').next().unwrap_or(names)
}
