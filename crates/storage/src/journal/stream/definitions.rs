//! What the numbers in a stream of events stand for. Any thread may ask while another reads on.

use super::{PlaceHistory, StreamItem, VALUE_LIFE};
use crate::journal::record::{Place, PlaceNumber, Record, Stored, ValueNumber};
use crate::journal::telling::{Glossary, tell};
use crate::journal::{JournalError, Reader};
use rafcon_protocol::Event;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

/// So many bytes of values are kept in memory; the journal has the others.
const VALUES_BYTES_MAX: usize = 16 << 20;

/// The definitions of a stream. What was defined before it began, or is too much for the memory, is looked up in the journal.
#[derive(Debug, Default)]
pub struct StreamDefinitions {
    places: RwLock<PlaceHistory>,
    values: Mutex<SentValues>,
    journal: Mutex<LazyReader>,
}

#[derive(Debug, Default)]
struct SentValues {
    known: BTreeMap<ValueNumber, SentValue>,
    bytes: usize,
}

#[derive(Debug)]
struct SentValue {
    from: u64,
    stored: Arc<[u8]>,
}

/// The journal of the run, opened when it is needed.
#[derive(Debug, Default)]
struct LazyReader {
    folder: Option<PathBuf>,
    reader: Option<Reader>,
}

impl StreamDefinitions {
    /// None yet; the run's journal, if it has one, lies in `folder`.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { journal: Mutex::new(LazyReader { folder, reader: None }), ..Self::default() }
    }

    /// Learns what an item defines; gives back an event.
    pub fn learn<'b>(&self, item: StreamItem<'b>) -> Option<StreamItem<'b>> {
        match item {
            StreamItem::Place { from, number, place } => {
                let mut places = self.places.write().unwrap_or_else(PoisonError::into_inner);
                places.define(from, number, Arc::new(place));
                None
            }
            StreamItem::Value { from, number, stored } => {
                locked(&self.values).define(from, number, stored.into());
                None
            }
            event @ StreamItem::Event { .. } => Some(event),
        }
    }

    /// The record as an event. Without `values`, inputs and outputs are left out, and errors are short.
    pub fn event(
        &self,
        sequence: u64,
        record: Record,
        values: bool,
    ) -> Result<Event, JournalError> {
        tell(record, &DefinitionsAt { definitions: self, sequence }, values)
    }

    fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        let known = locked(&self.values).known.get(&number).map(|value| Arc::clone(&value.stored));
        match known.and_then(|bytes| Stored::from_bytes(&bytes).ok()) {
            Some(stored) => Ok(Some(stored)),
            None => locked(&self.journal).value(number),
        }
    }
}

impl SentValues {
    fn define(&mut self, from: u64, number: ValueNumber, stored: Arc<[u8]>) {
        self.bytes += stored.len();
        if let Some(before) = self.known.insert(number, SentValue { from, stored }) {
            self.bytes -= before.stored.len();
        }
        // A reader of what was sent may be behind by as much as a value lives.
        let is_old = |value: &SentValue| value.from.saturating_add(2 * VALUE_LIFE) < from;
        while let Some(oldest) = self.known.first_entry()
            && (self.bytes > VALUES_BYTES_MAX || is_old(oldest.get()))
        {
            self.bytes -= oldest.remove().stored.len();
        }
    }
}

impl LazyReader {
    fn value(&mut self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        if self.reader.is_none() {
            self.reader = self.folder.as_deref().and_then(|folder| Reader::open(folder).ok());
        }
        self.reader.as_ref().map_or(Ok(None), |reader| reader.value(number))
    }
}

/// The definitions as they were at one event.
#[derive(Debug)]
struct DefinitionsAt<'d> {
    definitions: &'d StreamDefinitions,
    sequence: u64,
}

impl Glossary for DefinitionsAt<'_> {
    fn place(&self, number: PlaceNumber) -> Option<Arc<Place>> {
        let places = self.definitions.places.read().unwrap_or_else(PoisonError::into_inner);
        places.at(number, self.sequence).cloned()
    }

    fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        self.definitions.value(number)
    }
}

/// What the lock guards is right whatever a thread died of while it had it: each change is one insertion.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
