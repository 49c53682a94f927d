//! Records in the words of the protocol, for one viewer. Knows names and where values lie; must never know who listens.

use crate::archive::Archive;
use crate::recorder::Recorder;
use rafcon_protocol::Event;
use rafcon_storage::journal::{
    Glossary, JournalError, Place, PlaceNumber, Record, Stored, ValueNumber, tell,
};
use std::cell::{Cell, RefCell};
use std::sync::Arc;

/// Puts records into words.
pub(crate) struct RecordRenderer<'w> {
    recorder: &'w Recorder,
    archive: RefCell<&'w mut Archive>,
    /// Whether the viewer wants values.
    values: bool,
    /// The record that is put into words.
    sequence: Cell<u64>,
}

impl<'w> RecordRenderer<'w> {
    /// With names from the record, and with values from the archive if the viewer wants them.
    pub(crate) fn new(recorder: &'w Recorder, archive: &'w mut Archive, values: bool) -> Self {
        Self { recorder, archive: RefCell::new(archive), values, sequence: Cell::new(0) }
    }

    /// The record as an event; nothing if it is only about values and the viewer wants none.
    pub(crate) fn event(&self, sequence: u64, record: Record) -> Option<Event> {
        if !self.values && is_about_values(&record) {
            return None;
        }
        self.sequence.set(sequence);
        tell(record, self, self.values).ok()
    }
}

impl Glossary for RecordRenderer<'_> {
    fn place(&self, number: PlaceNumber) -> Option<Arc<Place>> {
        self.recorder.names().at(number, self.sequence.get())
    }

    fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        self.archive.borrow_mut().value(self.recorder.folder(), number)
    }
}

fn is_about_values(record: &Record) -> bool {
    match record {
        Record::Scoped { .. } | Record::Global { .. } | Record::Persistent { .. } => true,
        Record::Entered { .. }
        | Record::Left { .. }
        | Record::Log { .. }
        | Record::WentBack { .. }
        | Record::Told(_) => false,
    }
}
