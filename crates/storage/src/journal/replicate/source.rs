//! The events of a journal as items, each with the definitions that it is the first to need.

use super::ahead::{AHEAD_BYTES, Ahead};
use crate::journal::folder::ContentHash;
use crate::journal::read::{Reader, damaged};
use crate::journal::record::{
    Content, Definition, Item, Kept, PlaceNumber, Record, Stored, ValueNumber,
};
use crate::journal::{Entry, JournalError, Place};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;

/// After so many events it is noted what was defined before, so that reading may begin there.
const MARK_EVERY: u64 = 1_024;

/// Consecutive events of a journal with the definitions that they are the first to need.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EventItems {
    /// The number of the first event.
    pub first: u64,
    /// How many events they are.
    pub count: u64,
    /// The time of the event before them, in ns since the start of the run.
    pub t_before: u64,
    /// The items.
    pub bytes: Vec<u8>,
}

/// Reads a journal, which may grow, from any event on.
#[derive(Debug)]
pub struct EventSource {
    reader: Reader,
    /// What was defined before some events, in their order. The first one is the first event.
    marks: Vec<Before>,
    /// The same before the event that is probably read next.
    next: Before,
    /// What was read last.
    ahead: Option<Ahead>,
    /// Longer pickles are named by their hash.
    pickle_max: usize,
}

/// What is known before an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Before {
    sequence: u64,
    t_ns: u64,
    /// Values with this number or a higher one are not defined.
    value: u64,
}

const START: Before = Before { sequence: 1, t_ns: 0, value: 0 };

impl Before {
    /// What is known behind an event.
    fn behind(mut self, entry: &Entry) -> Self {
        (self.sequence, self.t_ns) = (entry.sequence + 1, entry.t_ns);
        entry.record.values(&mut |kept| {
            if let Kept::Value(number) = kept {
                self.value = self.value.max(number.0 + 1);
            }
        });
        self
    }
}

impl EventSource {
    /// The journal of the run in `folder`.
    pub fn open(folder: &Path) -> Result<Self, JournalError> {
        let (marks, next, ahead) = (vec![START], START, None);
        Ok(Self { reader: Reader::open(folder)?, marks, next, ahead, pickle_max: usize::MAX })
    }

    /// From now on pickles with more bytes are not among the items: they are named by their hash, as those that lie in files.
    #[must_use]
    pub fn without_pickles_over(mut self, bytes: usize) -> Self {
        self.pickle_max = bytes;
        self
    }

    /// The number of the last event that is safe on the disk.
    pub fn last(&self) -> Result<u64, JournalError> {
        self.reader.last_sequence()
    }

    /// The journal.
    pub fn reader(&mut self) -> &mut Reader {
        &mut self.reader
    }

    /// All definitions of places up to an event, each as items: the event that it comes before, and the items.
    pub fn places(&mut self, last: u64) -> Result<Vec<(u64, Vec<u8>)>, JournalError> {
        let places = self.reader.definitions(1..=last)?.into_iter();
        Ok(places
            .map(|(first, number, place)| {
                let mut items = Vec::new();
                define_place(number, place, &mut items);
                (first, items)
            })
            .collect())
    }

    /// Events from number `first` on, at most to `last`, and not more than `bytes_max` unless a single event is longer. Nothing if
    /// there are none; an error if they are damaged or were given up.
    pub fn read(
        &mut self,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Result<Option<EventItems>, JournalError> {
        let part = |ahead: &Ahead| ahead.part(first, last, bytes_max);
        if let Some(items) = self.ahead.as_ref().and_then(part) {
            return Ok(Some(items));
        }
        let mut ends = Vec::new();
        let read = self.read_ahead(first, last, bytes_max.max(AHEAD_BYTES), &mut ends)?;
        let Some(read) = read else { return Ok(None) };
        // All of it is given, if it fits. A single event may be long: it is not kept.
        if ends.len() == 1 || ends.iter().all(|(end, _)| *end <= bytes_max) {
            self.ahead = None;
            return Ok(Some(read));
        }
        let ahead = self.ahead.insert(Ahead::new(read, ends));
        Ok(ahead.part(first, last, bytes_max))
    }

    /// The same, with the end of each event: where its items end, and its time.
    fn read_ahead(
        &mut self,
        first: u64,
        last: u64,
        bytes_max: usize,
        ends: &mut Vec<(usize, u64)>,
    ) -> Result<Option<EventItems>, JournalError> {
        let mut before = self.known_before(first)?;
        let mut items = EventItems { first, count: 0, t_before: before.t_ns, bytes: Vec::new() };
        let places = self.reader.definitions(first..=last)?;
        let mut places = places.into_iter().peekable();
        let (mut lost, mut failed) = (None, None);
        let pickle_max = self.pickle_max;
        self.reader.each(first, |reader, entry| {
            if entry.sequence > last {
                return ControlFlow::Break(());
            }
            if let Some(range) = damaged(&entry.record) {
                lost = Some(range);
                return ControlFlow::Break(());
            }
            let length = items.bytes.len();
            while let Some((_, number, place)) =
                places.next_if(|(first, ..)| *first <= entry.sequence)
            {
                define_place(number, place, &mut items.bytes);
            }
            let from = (before.value, pickle_max);
            if let Err(error) = define_values(reader, &entry.record, from, &mut items.bytes) {
                items.bytes.truncate(length);
                failed = Some(error);
                return ControlFlow::Break(());
            }
            let behind = before.behind(&entry);
            let (mut t_before, t_ns) = (before.t_ns, entry.t_ns);
            Item::Record(t_ns, entry.record).write(&mut t_before, &mut items.bytes);
            if items.count > 0 && items.bytes.len() > bytes_max {
                items.bytes.truncate(length);
                return ControlFlow::Break(());
            }
            (before, items.count) = (behind, items.count + 1);
            ends.push((items.bytes.len(), t_ns));
            ControlFlow::Continue(())
        })?;
        if items.count > 0 {
            self.next = before;
            return Ok(Some(items));
        }
        match (failed, lost) {
            (Some(error), _) => Err(error),
            (None, Some((first, last))) => Err(self.reader.lost_events(first, last)),
            (None, None) => Ok(None),
        }
    }

    /// What is known before an event: from where it was known last, through the events between.
    fn known_before(&mut self, first: u64) -> Result<Before, JournalError> {
        if self.next.sequence == first {
            return Ok(self.next);
        }
        let place = self.marks.partition_point(|mark| mark.sequence <= first);
        let mark = self.marks.get(place.saturating_sub(1)).copied().unwrap_or(START);
        let mut before =
            if (mark.sequence..=first).contains(&self.next.sequence) { self.next } else { mark };
        let marks = &mut self.marks;
        if before.sequence < first {
            self.reader.each(before.sequence, |_, entry| {
                if entry.sequence >= first {
                    return ControlFlow::Break(());
                }
                before = before.behind(&entry);
                let newest = marks.last().map_or(0, |mark| mark.sequence);
                if before.sequence >= newest + MARK_EVERY {
                    marks.push(before);
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(before)
    }
}

fn define_place(number: PlaceNumber, place: Place, items: &mut Vec<u8>) {
    Item::Definition(Definition::Place(number, place)).write(&mut 0, items);
}

/// Defines the values of a record from this number on: lower ones were defined when they were named first.
fn define_values(
    reader: &Reader,
    record: &Record,
    (from, pickle_max): (u64, usize),
    items: &mut Vec<u8>,
) -> Result<(), JournalError> {
    let mut new = BTreeSet::new();
    record.values(&mut |kept| {
        if let Kept::Value(number) = kept
            && number.0 >= from
        {
            new.insert(number.0);
        }
    });
    for number in new.into_iter().map(ValueNumber) {
        let stored = reader.value(number)?.unwrap_or_else(|| Stored {
            view: serde_json::Value::Null,
            type_name: "".into(),
            content: Content::Nothing("the robot has dropped it to keep its journal small".into()),
        });
        let stored = elsewhere(stored, pickle_max);
        Item::Definition(Definition::Value(number, stored)).write(&mut 0, items);
    }
    Ok(())
}

/// The value without its pickle, if that is longer.
fn elsewhere(stored: Stored, pickle_max: usize) -> Stored {
    let content = match stored.content {
        Content::Pickle(pickle) if pickle.len() > pickle_max => {
            Content::File { hash: ContentHash::of(&pickle).name(), size: pickle.len() as u64 }
        }
        other => other,
    };
    Stored { content, ..stored }
}
