//! Encodes events for the record: values by number, each defined once. This module knows the encoding, but not where
//! the bytes are stored.

use crate::record::blocks::{Encoded, Mark, Piece};
use crate::record::keep::{Keep, KeptValue};
use rafcon_storage::journal::stream::{NO_CONTENT, VALUE_LIFE};
use rafcon_storage::journal::{Batch, Kept, Left, Place, PlaceNumber, Record, ValueNumber};
use std::num::NonZeroU64;

/// The batch under construction. It is reused, and allocates nothing once it has reached its size.
#[derive(Debug)]
pub(crate) struct RecordEncoder {
    batch: Batch,
    /// The batch as a stream for viewers: definitions before the records that need them, values without content.
    stream: Vec<u8>,
    /// The number of the batch's first record.
    first: u64,
    rare: Vec<Piece>,
    /// The values of the next record.
    values: Vec<Kept>,
    /// Number of values that have numbers.
    numbered: u64,
}

/// The end of a state, without its values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StateEnd {
    pub(crate) place: PlaceNumber,
    pub(crate) outcome: i64,
    pub(crate) undoes: Option<NonZeroU64>,
}

impl RecordEncoder {
    /// An encoder that continues after record `last` at `t_ns`, with `numbered` numbered values.
    pub(crate) fn after(last: u64, t_ns: u64, numbered: u64) -> Self {
        Self {
            batch: Batch::new(t_ns),
            stream: Vec::new(),
            first: last + 1,
            rare: Vec::new(),
            values: Vec::new(),
            numbered,
        }
    }

    /// The number of the next record.
    pub(crate) fn next(&self) -> u64 {
        self.first + u64::from(self.batch.count())
    }

    /// The batch since the last [`RecordEncoder::clear`], for a journal.
    pub(crate) fn batch(&self) -> &Batch {
        &self.batch
    }

    /// The batch since the last [`RecordEncoder::clear`], for the memory.
    pub(crate) fn encoded(&self) -> Encoded<'_> {
        Encoded {
            bytes: &self.stream,
            count: u64::from(self.batch.count()),
            before_ns: self.batch.t_before(),
            last_ns: self.batch.t_last(),
            rare: &self.rare,
        }
    }

    /// Clears the batch after it was stored.
    pub(crate) fn clear(&mut self) {
        self.first = self.next();
        self.batch.clear();
        self.stream.clear();
        self.rare.clear();
    }

    /// Defines a place from the next record on. Every viewer receives the definition, because a rare record may name
    /// it.
    pub(crate) fn define(&mut self, number: PlaceNumber, place: &Place) {
        let mark = self.mark();
        self.stream.extend_from_slice(self.batch.define_place(number, place));
        self.rare.push(Piece { mark, end: self.stream.len() });
    }

    /// Adds a value to the next record.
    pub(crate) fn value(&mut self, value: &Keep<'_>) {
        let kept = self.kept(value);
        self.values.push(kept);
    }

    /// The record's form of a value. The value is defined on first use.
    pub(crate) fn kept(&mut self, value: &Keep<'_>) -> Kept {
        match value {
            Keep::Plain(kept) => kept.clone(),
            Keep::Stored(value) => Kept::Value(self.number(value)),
        }
    }

    fn number(&mut self, value: &KeptValue) -> ValueNumber {
        let next = self.next();
        value.number(next.saturating_sub(VALUE_LIFE)).unwrap_or_else(|| {
            self.numbered += 1;
            let number = ValueNumber(self.numbered);
            self.stream.extend_from_slice(self.batch.define_value(number, value.stored()));
            self.stream.extend_from_slice(&NO_CONTENT);
            value.set_number(number, next);
            number
        })
    }

    /// Adds an absent value to the next record.
    pub(crate) fn absent(&mut self) {
        self.values.push(Kept::Absent);
    }

    /// Writes the entry of a state, with the values added before.
    pub(crate) fn entered(&mut self, t_ns: u64, place: PlaceNumber, undoes: Option<NonZeroU64>) {
        let start = self.batch.records().len();
        self.batch.entered(t_ns, place, self.values.drain(..), undoes);
        self.stream.extend_from_slice(&self.batch.records()[start..]);
    }

    /// Writes the end of a state, with the values added before.
    pub(crate) fn left(&mut self, t_ns: u64, end: StateEnd, error: Option<&Kept>) {
        let StateEnd { place, outcome, undoes } = end;
        let start = self.batch.records().len();
        let left = Left { place, outcome, outputs: self.values.drain(..), error, undoes };
        self.batch.left(t_ns, left);
        self.stream.extend_from_slice(&self.batch.records()[start..]);
    }

    /// Writes a new value of a scoped variable.
    pub(crate) fn scoped(&mut self, t_ns: u64, place: PlaceNumber, port: u64, value: &Kept) {
        let start = self.batch.records().len();
        self.batch.scoped(t_ns, place, port, value);
        self.stream.extend_from_slice(&self.batch.records()[start..]);
    }

    /// Writes any other record.
    pub(crate) fn note(&mut self, t_ns: u64, record: &Record) {
        let mark = self.mark();
        let start = self.batch.records().len();
        self.batch.record(t_ns, record);
        self.stream.extend_from_slice(&self.batch.records()[start..]);
        if is_rare(record) {
            self.rare.push(Piece { mark, end: self.stream.len() });
        }
    }

    /// The beginning of the next item in the stream.
    fn mark(&self) -> Mark {
        Mark {
            sequence: u64::from(self.batch.count()),
            before_ns: self.batch.t_last(),
            start: self.stream.len(),
        }
    }
}

/// True if the record is also sent to viewers that request snapshots instead of every step.
pub(crate) fn is_rare(record: &Record) -> bool {
    match record {
        Record::Log { .. } | Record::Told(_) | Record::WentBack { .. } => true,
        Record::Entered { .. }
        | Record::Left { .. }
        | Record::Scoped { .. }
        | Record::Global { .. }
        | Record::Persistent { .. } => false,
    }
}

#[cfg(test)]
mod tests {
    use super::RecordEncoder;
    use crate::record::keep::{Keep, KeptValue};
    use rafcon_storage::journal::record::Content;
    use rafcon_storage::journal::stream::VALUE_LIFE;
    use rafcon_storage::journal::{Kept, PlaceNumber, Stored, ValueNumber};

    #[test]
    fn a_value_is_defined_once_for_the_records_that_can_name_it() {
        let stored = Stored {
            view: serde_json::json!([1, 2]),
            type_name: "list".into(),
            content: Content::View,
        };
        let value = KeptValue::new(stored);
        let mut writer = RecordEncoder::after(0, 0, 6);
        let mut name_after = |records| {
            for _ in 0..records {
                writer.entered(0, PlaceNumber(0), None);
            }
            writer.kept(&Keep::Stored(&value))
        };
        assert_eq!(name_after(0), Kept::Value(ValueNumber(7)));
        assert_eq!(name_after(VALUE_LIFE), Kept::Value(ValueNumber(7)));
        assert_eq!(name_after(1), Kept::Value(ValueNumber(8)));
    }
}
