//! Statistics of the states of a run, gathered in one pass that can continue later. The number of states limits the memory, not the
//! number of events.

use super::{Entry, Reader, damaged, outcome_of};
use crate::journal::folder::JournalError;
use crate::journal::record::{PlaceNumber, Places, Record};
use rafcon_protocol::Event;
use rafcon_protocol::api::{OutcomeCount, StateStatistics, Statistics};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Statistics of a run up to the last processed event.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    sequence: u64,
    t_ns: u64,
    /// Entry times of active states.
    active: BTreeMap<PlaceNumber, u64>,
    states: BTreeMap<PlaceNumber, StateTally>,
}

#[derive(Debug, Clone, Default)]
struct StateTally {
    total_ns: u64,
    spans: Spans,
    outcomes: BTreeMap<i64, u64>,
}

impl Tally {
    /// Adds the events since the last call.
    pub fn go_on(&mut self, reader: &mut Reader) -> Result<(), JournalError> {
        self.go_on_to(reader, u64::MAX)
    }

    /// Adds the events since the last call, up to number `until`.
    pub fn go_on_to(&mut self, reader: &mut Reader, until: u64) -> Result<(), JournalError> {
        let mut lost = None;
        reader.each(self.sequence + 1, |reader, entry| {
            if entry.sequence > until {
                return ControlFlow::Break(());
            }
            lost = damaged(&entry.record);
            if lost.is_some() {
                return ControlFlow::Break(());
            }
            self.take(&entry, reader.known_places());
            ControlFlow::Continue(())
        })?;
        let Some((first, last)) = lost else { return Ok(()) };
        // Reset, so that a repeated call gives an identical result.
        *self = Self::default();
        Err(reader.lost(first, last, "the states cannot be counted"))
    }

    /// Returns the statistics with the current names of states.
    pub fn statistics(&self, places: &Places) -> Statistics {
        let state = |(place, state): (&PlaceNumber, &StateTally)| state.statistics(*place, places);
        let mut states: Vec<StateStatistics> = self.states.iter().filter_map(state).collect();
        states.sort_by(|a, b| a.path.cmp(&b.path));
        Statistics { sequence: self.sequence, t_ns: self.t_ns, states }
    }

    fn take(&mut self, entry: &Entry, places: &Places) {
        (self.sequence, self.t_ns) = (entry.sequence, entry.t_ns);
        match &entry.record {
            Record::Entered { place, .. } => drop(self.active.insert(*place, entry.t_ns)),
            Record::Left { place, outcome, undoes, .. } => {
                let since = self.active.remove(place);
                if let Some(since) = since.filter(|_| undoes.is_none()) {
                    let state = self.states.entry(*place).or_default();
                    state.left(*outcome, entry.t_ns.saturating_sub(since));
                }
            }
            Record::Told(event) => {
                if let Event::Dropped { path } = &**event
                    && let Some(place) = places.number(path)
                {
                    self.active.remove(&place);
                }
            }
            _ => {}
        }
    }
}

impl StateTally {
    fn left(&mut self, outcome: i64, span: u64) {
        self.total_ns = self.total_ns.saturating_add(span);
        self.spans.add(span);
        *self.outcomes.entry(outcome).or_default() += 1;
    }

    fn statistics(&self, number: PlaceNumber, places: &Places) -> Option<StateStatistics> {
        let place = places.get(number)?;
        let count = |(id, count): (&i64, &u64)| OutcomeCount {
            outcome: outcome_of(Some(place), *id),
            count: *count,
        };
        let mut outcomes: Vec<OutcomeCount> = self.outcomes.iter().map(count).collect();
        outcomes.sort_by_key(|it| std::cmp::Reverse(it.count));
        Some(StateStatistics {
            path: place.path.clone(),
            names: place.names.clone(),
            count: self.spans.count,
            total_ns: self.total_ns,
            min_ns: self.spans.min,
            median_ns: self.spans.at(50),
            p95_ns: self.spans.at(95),
            max_ns: self.spans.max,
            outcomes,
        })
    }
}

/// Number of classes in each power of two. The error of a result is below 1 %.
const PARTS: u64 = 64;

/// A histogram of spans whose classes grow with the spans.
#[derive(Debug, Clone, Default)]
struct Spans {
    count: u64,
    min: u64,
    max: u64,
    classes: BTreeMap<u64, u64>,
}

impl Spans {
    fn add(&mut self, span: u64) {
        self.min = if self.count == 0 { span } else { self.min.min(span) };
        self.max = self.max.max(span);
        self.count += 1;
        *self.classes.entry(class(span)).or_default() += 1;
    }

    /// Returns the span that `percent` of all spans do not exceed.
    fn at(&self, percent: u64) -> u64 {
        let rank = (u128::from(self.count) * u128::from(percent)).div_ceil(100);
        if rank == u128::from(self.count) {
            return self.max;
        }
        let mut seen = 0;
        let found = self.classes.iter().find(|(_, count)| {
            seen += u128::from(**count);
            seen >= rank
        });
        found.map_or(0, |(class, _)| middle(*class).clamp(self.min, self.max))
    }
}

/// Below [`PARTS`] each number is a class; above, each power of two has [`PARTS`] classes.
fn class(span: u64) -> u64 {
    let bits = u64::from(span.max(1).ilog2());
    let shift = bits.saturating_sub(u64::from(PARTS.ilog2()));
    shift * PARTS + (span >> shift)
}

/// Returns the span in the middle of a class.
fn middle(class: u64) -> u64 {
    let shift = (class / PARTS).saturating_sub(1);
    let first = (class - shift * PARTS) << shift;
    first + (1 << shift) / 2
}

#[cfg(test)]
mod tests {
    use super::Spans;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_told_is_near_the_truth(mut spans in prop::collection::vec(0..u64::MAX >> 1, 1..60), shift in 0..60) {
            let mut gathered = Spans::default();
            for span in &mut spans {
                *span >>= shift;
                gathered.add(*span);
            }
            spans.sort_unstable();
            for percent in [50, 95] {
                let exact = spans[(spans.len() * percent).div_ceil(100) - 1];
                let told = gathered.at(percent as u64);
                prop_assert!(told.abs_diff(exact) <= exact / 64 + 1, "{told} {exact}");
            }
        }
    }
}
