//! Events that are received in parts.

use crate::assembly::Assembly;
use crate::frame::{Packing, PartialEvent};
use crate::range_set::RangeSet;
use std::collections::BTreeMap;

/// Capacity of a report in events. The oldest are reported, because the robot repairs them first.
pub(crate) const LARGE_MAX: usize = 4;
/// Capacity: more events than a round trip carries. Of more, the newest is dropped, so that the oldest become complete.
const KEPT_MAX: usize = 256;
/// Capacity of a report in ranges of one event. The robot sends the parts in further ranges again.
const RANGES_MAX: usize = 4;

/// Events of a run of which parts are missing, by their numbers.
#[derive(Debug, Default)]
pub(super) struct LargeEvents(BTreeMap<u64, (Packing, Assembly)>);

impl LargeEvents {
    /// Memory of the parts, in bytes.
    pub(super) fn length(&self) -> usize {
        self.0.values().map(|(_, parts)| parts.length()).sum()
    }

    /// True if parts of this event are here.
    pub(super) fn has(&self, number: u64, length: u32, packing: Packing) -> bool {
        let known = self.0.get(&number);
        known.is_some_and(|(known, parts)| *known == packing && parts.is_of(number, length))
    }

    /// Adds a part of an event. Returns its packed items once they are complete.
    pub(super) fn add(
        &mut self,
        event: (u64, u32, Packing),
        offset: u32,
        part: &[u8],
    ) -> Option<Vec<u8>> {
        let (number, length, packing) = event;
        if !self.has(number, length, packing) {
            self.0.remove(&number);
            if self.0.len() >= KEPT_MAX {
                self.0.pop_last();
            }
        }
        let (_, parts) = self.0.entry(number).or_insert_with(|| (packing, Assembly::default()));
        let whole = parts.add(number, length, offset, part);
        // Complete, or too long.
        if parts.length() == 0 {
            self.0.remove(&number);
        }
        whole
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Drops events that were received in another way.
    pub(super) fn drop_received(&mut self, received: &RangeSet) {
        self.0.retain(|number, _| !received.contains(&(*number..=*number)));
    }

    /// The oldest events, with their oldest ranges: a report is short.
    pub(super) fn report(&self) -> Vec<PartialEvent> {
        let partial = |(number, (_, parts)): (&u64, &(Packing, Assembly))| PartialEvent {
            first: *number,
            length: u32::try_from(parts.length()).unwrap_or(u32::MAX),
            here: parts.here().ranges().take(RANGES_MAX).collect(),
        };
        self.0.iter().take(LARGE_MAX).map(partial).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{KEPT_MAX, LARGE_MAX, LargeEvents, Packing, RANGES_MAX, RangeSet};

    const PLAIN: Packing = Packing::Plain;

    fn numbers(events: &LargeEvents) -> Vec<u64> {
        events.report().iter().map(|partial| partial.first).collect()
    }

    #[test]
    fn of_more_events_than_the_bound_the_newest_is_dropped() {
        let mut events = LargeEvents::default();
        for number in 1..=KEPT_MAX as u64 + 2 {
            assert_eq!(events.add((number, 4, PLAIN), 0, b"ab"), None);
        }
        assert_eq!(events.length(), KEPT_MAX * 4);
        assert!(events.has(1, 4, PLAIN) && events.has(KEPT_MAX as u64 + 2, 4, PLAIN));
        assert!(!events.has(KEPT_MAX as u64, 4, PLAIN));
    }

    #[test]
    fn the_oldest_events_are_reported() {
        let mut events = LargeEvents::default();
        for number in (1..=LARGE_MAX as u64 + 2).rev() {
            assert_eq!(events.add((number, 4, PLAIN), 0, b"ab"), None);
        }
        assert_eq!(numbers(&events), [1, 2, 3, 4]);
        // An event that is packed in another way begins again.
        assert_eq!(events.add((3, 2, Packing::Deflated), 0, b"a"), None);
        assert_eq!(numbers(&events), [1, 2, 3, 4]);
        assert_eq!(events.add((4, 4, PLAIN), 2, b"cd"), Some(b"abcd".to_vec()));
        events.drop_received(&RangeSet::up_to(1));
        assert_eq!(numbers(&events), [2, 3, 5, 6]);
        assert_eq!(events.length(), 4 + 2 + 4 + 4);
    }

    #[test]
    fn a_report_has_so_many_ranges_of_an_event() {
        let mut events = LargeEvents::default();
        for nth in 0..10 {
            assert_eq!(events.add((1, 100, PLAIN), nth * 10, b"part"), None);
        }
        let [partial] = &events.report()[..] else { panic!("one event") };
        assert_eq!(partial.here.ranges_count(), RANGES_MAX);
        assert_eq!(partial.here.contiguous(), 4);
    }

    #[test]
    fn an_event_that_is_too_long_is_ignored() {
        let mut events = LargeEvents::default();
        assert_eq!(events.add((1, u32::MAX, PLAIN), 0, b"part"), None);
        assert_eq!((events.length(), events.report().len()), (0, 0));
    }
}
