//! Follows the committed events, to store keyframes of the run now and then, and to know which values
//! are still in use. Knows records; knows nothing of the database.

use super::Moment;
use crate::journal::record::frame::{Frame, definitions};
use crate::journal::record::{Broken, Content, Definition, Item, Items, Kept, Record, ValueNumber};
use std::collections::BTreeMap;

/// The number of records between two keyframes, if the records are small.
const RECORDS: u64 = 50_000;
/// The minimum number of keyframes in a journal of the maximum size.
const KEYFRAMES: u64 = 16;
/// The records between two keyframes are at least this many times as large as a keyframe.
const PART: usize = 4;

/// A moment that the database keeps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::journal) struct Keyframe {
    /// The number of its last record.
    pub(in crate::journal) sequence: u64,
    /// The moment.
    pub(in crate::journal) data: Vec<u8>,
    /// The lowest unused number of a value.
    pub(in crate::journal) next_value: ValueNumber,
    /// Values older than the previous keyframe that records used since, each with the last such record.
    pub(in crate::journal) named: Vec<(ValueNumber, u64)>,
}

/// The state of the run after the last committed event.
#[derive(Debug)]
pub(in crate::journal) struct Tracker {
    moment: Moment,
    pub(in crate::journal) next_value: ValueNumber,
    /// Its value at the last keyframe.
    floor: ValueNumber,
    named: BTreeMap<ValueNumber, u64>,
    /// The number of records since the last keyframe, and their bytes.
    records: u64,
    bytes: usize,
    /// The bytes including all values.
    weight: u64,
    /// The maximum weight between two keyframes.
    weight_max: u64,
    keyframe_bytes: usize,
}

impl Tracker {
    /// Continues from `moment`; `next_value` is the number after the last value at the last keyframe. The distance of keyframes
    /// depends on `size_max`, so that a journal of that many bytes has several.
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

    /// Takes a definition.
    fn define(&mut self, definition: &Definition) {
        if let Definition::Value(number, stored) = definition {
            self.next_value = self.next_value.max(ValueNumber(number.0 + 1));
            if let Content::File { size, .. } = stored.content {
                self.weight += size;
            }
        }
        self.moment.define(definition);
    }

    /// Notes the values in a record.
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

    /// The keyframe that is due, if one is.
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
