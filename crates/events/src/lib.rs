//! Blocks of consecutive events of a run, from the robot's journal over the link to the station's replica.
//!
//! Knows numbers and bytes. Knows nothing of the encoding of events, of journals or of datagrams.

use std::ops::RangeInclusive;

/// Consecutive events of a run, as its journal encodes them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EventBlock {
    /// Number of the first event.
    pub first_sequence: u64,
    /// Number of events in `bytes`.
    pub count: u64,
    /// Time of the event before the block, in ns since the start of the run.
    pub time_before: u64,
    /// Encoded events, each with the definitions that it is the first to need.
    pub bytes: Vec<u8>,
}

/// An [`EventBlock`] whose bytes are borrowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EventBlockRef<'b> {
    /// Number of the first event.
    pub first_sequence: u64,
    /// Number of events in `bytes`.
    pub count: u64,
    /// Time of the event before the block, in ns since the start of the run.
    pub time_before: u64,
    /// Encoded events, each with the definitions that it is the first to need.
    pub bytes: &'b [u8],
}

impl EventBlock {
    /// Number of the last event.
    pub fn last_sequence(&self) -> u64 {
        self.view().last_sequence()
    }

    /// Numbers of the events.
    pub fn sequences(&self) -> RangeInclusive<u64> {
        self.view().sequences()
    }

    /// The block without a copy of its bytes.
    pub fn view(&self) -> EventBlockRef<'_> {
        let Self { first_sequence, count, time_before, bytes } = self;
        EventBlockRef {
            first_sequence: *first_sequence,
            count: *count,
            time_before: *time_before,
            bytes,
        }
    }
}

impl EventBlockRef<'_> {
    /// Number of the last event.
    pub fn last_sequence(&self) -> u64 {
        self.first_sequence + self.count - 1
    }

    /// Numbers of the events.
    pub fn sequences(&self) -> RangeInclusive<u64> {
        self.first_sequence..=self.last_sequence()
    }

    /// Copies the block.
    pub fn to_block(self) -> EventBlock {
        let Self { first_sequence, count, time_before, bytes } = self;
        EventBlock { first_sequence, count, time_before, bytes: bytes.to_vec() }
    }
}

#[cfg(test)]
mod tests {
    use super::EventBlock;

    #[test]
    fn a_block_has_the_numbers_of_its_events() {
        let block = EventBlock { first_sequence: 7, count: 3, time_before: 0, bytes: vec![1] };
        assert_eq!((block.last_sequence(), block.sequences()), (9, 7..=9));
        assert_eq!(block.view().to_block(), block);
    }
}
