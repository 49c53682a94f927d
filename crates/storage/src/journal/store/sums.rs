//! Checksums of rows, to detect damage. Handles names of tables, not `SQLite`.

use super::group::Block;
use std::fmt;

/// Checksum of a row, over the name of its table and all its columns.
#[derive(Debug)]
pub(in crate::journal) struct Sum(crc32fast::Hasher);

impl Sum {
    /// Starts with the name of the table.
    pub(in crate::journal) fn of(table: &str) -> Self {
        Self(crc32fast::Hasher::new()).bytes(table.as_bytes())
    }

    /// Adds a number to the checksum.
    pub(in crate::journal) fn number(mut self, number: i64) -> Self {
        self.0.update(&number.to_le_bytes());
        self
    }

    /// Adds bytes to the checksum.
    pub(in crate::journal) fn bytes(self, bytes: &[u8]) -> Self {
        let mut longer = self.number(i64::try_from(bytes.len()).unwrap_or(i64::MAX));
        longer.0.update(bytes);
        longer
    }

    /// Adds bytes to the checksum, if there are any.
    pub(in crate::journal) fn maybe(self, bytes: Option<&[u8]>) -> Self {
        match bytes {
            Some(bytes) => self.number(1).bytes(bytes),
            None => self.number(0),
        }
    }

    pub(in crate::journal) fn done(self) -> i64 {
        i64::from(self.0.finalize())
    }
}

/// Numbers of a row of events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::journal) struct RowHeader {
    pub(in crate::journal) first: i64,
    pub(in crate::journal) count: i64,
    pub(in crate::journal) t_before: i64,
    pub(in crate::journal) t_last: i64,
}

impl RowHeader {
    pub(in crate::journal) fn of(block: &Block) -> Self {
        let numbers = [block.first, block.count, block.t_before, block.t_last];
        let [first, count, t_before, t_last] = numbers.map(u64::cast_signed);
        Self { first, count, t_before, t_last }
    }

    /// Returns the checksum of a row. The upper half is the sum of its events. The lower half is the sum of its numbers and the
    /// upper half, so that the numbers can be checked without the events.
    pub(in crate::journal) fn sum(self, data: &[u8]) -> i64 {
        let data = i64::from(crc32fast::hash(data));
        (data << 32) | self.low(data)
    }

    /// Returns true if the numbers match this checksum.
    pub(in crate::journal) fn fits(self, sum: i64) -> bool {
        let [data, low] = [sum.cast_unsigned() >> 32, sum.cast_unsigned() & 0xffff_ffff];
        self.low(data.cast_signed()) == low.cast_signed() && self.is_possible()
    }

    /// Returns true if the numbers are valid.
    pub(in crate::journal) fn is_possible(self) -> bool {
        self.first > 0 && self.count > 0 && self.first.checked_add(self.count).is_some()
    }

    fn low(self, data: i64) -> i64 {
        let Self { first, count, t_before, t_last } = self;
        let numbers = [first, count, t_before, t_last, data].into_iter();
        numbers.fold(Sum::of("blocks"), Sum::number).done()
    }
}

/// Returns the checksum of a place.
pub(in crate::journal) fn of_place(nth: i64, number: i64, first: i64, data: &[u8]) -> i64 {
    Sum::of("places").number(nth).number(number).number(first).bytes(data).done()
}

/// Returns the checksum of a value.
pub(in crate::journal) fn of_value(number: i64, hash: Option<&[u8]>, data: Option<&[u8]>) -> i64 {
    Sum::of("vals").number(number).maybe(hash).maybe(data).done()
}

/// Returns the checksum of a keyframe.
pub(in crate::journal) fn of_keyframe(sequence: i64, next_value: i64, data: &[u8]) -> i64 {
    Sum::of("keyframes").number(sequence).number(next_value).bytes(data).done()
}

/// Returns the checksum of a row with one number.
pub(in crate::journal) fn of_number(table: &str, number: i64) -> i64 {
    Sum::of(table).number(number).done()
}

/// Extent of checksums in a journal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::journal) enum Checked {
    /// No row has a checksum, because an earlier version wrote the journal.
    Never,
    /// All rows but those that an earlier version wrote have checksums.
    Partly,
    /// All rows have checksums.
    Always,
}

impl Checked {
    /// Returns true if a row with the checksum `sum` is undamaged, or if it has none. `right` computes the expected sum.
    pub(in crate::journal) fn is_right(
        self,
        sum: Option<i64>,
        right: impl FnOnce() -> i64,
    ) -> bool {
        match sum {
            Some(sum) => sum == right(),
            None => self != Self::Always,
        }
    }
}

/// A damaged part of a journal.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::journal) enum Damage {
    /// Events between these two numbers, inclusive.
    Events(u64, u64),
    /// The unknown number of events after this one in the recorder.
    Recorder(u64),
    /// The value with this number.
    Value(u64),
    /// The keyframe after this event.
    Keyframe(u64),
    /// The definitions of places.
    Places,
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Events(first, last) if first == last => write!(f, "event {first} cannot be read"),
            Self::Events(first, last) => write!(f, "events {first} to {last} cannot be read"),
            Self::Recorder(first) => {
                write!(f, "events from {first} on may be missing: the recorder cannot be read")
            }
            Self::Value(number) => write!(f, "value {number} cannot be read"),
            Self::Keyframe(sequence) => {
                write!(f, "the moment kept after event {sequence} cannot be read")
            }
            Self::Places => f.write_str("the definition of a state cannot be read"),
        }
    }
}
