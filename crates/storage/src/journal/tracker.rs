//! Follows the events that are safe, so that how the run stands can be kept now and then, and that it is known which values
//! are still named. Knows records; must never know the database.

use super::binary::Broken;
use super::frame::Frame;
use super::group::definitions;
use super::moment::Moment;
use super::record::{Content, Definition, Item, Items, Kept, Record, ValueNumber};
use std::collections::BTreeMap;

/// So many records lie between two keyframes, if they are small.
const RECORDS: u64 = 50_000;
/// So many keyframes are in a journal that is as large as it may be, at least.
const KEYFRAMES: u64 = 16;
/// Keyframes take this part of what lies between them at most.
const PART: usize = 4;

/// How a run stood, as the database keeps it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Keyframe {
    /// After which record.
    pub(super) sequence: u64,
    /// The moment.
    pub(super) data: Vec<u8>,
    /// The lowest number that no value had.
    pub(super) next_value: ValueNumber,
    /// Values older than the keyframe before that were named since, with the last record that did.
    pub(super) named: Vec<(ValueNumber, u64)>,
}

/// What is known after the last safe event.
#[derive(Debug)]
pub(super) struct Tracker {
    moment: Moment,
    pub(super) next_value: ValueNumber,
    /// The same at the last keyframe.
    floor: ValueNumber,
    named: BTreeMap<ValueNumber, u64>,
    /// Records since the last keyframe, and their bytes.
    records: u64,
    bytes: usize,
    /// The same with all values.
    weight: u64,
    /// Keyframes are no further apart.
    weight_max: u64,
    keyframe_bytes: usize,
}

impl Tracker {
    /// Goes on from `moment`; `next_value` is the number after that of the last value at the last keyframe. Keyframes are so close
    /// that a journal of at most `size_max` bytes has several.
    pub(super) fn new(moment: Moment, next_value: ValueNumber, size_max: u64) -> Self {
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

    /// Follows a frame.
    pub(super) fn follow(&mut self, frame: &Frame<'_>) -> Result<(), Broken> {
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

    /// A number gets its meaning.
    fn define(&mut self, definition: &Definition) {
        if let Definition::Value(number, stored) = definition {
            self.next_value = self.next_value.max(ValueNumber(number.0 + 1));
            if let Content::File { size, .. } = stored.content {
                self.weight += size;
            }
        }
        self.moment.define(definition);
    }

    /// Notes which values a record names.
    pub(super) fn note(&mut self, sequence: u64, record: &Record) {
        record.values(&mut |value| {
            if let Kept::Value(number) = value
                && *number < self.floor
            {
                self.named.insert(*number, sequence);
            }
        });
        self.records += 1;
    }

    /// How the run stands, if it is time to keep it.
    pub(super) fn keyframe(&mut self) -> Option<Keyframe> {
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
