//! Activity of states up to an event: number and duration of executions, last entries and ends. Counts each record once.

use super::super::{Entry, outcome_of};
use crate::journal::record::{PlaceNumber, Places, Record};
use rafcon_protocol::api::{EarlierState, EndTime, EventTime};
use std::collections::BTreeMap;

/// Activity of each state, by the number of its place. The size depends on the number of places, not on their numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct Counts(BTreeMap<PlaceNumber, StateCount>);

#[derive(Debug, Clone, Default)]
struct StateCount {
    entries: u64,
    ends: u64,
    total_ns: u64,
    min_ns: u64,
    max_ns: u64,
    entered: Option<EventTime>,
    left: Option<(EventTime, i64)>,
}

impl Counts {
    pub(super) fn take(&mut self, entry: &Entry) {
        let turn = EventTime { sequence: entry.sequence, t_ns: entry.t_ns };
        match &entry.record {
            Record::Entered { place, undoes, .. } => {
                let state = self.0.entry(*place).or_default();
                state.entries += u64::from(undoes.is_none());
                state.entered = Some(turn);
            }
            Record::Left { place, outcome, undoes, .. } => {
                let state = self.0.entry(*place).or_default();
                state.left(turn, *outcome, undoes.is_some());
            }
            _ => {}
        }
    }

    pub(super) fn told(&self, places: &Places) -> Vec<EarlierState> {
        let named = places.iter().filter_map(|(number, place)| {
            let state = self.0.get(&number)?;
            let end = |(turn, outcome): &(EventTime, i64)| EndTime {
                sequence: turn.sequence,
                t_ns: turn.t_ns,
                outcome: outcome_of(Some(place), *outcome),
            };
            state.entered.map(|entered| EarlierState {
                path: place.path.clone(),
                entries: state.entries,
                ends: state.ends,
                total_ns: state.total_ns,
                min_ns: state.min_ns,
                max_ns: state.max_ns,
                entered: Some(entered),
                left: state.left.as_ref().map(end),
            })
        });
        named.collect()
    }
}

impl StateCount {
    fn left(&mut self, turn: EventTime, outcome: i64, is_back: bool) {
        if is_back {
            return;
        }
        self.left = Some((turn, outcome));
        let since = self.entered.map_or(turn.t_ns, |entered| entered.t_ns);
        let length = turn.t_ns.saturating_sub(since);
        self.min_ns = if self.ends == 0 { length } else { self.min_ns.min(length) };
        self.max_ns = self.max_ns.max(length);
        self.total_ns = self.total_ns.saturating_add(length);
        self.ends += 1;
    }
}
