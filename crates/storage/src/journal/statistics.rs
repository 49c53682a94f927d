//! What the states of a run did and took, gathered in one pass that can go on later. Memory is bounded by the states, not by the
//! events.
//!
//! Knows records. Must never know who wants to know.

use super::error::JournalError;
use super::places::Places;
use super::reader::{Entry, Reader, damaged, outcome_of};
use super::record::{PlaceNumber, Record};
use rafcon_protocol::Event;
use rafcon_protocol::api::{OutcomeCount, StateStatistics, Statistics};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// What was gathered of a run so far.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    sequence: u64,
    t_ns: u64,
    /// When active states were entered.
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
    /// Takes in what happened since.
    pub fn go_on(&mut self, reader: &mut Reader) -> Result<(), JournalError> {
        let mut lost = None;
        reader.each(self.sequence + 1, |reader, entry| {
            lost = damaged(&entry.record);
            if lost.is_some() {
                return ControlFlow::Break(());
            }
            self.take(&entry, reader.known_places());
            ControlFlow::Continue(())
        })?;
        let Some((first, last)) = lost else { return Ok(()) };
        // Whoever asks again is to hear the same.
        *self = Self::default();
        Err(reader.lost(first, last, "the states cannot be counted"))
    }

    /// What it says, with the names that states have now.
    pub fn told(&self, places: &Places) -> Statistics {
        let state = |(place, state): (&PlaceNumber, &StateTally)| state.told(*place, places);
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

    fn told(&self, number: PlaceNumber, places: &Places) -> Option<StateStatistics> {
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

/// Each power of two is parted in so many: what is told is less than 1 % beside the truth.
const PARTS: u64 = 64;

/// How often something took how long, by classes that are as wide as what they hold is long.
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

    /// The span that so many of a hundred do not exceed.
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

/// Below [`PARTS`] each number is a class of its own; above, each power of two has so many.
fn class(span: u64) -> u64 {
    let bits = u64::from(span.max(1).ilog2());
    let shift = bits.saturating_sub(u64::from(PARTS.ilog2()));
    shift * PARTS + (span >> shift)
}

/// A span in the middle of a class.
fn middle(class: u64) -> u64 {
    let shift = (class / PARTS).saturating_sub(1);
    let first = (class - shift * PARTS) << shift;
    first + (1 << shift) / 2
}

#[cfg(test)]
mod tests {
    use super::{Spans, Tally};
    use crate::journal::{About, Journal, Options, Reader, notation};
    use expect_test::{Expect, expect};
    use proptest::prelude::*;
    use std::fmt::Write as _;

    const MACHINE: &str = r#"
        place R "Root" outcome done
        place R/A "Root/Scan" script outcome ok,lost
        place R/B "Root/Both" outcome ok
    "#;

    fn check(text: &str, expect: &Expect) {
        let folder = tempfile::tempdir().unwrap();
        let journal =
            Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
        journal.append(&notation::batch(&format!("{MACHINE}{text}"), 0).unwrap()).unwrap();
        journal.close().unwrap();
        let mut reader = Reader::open(folder.path()).unwrap();
        let mut tally = Tally::default();
        tally.go_on(&mut reader).unwrap();
        expect.assert_eq(&shown(&tally, &reader));
        tally.go_on(&mut reader).unwrap();
        expect.assert_eq(&shown(&tally, &reader));
    }

    fn shown(tally: &Tally, reader: &Reader) -> String {
        let told = tally.told(reader.known_places());
        let mut text = format!("up to event {}\n", told.sequence);
        for state in &told.states {
            let [total, min, median, p95, max] =
                [state.total_ns, state.min_ns, state.median_ns, state.p95_ns, state.max_ns]
                    .map(|ns| ns / 1_000_000);
            let outcome = |it: &super::OutcomeCount| format!("{} {}x", it.outcome.name, it.count);
            let outcomes: Vec<String> = state.outcomes.iter().map(outcome).collect();
            let facts = format!("{total} ms in all, {min} {median} {p95} {max}");
            writeln!(text, "{}: {}x, {facts}, {}", state.names, state.count, outcomes.join(", "))
                .unwrap();
        }
        text
    }

    #[test]
    fn states_are_counted_with_their_times_and_outcomes() {
        check(
            "enter R\nenter R/A\n@10 leave R/A lost\n@20 enter R/A\n@120 leave R/A ok\n@130 enter R/A\n@131 leave R/A ok\n@200 leave R done",
            &expect![[r"
                up to event 8
                Root: 1x, 199 ms in all, 199 199 199 199, done 1x
                Root/Scan: 3x, 109 ms in all, 1 8 100 100, ok 2x, lost 1x
            "]],
        );
    }

    #[test]
    fn steps_back_and_states_that_were_dropped_are_not_counted() {
        check(
            "enter R\nenter R/A\nleave R/A ok\nenter R/A undoes 2\nleave R/A ok undoes 2\nenter R/B\ntold {\"type\": \"dropped\", \"path\": \"R/B\"}",
            &expect![[r"
                up to event 7
                Root/Scan: 1x, 1 ms in all, 1 1 1 1, ok 1x
            "]],
        );
    }

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
