//! Definitions of the numbers in a stream of events. One thread can read the stream while others use the definitions.

use super::{StreamItem, VALUE_LIFE};
use crate::journal::record::protocol::{Glossary, tell};
use crate::journal::record::{Place, PlaceNumber, Record, Stored, ValueNumber};
use crate::journal::{JournalError, Reader};
use rafcon_protocol::Event;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

/// Maximum size of values in memory, in bytes. Other values are read from the journal.
const VALUES_BYTES_MAX: usize = 16 << 20;

/// Definitions of a stream. Earlier definitions, and values that exceed the memory limit, are read from the journal.
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

/// Journal of the run, opened at the first use.
#[derive(Debug, Default)]
struct LazyReader {
    folder: Option<PathBuf>,
    reader: Option<Reader>,
}

impl StreamDefinitions {
    /// Creates an empty set of definitions. `folder` contains the run's journal, if it has one.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { journal: Mutex::new(LazyReader { folder, reader: None }), ..Self::default() }
    }

    /// Stores the definition in an item. An event is returned.
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

    /// Converts the record to an event. Without `values`, inputs and outputs are omitted, and errors are shortened.
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
        // A reader may lag by the lifetime of a value.
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

/// Definitions that apply to one event.
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

/// Ignores poisoning: each change is one insertion, so the data stay valid when a thread panics.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Definitions of a place, each with the number of the first event that it applies to.
type Definitions = Vec<(u64, Arc<Place>)>;

/// All definitions of all places.
#[derive(Debug, Clone, Default)]
pub struct PlaceHistory {
    places: Vec<Definitions>,
}

/// Maximum number of places. A larger number is an error of its sender.
const PLACES_MAX: usize = 4 << 20;

impl PlaceHistory {
    /// Defines the number as `place` from event `from` on. Definitions may be repeated, in any order.
    pub fn define(&mut self, from: u64, number: PlaceNumber, place: Arc<Place>) {
        let index = number.0 as usize;
        if index >= PLACES_MAX {
            return;
        }
        if self.places.len() <= index {
            self.places.resize_with(index + 1, Vec::new);
        }
        let known = &mut self.places[index];
        let at = known.partition_point(|(first, _)| *first <= from);
        match at.checked_sub(1).and_then(|before| known.get_mut(before)) {
            Some((first, there)) if *first == from => *there = place,
            Some((_, there)) if *there == place => {}
            _ => known.insert(at, (from, place)),
        }
    }

    /// Returns the definition of the number at event `sequence`.
    pub fn at(&self, number: PlaceNumber, sequence: u64) -> Option<&Arc<Place>> {
        let definitions = self.places.get(number.0 as usize)?;
        let after = definitions.partition_point(|(from, _)| *from <= sequence);
        Some(&definitions.get(after.checked_sub(1)?)?.1)
    }

    /// Returns the latest definition of each place, by number. `None` for unused numbers.
    pub fn latest(&self) -> impl ExactSizeIterator<Item = (PlaceNumber, Option<&Arc<Place>>)> {
        let latest = self.places.iter().map(|known| known.last().map(|(_, place)| place));
        latest
            .enumerate()
            .map(|(number, place)| (PlaceNumber(u32::try_from(number).unwrap_or(u32::MAX)), place))
    }

    /// Returns all definitions by number, each with the first event that it applies to.
    pub fn all(&self) -> impl Iterator<Item = (PlaceNumber, u64, &Arc<Place>)> {
        (0..).map(PlaceNumber).zip(&self.places).flat_map(|(number, known)| {
            known.iter().map(move |(from, place)| (number, *from, place))
        })
    }
}
