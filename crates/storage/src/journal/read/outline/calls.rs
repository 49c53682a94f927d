//! Calls of a run: each entry of a state with its end, in the order of events. Handles records, not the use of the calls.

use super::super::Entry;
use crate::journal::record::{PlaceNumber, Places, Record};
use rafcon_model::ids::OutcomeId;
use rafcon_protocol::Event;
use rafcon_protocol::api::CallEnd;
use std::collections::BTreeSet;

/// A row of calls that never overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum BarRow {
    /// Calls of one place: the root, or a child of a concurrent container.
    Of(PlaceNumber),
    /// Calls of all children of a container.
    In(PlaceNumber),
}

/// A call of a state, finished or active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Call {
    pub(super) place: PlaceNumber,
    /// Row in which the call is drawn.
    pub(super) row: BarRow,
    /// Event by which it was entered.
    pub(super) first: u64,
    pub(super) from_ns: u64,
    /// `None` while the call is active.
    pub(super) to_ns: Option<u64>,
    pub(super) end: CallEnd,
}

/// Calls that are active.
#[derive(Debug, Clone, Default)]
pub(super) struct OpenCalls {
    /// Active calls in the order of their starts.
    open: Vec<Open>,
    /// Containers with children that ran concurrently.
    concurrent: BTreeSet<PlaceNumber>,
}

#[derive(Debug, Clone, Copy)]
struct Open {
    place: PlaceNumber,
    around: Option<PlaceNumber>,
    first: u64,
    from_ns: u64,
    is_back: bool,
}

/// Time and kind of a call's end.
#[derive(Debug, Clone, Copy)]
struct Closing {
    t_ns: u64,
    end: CallEnd,
}

impl OpenCalls {
    /// Returns the containers with children that ran concurrently.
    pub(super) fn concurrent(&self) -> &BTreeSet<PlaceNumber> {
        &self.concurrent
    }

    /// Returns all active calls.
    pub(super) fn calls(&self) -> impl Iterator<Item = Call> {
        self.open.iter().map(|open| self.call(open, None, CallEnd::Open))
    }

    /// Processes an event. Passes on the calls that it ends.
    pub(super) fn take(&mut self, entry: &Entry, places: &Places, mut ended: impl FnMut(Call)) {
        match &entry.record {
            Record::Entered { place, undoes, .. } => {
                self.close(
                    *place,
                    Closing { t_ns: entry.t_ns, end: CallEnd::Dropped },
                    places,
                    &mut ended,
                );
                let around = places.parent(*place);
                if let Some(outer) = around.filter(|_| self.has_open_in(around)) {
                    self.concurrent.insert(outer);
                }
                let (first, from_ns) = (entry.sequence, entry.t_ns);
                let is_back = undoes.is_some();
                self.open.push(Open { place: *place, around, first, from_ns, is_back });
            }
            Record::Left { place, outcome, error, undoes, .. } => {
                let end = match (undoes, error, OutcomeId(*outcome)) {
                    (Some(_), _, _) => CallEnd::Back,
                    (None, Some(_), _) | (None, None, OutcomeId::ABORTED) => CallEnd::Aborted,
                    (None, None, OutcomeId::PREEMPTED) => CallEnd::Preempted,
                    (None, None, _) => CallEnd::Ended,
                };
                self.close(*place, Closing { t_ns: entry.t_ns, end }, places, &mut ended);
            }
            Record::Told(event) => match &**event {
                Event::Dropped { path } => {
                    if let Some(place) = places.number(path) {
                        self.close(
                            place,
                            Closing { t_ns: entry.t_ns, end: CallEnd::Dropped },
                            places,
                            &mut ended,
                        );
                    }
                }
                Event::Resumed { .. } => {
                    for open in std::mem::take(&mut self.open) {
                        ended(self.call(&open, Some(entry.t_ns), CallEnd::Dropped));
                    }
                }
                _ => {}
            },
            _ => {}
        }
    }

    fn has_open_in(&self, around: Option<PlaceNumber>) -> bool {
        self.open.iter().any(|open| open.around == around)
    }

    /// Ends the active call of a place, and all active calls inside it.
    fn close(
        &mut self,
        place: PlaceNumber,
        closing: Closing,
        places: &Places,
        ended: &mut impl FnMut(Call),
    ) {
        let Closing { t_ns, end } = closing;
        let Some(at) = self.open.iter().rposition(|open| open.place == place) else { return };
        let is_inside = |inner: PlaceNumber| {
            std::iter::successors(places.parent(inner), |outer| places.parent(*outer))
                .any(|outer| outer == place)
        };
        for index in (at + 1..self.open.len()).rev() {
            if is_inside(self.open[index].place) {
                let open = self.open.remove(index);
                ended(self.call(&open, Some(t_ns), CallEnd::Dropped));
            }
        }
        let open = self.open.remove(at);
        ended(self.call(&open, Some(t_ns), end));
    }

    fn call(&self, open: &Open, to_ns: Option<u64>, end: CallEnd) -> Call {
        let Open { place, around, first, from_ns, is_back } = *open;
        let outer = around.filter(|around| !self.concurrent.contains(around));
        let row = outer.map_or(BarRow::Of(place), BarRow::In);
        let end = if is_back { CallEnd::Back } else { end };
        Call { place, row, first, from_ns, to_ns, end }
    }
}
