//! Events of a run with all that is said about them. Knows journals, not how events are shown.

use anyhow::Result;
use rafcon_protocol::Event;
use rafcon_storage::journal::{Entry, Filter, PlaceNumber, Reader, Record, path_of, place_of};
use serde::Serialize;
use std::collections::{BTreeMap, VecDeque};
use std::ops::ControlFlow;
use std::time::Duration;

/// One event.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub(crate) sequence: u64,
    pub(crate) t_ns: u64,
    /// With values.
    pub(crate) event: Event,
    /// The names of the state that it is about; empty if it is about none.
    pub(crate) names: String,
    /// The name of the state before which it is held, if it is.
    pub(crate) next: Option<String>,
    /// How long a state was active that was left.
    pub(crate) lasted: Option<Duration>,
}

impl Found {
    /// When it happened.
    pub(crate) fn time(&self) -> Duration {
        Duration::from_nanos(self.t_ns)
    }

    /// As a line of JSON; without `values`, inputs, outputs and errors of states are left out.
    pub(super) fn json(&self, values: bool) -> Vec<String> {
        let mut event = self.event.clone();
        match &mut event {
            Event::Entered { inputs, .. } if !values => *inputs = None,
            Event::Left { outputs, error, .. } if !values => (*outputs, *error) = (None, None),
            _ => {}
        }
        let line = Numbered { sequence: self.sequence, t_ns: self.t_ns, event: &event };
        serde_json::to_string(&line).into_iter().collect()
    }
}

/// An event as it stands in a line.
#[derive(Debug, Serialize)]
struct Numbered<'e> {
    sequence: u64,
    t_ns: u64,
    event: &'e Event,
}

/// Shows the events that the filter wants; with `last`, only so many of the last.
pub(crate) fn each_found(
    reader: &mut Reader,
    filter: &Filter,
    last: Option<usize>,
    mut show: impl FnMut(&Found) -> Result<()>,
) -> Result<()> {
    let Some(count) = last else { return search(reader, filter, |found| show(&found)) };
    let mut found_last = VecDeque::new();
    search(reader, filter, |found| {
        found_last.push_back(found);
        if found_last.len() > count {
            found_last.pop_front();
        }
        Ok(())
    })?;
    found_last.iter().try_for_each(show)
}

fn search(
    reader: &mut Reader,
    filter: &Filter,
    mut show: impl FnMut(Found) -> Result<()>,
) -> Result<()> {
    let mut sieve = filter.sieve();
    let mut entered = Entered::default();
    let mut failure = None;
    reader.each(1, |reader, entry| {
        let lasted = entered.lasted(&entry);
        if filter.is_past(entry.t_ns) {
            return ControlFlow::Break(());
        }
        if !sieve.lets_through(&entry, reader.known_places()) {
            return ControlFlow::Continue(());
        }
        let shown = found(reader, &entry, lasted).and_then(|found| {
            if sieve.has_text(&found.event, &found.names) { show(found) } else { Ok(()) }
        });
        match shown {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failure = Some(error);
                ControlFlow::Break(())
            }
        }
    })?;
    failure.map_or(Ok(()), Err)
}

fn found(reader: &Reader, entry: &Entry, lasted: Option<Duration>) -> Result<Found> {
    let event = reader.event(entry, true)?;
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

/// The name of a state; its id if it was never entered.
fn name_of(reader: &Reader, path: &str) -> String {
    let places = reader.known_places();
    let names = places.number(path).and_then(|place| places.get(place)).map(|place| &*place.names);
    names.unwrap_or(path).rsplit('/').next().unwrap_or_default().to_owned()
}

/// When active states were entered.
#[derive(Debug, Default)]
struct Entered(BTreeMap<PlaceNumber, u64>);

impl Entered {
    /// How long the state was active that is left.
    fn lasted(&mut self, entry: &Entry) -> Option<Duration> {
        match entry.record {
            Record::Entered { place, .. } => {
                self.0.insert(place, entry.t_ns);
                None
            }
            Record::Left { place, .. } => {
                Some(Duration::from_nanos(entry.t_ns - self.0.remove(&place)?))
            }
            _ => None,
        }
    }
}
