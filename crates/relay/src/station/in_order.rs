//! Reorders items of a robot's streams in bounded memory.

use rafcon_link::StreamId;
use rafcon_storage::journal::EventBlock;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Capacity behind gaps, in bytes.
const AHEAD_MAX: usize = 8 << 20;
/// Approximate overhead of an item in bytes.
pub(super) const COST_BESIDE: usize = 128;

/// The streams of one robot.
#[derive(Debug, Default)]
pub(super) struct InOrder {
    streams: BTreeMap<StreamId, Ahead>,
    bytes: usize,
}

#[derive(Debug, Default)]
struct Ahead {
    /// Up to here everything was passed on.
    passed: u64,
    /// By the number of the first.
    items: BTreeMap<u64, EventBlock>,
}

impl InOrder {
    /// Everything of this stream up to here is on the disk.
    pub(super) fn restore(&mut self, stream: StreamId, passed: u64) {
        self.streams.entry(stream).or_default().passed = passed;
    }

    /// True if the queue of this stream is empty.
    pub(super) fn is_empty(&self, stream: StreamId) -> bool {
        self.streams.get(&stream).is_none_or(|ahead| ahead.items.is_empty())
    }

    /// Adds what arrived of a stream that, if nothing arrived of it since it was settled, is on the disk up to `safe`. What is too much
    /// is answered: it is not here, and has to come again.
    pub(super) fn add(
        &mut self,
        stream: StreamId,
        items: EventBlock,
        safe: u64,
    ) -> Option<RangeInclusive<u64>> {
        let begin = || Ahead { passed: safe, ..Ahead::default() };
        let ahead = self.streams.entry(stream).or_insert_with(begin);
        if ahead.items.get(&items.first_sequence).is_some_and(|longer| longer.count >= items.count)
        {
            return None;
        }
        self.bytes += cost(&items);
        if let Some(shorter) = ahead.items.insert(items.first_sequence, items) {
            self.bytes -= cost(&shorter);
        }
        // The farthest of this stream goes: the nearest is what the others wait for.
        let is_too_much = self.bytes > AHEAD_MAX;
        let (_, farthest) = is_too_much.then(|| ahead.items.pop_last())??;
        self.bytes -= cost(&farthest);
        Some(farthest.sequences())
    }

    /// Passes on what is next, as long as it is taken: what `pass` gives back waits on.
    pub(super) fn pass(
        &mut self,
        stream: StreamId,
        mut pass: impl FnMut(EventBlock) -> Result<(), EventBlock>,
    ) {
        let Some(ahead) = self.streams.get_mut(&stream) else { return };
        while let Some(first) =
            ahead.items.first_entry().filter(|first| *first.key() <= ahead.passed + 1)
        {
            let (first, items) = first.remove_entry();
            let (last, cost) = (items.last_sequence(), cost(&items));
            if last > ahead.passed
                && let Err(items) = pass(items)
            {
                ahead.items.insert(first, items);
                return;
            }
            ahead.passed = ahead.passed.max(last);
            self.bytes -= cost;
        }
    }

    /// The streams of which something waits.
    pub(super) fn waiting(&self) -> Vec<StreamId> {
        let waiting = self.streams.iter().filter(|(_, ahead)| !ahead.items.is_empty());
        waiting.map(|(stream, _)| *stream).collect()
    }

    /// A stream is settled, or begins anew: what waits of it is dropped.
    pub(super) fn forget(&mut self, stream: StreamId) {
        self.clear(stream);
        self.streams.remove(&stream);
    }

    /// Drops what waits of a stream.
    pub(super) fn clear(&mut self, stream: StreamId) {
        if let Some(ahead) = self.streams.get_mut(&stream) {
            self.bytes -= ahead.items.values().map(cost).sum::<usize>();
            ahead.items.clear();
        }
    }
}

/// Approximate memory of items in bytes.
pub(super) fn cost(items: &EventBlock) -> usize {
    items.bytes.len() + COST_BESIDE
}

#[cfg(test)]
mod tests {
    use super::{AHEAD_MAX, InOrder};
    use rafcon_link::StreamId;
    use rafcon_storage::journal::EventBlock;

    const STREAM: StreamId = StreamId(7);

    fn items(first: u64, count: u64, length: usize) -> EventBlock {
        EventBlock { first_sequence: first, count, time_before: 0, bytes: vec![0; length] }
    }

    fn passed(in_order: &mut InOrder, room: usize) -> Vec<u64> {
        let mut firsts = Vec::new();
        in_order.pass(STREAM, |items| {
            if firsts.len() == room {
                return Err(items);
            }
            firsts.push(items.first_sequence);
            Ok(())
        });
        firsts
    }

    #[test]
    fn what_arrives_in_any_order_is_passed_on_in_order() {
        let mut in_order = InOrder::default();
        for (first, count) in [(3, 2), (6, 1), (5, 1), (3, 1)] {
            assert_eq!(in_order.add(STREAM, items(first, count, 10), 0), None);
        }
        assert_eq!(passed(&mut in_order, 9), [0; 0]);
        in_order.add(STREAM, items(1, 2, 10), 0);
        assert_eq!(passed(&mut in_order, 2), [1, 3]);
        assert_eq!(in_order.waiting(), [STREAM]);
        assert_eq!(passed(&mut in_order, 9), [5, 6]);
        assert!(in_order.is_empty(STREAM) && in_order.bytes == 0);
    }

    #[test]
    fn what_waits_behind_a_gap_is_bounded_and_the_farthest_comes_again() {
        let (mut in_order, mut lost) = (InOrder::default(), Vec::new());
        for first in (2..200).rev() {
            lost.extend(in_order.add(STREAM, items(first, 1, 1 << 17), 0));
            assert!(in_order.bytes <= AHEAD_MAX);
        }
        let nearest = *lost.iter().map(std::ops::RangeInclusive::start).min().expect("losses");
        in_order.add(STREAM, items(1, 1, 1), 0);
        assert_eq!(passed(&mut in_order, 999), (1..nearest).collect::<Vec<_>>());
        assert_eq!(in_order.bytes, 0);
    }
}
