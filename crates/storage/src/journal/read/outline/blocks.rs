//! A run as a limited number of blocks of events. A block has the calls in it by row, and the calls that started before it. As the
//! run grows, pairs of blocks are merged. Handles calls, not their drawing.

use super::calls::{BarRow, Call};
use crate::journal::record::PlaceNumber;
use rafcon_protocol::api::CallEnd;
use std::collections::BTreeMap;

/// Maximum number of blocks.
const BLOCKS_MAX: usize = 4096;
/// Initial number of events in a block.
const EVENTS: u64 = 1024;

/// The blocks of a run.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
    done: Vec<Block>,
    current: Block,
    /// Current number of events in a block.
    every: u64,
}

/// Consecutive events of a run.
#[derive(Debug, Clone, Default)]
pub(super) struct Block {
    /// Number of the first event. 0 if the block is empty.
    pub(super) first: u64,
    pub(super) last: u64,
    pub(super) from_ns: u64,
    pub(super) to_ns: u64,
    /// Calls that started and ended in the block, combined by row.
    rows: BTreeMap<BarRow, RowSum>,
    /// Calls that ended in the block and started before it.
    crossing: Vec<Call>,
}

/// Consecutive calls of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowSum {
    pub(super) row: BarRow,
    /// Place, entry and end of the first call.
    pub(super) place: PlaceNumber,
    pub(super) first: u64,
    pub(super) from_ns: u64,
    pub(super) to_ns: u64,
    pub(super) many: u64,
    pub(super) failed: u64,
    pub(super) end: CallEnd,
}

impl Default for Blocks {
    fn default() -> Self {
        Self { done: Vec::new(), current: Block::default(), every: EVENTS }
    }
}

impl Blocks {
    /// Adds an event to the current block.
    pub(super) fn event(&mut self, sequence: u64, t_ns: u64) {
        if self.current.first != 0 && sequence >= self.current.first + self.every {
            self.done.push(std::mem::take(&mut self.current));
            if self.done.len() >= BLOCKS_MAX {
                self.halve();
            }
        }
        let block = &mut self.current;
        if block.first == 0 {
            (block.first, block.from_ns) = (sequence, t_ns);
        }
        (block.last, block.to_ns) = (sequence, t_ns);
    }

    /// Adds a call that the event ended.
    pub(super) fn ended(&mut self, call: Call) {
        self.current.add(call);
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Block> {
        self.done.iter().chain((self.current.first != 0).then_some(&self.current))
    }

    fn halve(&mut self) {
        let mut joined: Vec<Block> = Vec::with_capacity(BLOCKS_MAX / 2);
        for block in std::mem::take(&mut self.done) {
            match joined.last_mut() {
                Some(last) if last.last - last.first < self.every => last.join(block),
                _ => joined.push(block),
            }
        }
        self.done = joined;
        self.every *= 2;
    }
}

impl Block {
    pub(super) fn rows(&self) -> impl Iterator<Item = &RowSum> {
        self.rows.values()
    }

    pub(super) fn crossing(&self) -> impl Iterator<Item = &Call> {
        self.crossing.iter()
    }

    fn add(&mut self, call: Call) {
        if call.first < self.first {
            self.crossing.push(call);
            return;
        }
        let Call { place, row, first, from_ns, to_ns, end } = call;
        let to_ns = to_ns.unwrap_or(from_ns);
        let failed = u64::from(end == CallEnd::Aborted);
        self.sum(&RowSum { row, place, first, from_ns, to_ns, many: 1, failed, end });
    }

    fn sum(&mut self, more: &RowSum) {
        let sum = self.rows.entry(more.row).or_insert(RowSum { many: 0, failed: 0, ..*more });
        if more.first < sum.first {
            *sum = RowSum { many: sum.many, failed: sum.failed, to_ns: sum.to_ns, ..*more };
        }
        sum.to_ns = sum.to_ns.max(more.to_ns);
        sum.many += more.many;
        sum.failed += more.failed;
    }

    fn join(&mut self, later: Self) {
        (self.last, self.to_ns) = (later.last, later.to_ns);
        later.rows.values().for_each(|sum| self.sum(sum));
        later.crossing.into_iter().for_each(|call| self.add(call));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_the_bound_two_blocks_become_one_and_no_call_is_lost() {
        let (place, step) = (PlaceNumber(0), EVENTS);
        let mut blocks = Blocks::default();
        let most = u64::try_from(BLOCKS_MAX).unwrap();
        let counts = |blocks: &Blocks| {
            let calls = blocks.all().flat_map(Block::rows).map(|sum| sum.many).sum::<u64>();
            (blocks.all().count(), blocks.every, calls)
        };
        let mut happen = |numbers: std::ops::Range<u64>| {
            for number in numbers {
                let (first, from_ns) = (1 + number * step, number);
                blocks.event(first, from_ns);
                let (row, end) = (BarRow::Of(place), CallEnd::Ended);
                blocks.ended(Call { place, row, first, from_ns, to_ns: Some(from_ns), end });
            }
            counts(&blocks)
        };
        assert_eq!(happen(0..most), (BLOCKS_MAX, step, most));
        assert_eq!(happen(most..most + 1), (BLOCKS_MAX / 2 + 1, 2 * step, most + 1));
        let (count, every, calls) = happen(most + 1..10 * most);
        assert!(count <= BLOCKS_MAX, "{count} blocks");
        assert_eq!((every, calls), (16 * step, 10 * most));
    }
}
