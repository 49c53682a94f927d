//! Processes committed events to create keyframes of the run at intervals, and to determine which values are still in use. Handles
//! records, not the database.

use super::Moment;
use crate::journal::record::frame::{Frame, definitions};
use crate::journal::record::{Broken, Content, Definition, Item, Items, Kept, Record, ValueNumber};
use std::collections::BTreeMap;

/// Number of records between two keyframes, if the records are small.
const RECORDS: u64 = 50_000;
/// Minimum number of keyframes in a journal of the maximum size.
const KEYFRAMES: u64 = 16;
/// Minimum ratio of the size of the records between two keyframes to the size of a keyframe.
const PART: usize = 4;

/// A moment that the database stores.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::journal) struct Keyframe {
    /// Number of the moment's last record.
    pub(in crate::journal) sequence: u64,
    /// The whole moment, encoded.
    pub(in crate::journal) data: Vec<u8>,
    /// Lowest unused number of a value.
    pub(in crate::journal) next_value: ValueNumber,
    /// Values older than the previous keyframe that later records used, each with the last such record.
    pub(in crate::journal) named: Vec<(ValueNumber, u64)>,
}

/// State of the run after the last committed event.
#[derive(Debug)]
pub(in crate::journal) struct Tracker {
    moment: Moment,
    pub(in crate::journal) next_value: ValueNumber,
    /// `next_value` at the last keyframe.
    floor: ValueNumber,
    named: BTreeMap<ValueNumber, u64>,
    /// Number of records since the last keyframe, and their size in bytes.
    records: u64,
    bytes: usize,
    /// Size in bytes including all values.
    weight: u64,
    /// Maximum weight between two keyframes.
    weight_max: u64,
    keyframe_bytes: usize,
}

impl Tracker {
    /// Continues from `moment`. `next_value` is the number after the last value at the last keyframe. The interval between
    /// keyframes depends on `size_max`, so that a journal of that size has several.
    pub(in crate::journal) fn new(moment: Moment, next_value: ValueNumber, size_max: u64) -> Self {
        Self {
            moment,
            next_value,
            floor: next_value,
            named: BTreeMap::new(),
            records: 0,
            bytes: 0,
            weight: 0,
            weight_max: size_max / KEYFRAMES,
            keyframe_bytes: 0,
        }
    }

    /// Applies the records of a frame.
    pub(in crate::journal) fn follow(&mut self, frame: &Frame<'_>) -> Result<(), Broken> {
        let mut definitions = definitions(frame).peekable();
        let items = Items::new(frame.records, frame.head.t_before);
        for (sequence, item) in (frame.head.first..).zip(items) {
            while let Some(definition) = definitions
                .next_if(|next| next.as_ref().map_or(true, |(first, _)| *first <= sequence))
            {
                self.define(&definition?.1);
            }
            if let Item::Record(t_ns, record) = item? {
                self.note(sequence, &record);
                self.moment.apply(sequence, t_ns, &record);
            }
        }
        for definition in definitions {
            self.define(&definition?.1);
        }
        self.bytes += frame.records.len();
        self.weight += (frame.records.len() + frame.definitions.len()) as u64;
        Ok(())
    }

    /// Processes a definition of a place or value.
    fn define(&mut self, definition: &Definition) {
        if let Definition::Value(number, stored) = definition {
            self.next_value = self.next_value.max(ValueNumber(number.0 + 1));
            if let Content::File { size, .. } = stored.content {
                self.weight += size;
            }
        }
        self.moment.define(definition);
    }

    /// Records the use of the values in a record.
    pub(in crate::journal) fn note(&mut self, sequence: u64, record: &Record) {
        record.values(&mut |value| {
            if let Kept::Value(number) = value
                && *number < self.floor
            {
                self.named.insert(*number, sequence);
            }
        });
        self.records += 1;
    }

    /// Returns a keyframe if one is due.
    pub(in crate::journal) fn keyframe(&mut self) -> Option<Keyframe> {
        let is_far = self.records >= RECORDS || self.weight >= self.weight_max;
        let is_due = is_far && self.bytes >= PART * self.keyframe_bytes;
        is_due.then(|| {
            let data = self.moment.to_bytes();
            (self.records, self.bytes, self.weight) = (0, 0, 0);
            self.keyframe_bytes = data.len();
            self.floor = self.next_value;
            Keyframe {
                sequence: self.moment.sequence(),
                data,
                next_value: self.next_value,
                named: std::mem::take(&mut self.named).into_iter().collect(),
            }
        })
    }
}
