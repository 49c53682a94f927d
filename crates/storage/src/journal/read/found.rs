//! Searches events of a run, from any event on, and returns each with the names of its state and its duration.
//!
//! Handles journals, not the display of events.

use super::filter::{Filter, FilterState, path_of, place_of};
use super::{Entry, Reader, damaged};
use crate::journal::folder::JournalError;
use crate::journal::record::{PlaceNumber, Record};
use rafcon_protocol::{Event, without_values};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Duration;

/// Events to search for, and the range.
#[derive(Debug, Clone, Copy)]
pub struct Search<'f> {
    /// Conditions of the search.
    pub filter: &'f Filter,
    /// Number of the first event to examine.
    pub from: u64,
    /// Maximum number of events to examine.
    pub look: u64,
    /// True to include inputs, outputs and complete errors of states, and events that only carry a value.
    pub values: bool,
}

/// Number of events that are read before they are passed to a consumer, which may be slow.
const PAGE: usize = 4096;

/// Progress of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Looked {
    /// Number of the first event that was not examined.
    pub next: u64,
    /// True if no later event can match, because all are after the filter's end time.
    pub is_past: bool,
}

/// An event that matches.
#[derive(Debug, Clone)]
pub struct Found {
    /// Number of the event.
    pub sequence: u64,
    /// Time since the start of the run, in ns.
    pub t_ns: u64,
    /// Event with its details.
    pub event: Event,
    /// Names of the event's state and its ancestors. Empty if the event has no state.
    pub names: String,
    /// Name of the next state, if the run is held before one.
    pub next: Option<String>,
    /// Duration of a state that ended, if its entry is in the searched range.
    pub lasted: Option<Duration>,
}

impl Found {
    /// Returns the time of the event.
    pub fn time(&self) -> Duration {
        Duration::from_nanos(self.t_ns)
    }
}

/// Returns true if an event only carries a value.
pub fn is_about_values(record: &Record) -> bool {
    matches!(record, Record::Scoped { .. } | Record::Global { .. } | Record::Persistent { .. })
}

impl Reader {
    /// Passes all matching events of the run to `show`, with values. The journal is not locked while `show` runs, so that a runner
    /// can compact it.
    pub fn find_all<E: From<JournalError>>(
        &mut self,
        filter: &Filter,
        mut show: impl FnMut(Found) -> Result<(), E>,
    ) -> Result<(), E> {
        let search = Search { filter, from: 1, look: self.last_sequence()?, values: true };
        let mut looking = Looking::new(&search);
        while !looking.is_over() {
            let page = self.page(looking.looked.next, PAGE)?;
            if page.is_empty() {
                break;
            }
            for entry in page {
                let found = if looking.is_over() { None } else { looking.take(self, &entry)? };
                found.map_or(Ok(()), &mut show)?;
            }
        }
        Ok(())
    }

    /// Passes matching events to `show` until it breaks. Returns the progress of the search.
    pub fn search<E: From<JournalError>>(
        &mut self,
        search: &Search<'_>,
        mut show: impl FnMut(Found) -> Result<ControlFlow<()>, E>,
    ) -> Result<Looked, E> {
        let mut looking = Looking::new(search);
        let mut failure = None;
        if search.look > 0 {
            self.each(search.from, |reader, entry| {
                let found = looking.take(reader, &entry).map_err(E::from);
                let shown = match found {
                    Ok(Some(found)) => show(found),
                    Ok(None) => Ok(ControlFlow::Continue(())),
                    Err(error) => Err(error),
                };
                let flow = shown.unwrap_or_else(|error| {
                    failure = Some(error);
                    ControlFlow::Break(())
                });
                if looking.is_over() { ControlFlow::Break(()) } else { flow }
            })?;
        }
        failure.map_or(Ok(looking.looked), Err)
    }
}

/// A search in progress.
struct Looking<'s> {
    search: &'s Search<'s>,
    sieve: FilterState<'s>,
    entered: Entered,
    left: u64,
    looked: Looked,
}

impl<'s> Looking<'s> {
    fn new(search: &'s Search<'s>) -> Self {
        Self {
            search,
            sieve: search.filter.sieve(),
            entered: Entered::default(),
            left: search.look,
            looked: Looked { next: search.from.max(1), is_past: false },
        }
    }

    fn is_over(&self) -> bool {
        self.looked.is_past || self.left == 0
    }

    /// Examines an event. Returns it if the search includes it.
    fn take(&mut self, reader: &Reader, entry: &Entry) -> Result<Option<Found>, JournalError> {
        if self.search.filter.is_past(entry.t_ns) {
            self.looked.is_past = true;
            return Ok(None);
        }
        let lasted = self.entered.lasted(entry);
        self.looked.next = entry.sequence + 1;
        self.left -= 1;
        let is_wanted = self.search.values || !is_about_values(&entry.record);
        if !is_wanted || !self.sieve.lets_through(entry, reader.known_places()) {
            return Ok(None);
        }
        // Text is searched in values too.
        let values = self.search.values || self.search.filter.text.is_some();
        let mut found = found(reader, entry, lasted, values)?;
        if !self.sieve.has_text(&found.event, &found.names) {
            return Ok(None);
        }
        if !self.search.values {
            without_values(&mut found.event);
        }
        Ok(Some(found))
    }
}

fn found(
    reader: &Reader,
    entry: &Entry,
    lasted: Option<Duration>,
    values: bool,
) -> Result<Found, JournalError> {
    let event = reader.event(entry, values)?;
    let places = reader.known_places();
    let place = place_of(&entry.record).or_else(|| places.number(path_of(&event)));
    let names = place.and_then(|place| places.get(place)).map(|place| place.names.clone());
    let names = names.unwrap_or_else(|| path_of(&event).to_owned());
    let next = match &event {
        Event::Held { next: Some(next), .. } => Some(name_of(reader, next)),
        _ => None,
    };
    Ok(Found { sequence: entry.sequence, t_ns: entry.t_ns, event, names, next, lasted })
}

/// Returns the name of a state, or its id if it was never entered.
fn name_of(reader: &Reader, path: &str) -> String {
    let places = reader.known_places();
    let names = places.number(path).and_then(|place| places.get(place)).map(|place| &*place.names);
    names.unwrap_or(path).rsplit('/').next().unwrap_or_default().to_owned()
}

/// Entry times of active states.
#[derive(Debug, Default)]
struct Entered(BTreeMap<PlaceNumber, u64>);

impl Entered {
    /// Returns the duration of the state that ends.
    fn lasted(&mut self, entry: &Entry) -> Option<Duration> {
        match entry.record {
            Record::Entered { place, .. } => {
                self.0.insert(place, entry.t_ns);
                None
            }
            Record::Left { place, .. } => {
                Some(Duration::from_nanos(entry.t_ns.saturating_sub(self.0.remove(&place)?)))
            }
            // The state may have ended and started again.
            _ if damaged(&entry.record).is_some() => {
                self.0.clear();
                None
            }
            _ => None,
        }
    }
}
