//! Events that a dead runner left in its recorder after the last event of the database, as rows of the database.

use super::Defined;
use super::source::Row;
use crate::journal::folder::JournalError;
use crate::journal::record::frame::definitions;
use crate::journal::record::{Definition, Stored, ValueNumber};
use crate::journal::store::leftovers::{Leftovers, Marks};
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Debug, Default)]
pub(super) struct Extra {
    rows: Vec<OwnRow>,
    places: Vec<Defined>,
    values: BTreeMap<ValueNumber, Stored>,
    last_sequence: u64,
    /// Marks of the recorder about the end of the journal.
    pub(super) marks: Marks,
}

#[derive(Debug)]
struct OwnRow {
    first: u64,
    t_before: u64,
    data: Vec<u8>,
}

impl Extra {
    /// Reads the events of the run in `folder` after event number `committed`, or after the end that the database has lost.
    pub(super) fn read(folder: &Path, committed: u64) -> Result<Self, JournalError> {
        let leftovers = Leftovers::read(folder)?;
        let mut extra = Self { marks: leftovers.marks(), ..Self::default() };
        let committed = leftovers.lacks(committed).unwrap_or(committed);
        for frame in leftovers.frames(committed) {
            for (first, definition) in definitions(&frame).flatten() {
                match definition {
                    Definition::Place(number, place) => {
                        extra.places.push(Defined { first, number, place });
                    }
                    Definition::Value(number, stored) => drop(extra.values.insert(number, stored)),
                }
            }
            let (first, t_before) = (frame.head.first, frame.head.t_before);
            extra.rows.push(OwnRow { first, t_before, data: frame.records.to_vec() });
            extra.last_sequence = frame.head.next() - 1;
        }
        Ok(extra)
    }

    pub(super) fn last_sequence(&self) -> u64 {
        self.last_sequence
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|row| Row {
            first: row.first,
            t_before: row.t_before,
            data: &row.data,
        })
    }

    pub(super) fn places(&self) -> &[Defined] {
        &self.places
    }

    pub(super) fn value(&self, number: ValueNumber) -> Option<&Stored> {
        self.values.get(&number)
    }
}
