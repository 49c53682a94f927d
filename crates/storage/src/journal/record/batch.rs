//! Events to be appended to a journal, in the journal's encoding. A batch is reused: once it has grown to its usual size, it
//! allocates nothing. Handles items, not their destination.

use super::binary::BinaryWriter;
use super::{Definition, Kept, Place, PlaceNumber, Record, Stored, ValueNumber};
use std::borrow::Borrow;
use std::num::NonZeroU64;

/// A group of events and the definitions of their numbers. It is stored completely or not at all.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Batch {
    pub(in crate::journal) definitions: Vec<u8>,
    pub(in crate::journal) records: Vec<u8>,
    pub(in crate::journal) count: u32,
    pub(in crate::journal) t_before: u64,
    pub(in crate::journal) t_last: u64,
}

impl Batch {
    /// Creates an empty batch. `t_ns` is the time of the last record before it, 0 in a new journal.
    pub fn new(t_ns: u64) -> Self {
        Self { t_before: t_ns, t_last: t_ns, ..Self::default() }
    }

    /// Removes all events for reuse.
    pub fn clear(&mut self) {
        self.definitions.clear();
        self.records.clear();
        self.count = 0;
        self.t_before = self.t_last;
    }

    /// Returns true if there are no events and no definitions.
    pub fn is_empty(&self) -> bool {
        self.count == 0 && self.definitions.is_empty()
    }

    /// Returns the number of records.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Returns the size in bytes.
    pub fn bytes(&self) -> usize {
        self.records.len() + self.definitions.len()
    }

    /// Returns the records as encoded [`crate::journal::Item`]s, without the definitions.
    pub fn records(&self) -> &[u8] {
        &self.records
    }

    /// Returns the time of the record before the batch. A reader of the records needs it.
    pub fn t_before(&self) -> u64 {
        self.t_before
    }

    /// Returns the time of the last record.
    pub fn t_last(&self) -> u64 {
        self.t_last
    }

    /// Adds a definition for all later records.
    pub fn define(&mut self, definition: &Definition) {
        match definition {
            Definition::Place(number, place) => {
                self.define_place(*number, place);
            }
            Definition::Value(number, stored) => {
                self.define_value(*number, stored);
            }
        }
    }

    /// Defines a place, and returns the bytes of the definition.
    pub fn define_place(&mut self, number: PlaceNumber, place: &Place) -> &[u8] {
        let start = self.definition();
        BinaryWriter::new(&mut self.definitions).place_definition(number, place);
        &self.definitions[start..]
    }

    /// Defines a value, and returns the bytes of the definition up to the content.
    pub fn define_value(&mut self, number: ValueNumber, stored: &Stored) -> &[u8] {
        let start = self.definition();
        let content = BinaryWriter::new(&mut self.definitions).value_definition(number, stored);
        &self.definitions[start..content]
    }

    /// Adds the entry of a state; see [`Record::Entered`].
    pub fn entered(
        &mut self,
        t_ns: u64,
        place: PlaceNumber,
        inputs: impl IntoIterator<Item = impl Borrow<Kept>>,
        undoes: Option<NonZeroU64>,
    ) {
        let delta = self.delta(t_ns);
        BinaryWriter::new(&mut self.records).entered(delta, place, inputs, undoes);
    }

    /// Adds the end of a state; see [`Record::Left`].
    pub fn left(&mut self, t_ns: u64, left: Left<'_, impl IntoIterator<Item = impl Borrow<Kept>>>) {
        let delta = self.delta(t_ns);
        BinaryWriter::new(&mut self.records).left(delta, left);
    }

    /// Adds the value of a scoped variable; see [`Record::Scoped`].
    pub fn scoped(&mut self, t_ns: u64, place: PlaceNumber, port: u64, value: &Kept) {
        let delta = self.delta(t_ns);
        BinaryWriter::new(&mut self.records).scoped(delta, place, port, value);
    }

    /// Adds a record of any kind.
    pub fn record(&mut self, t_ns: u64, record: &Record) {
        let delta = self.delta(t_ns);
        BinaryWriter::new(&mut self.records).record(delta, record);
    }

    /// Begins a definition with the number of records before it. Returns the offset of the definition.
    fn definition(&mut self) -> usize {
        BinaryWriter::new(&mut self.definitions).number(u64::from(self.count));
        self.definitions.len()
    }

    /// Counts a record. Returns the time since the previous one, at least 0.
    fn delta(&mut self, t_ns: u64) -> u64 {
        let delta = t_ns.saturating_sub(self.t_last);
        self.t_last += delta;
        self.count += 1;
        delta
    }
}

/// The end of a state; see [`Record::Left`].
#[derive(Debug)]
pub struct Left<'k, O> {
    /// Place of the state.
    pub place: PlaceNumber,
    /// Id of the outcome.
    pub outcome: i64,
    /// One value for each output port, in the order of the place's definition. Empty if values are not recorded.
    pub outputs: O,
    /// Error of the state, if it has one.
    pub error: Option<&'k Kept>,
    /// The entry that is undone, if the state was left backwards.
    pub undoes: Option<NonZeroU64>,
}
