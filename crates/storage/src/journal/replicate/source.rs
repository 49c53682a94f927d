//! Events of a journal as items, each with the definitions that it is the first to need.

use super::ahead::{AHEAD_BYTES, Ahead};
use crate::journal::folder::ContentHash;
use crate::journal::read::{Reader, damaged};
use crate::journal::record::{
    Content, Definition, Item, Kept, PlaceNumber, Record, Stored, ValueNumber,
};
use crate::journal::{Entry, JournalError, Place};
use rafcon_events::EventBlock;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;

/// Interval, in events, at which the current definitions are recorded, so that reading may start there.
const MARK_EVERY: u64 = 1_024;

/// Reader of a journal from any event on. The journal may grow.
#[derive(Debug)]
pub struct EventSource {
    reader: Reader,
    /// Positions before some events, sorted. The first is that of the first event.
    marks: Vec<Before>,
    /// Position before the event that is probably read next.
    next: Before,
    /// Events that were read ahead.
    ahead: Option<Ahead>,
    /// Maximum size of pickles among the items. Larger ones are named by their hash.
    pickle_max: usize,
}

/// Time and definitions before an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Before {
    sequence: u64,
    t_ns: u64,
    /// First number of the values that are not defined yet.
    value: u64,
}

const START: Before = Before { sequence: 1, t_ns: 0, value: 0 };

impl Before {
    /// Returns the position after an event.
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
    /// Opens the journal of the run in `folder`.
    pub fn open(folder: &Path) -> Result<Self, JournalError> {
        let (marks, next, ahead) = (vec![START], START, None);
        Ok(Self { reader: Reader::open(folder)?, marks, next, ahead, pickle_max: usize::MAX })
    }

    /// Excludes pickles of more bytes from the items. They are named by their hash, like those in files.
    #[must_use]
    pub fn without_pickles_over(mut self, bytes: usize) -> Self {
        self.pickle_max = bytes;
        self
    }

    /// Returns the number of the last event that survives a power cut.
    pub fn last(&self) -> Result<u64, JournalError> {
        self.reader.last_sequence()
    }

    /// Returns the underlying reader.
    pub fn reader(&mut self) -> &mut Reader {
        &mut self.reader
    }

    /// Returns all definitions of places up to an event. Each entry has the number of the event that it precedes, and the encoded
    /// items.
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

    /// Returns events from `first` to at most `last`, and at most `bytes_max` bytes unless a single event is longer. `None` if
    /// there are no such events. Fails if they are damaged or were deleted.
    pub fn read(
        &mut self,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Result<Option<EventBlock>, JournalError> {
        let part = |ahead: &Ahead| ahead.part(first, last, bytes_max);
        if let Some(block) = self.ahead.as_ref().and_then(part) {
            return Ok(Some(block));
        }
        let mut ends = Vec::new();
        let read = self.read_ahead(first, last, bytes_max.max(AHEAD_BYTES), &mut ends)?;
        let Some(read) = read else { return Ok(None) };
        // Everything that fits is returned. A single event may be long and is not stored.
        if ends.len() == 1 || ends.iter().all(|(end, _)| *end <= bytes_max) {
            self.ahead = None;
            return Ok(Some(read));
        }
        let ahead = self.ahead.insert(Ahead::new(read, ends));
        Ok(ahead.part(first, last, bytes_max))
    }

    /// Reads events with the end of each: the end of its items, and its time.
    fn read_ahead(
        &mut self,
        first: u64,
        last: u64,
        bytes_max: usize,
        ends: &mut Vec<(usize, u64)>,
    ) -> Result<Option<EventBlock>, JournalError> {
        let mut before = self.known_before(first)?;
        let (first_sequence, time_before) = (first, before.t_ns);
        let mut block = EventBlock { first_sequence, count: 0, time_before, bytes: Vec::new() };
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
            let length = block.bytes.len();
            while let Some((_, number, place)) =
                places.next_if(|(first, ..)| *first <= entry.sequence)
            {
                define_place(number, place, &mut block.bytes);
            }
            let (from, bytes) = (before.value, &mut block.bytes);
            if let Err(error) = define_values(reader, &entry.record, from, pickle_max, bytes) {
                block.bytes.truncate(length);
                failed = Some(error);
                return ControlFlow::Break(());
            }
            let behind = before.behind(&entry);
            let (mut t_before, t_ns) = (before.t_ns, entry.t_ns);
            Item::Record(t_ns, entry.record).write(&mut t_before, &mut block.bytes);
            if block.count > 0 && block.bytes.len() > bytes_max {
                block.bytes.truncate(length);
                return ControlFlow::Break(());
            }
            (before, block.count) = (behind, block.count + 1);
            ends.push((block.bytes.len(), t_ns));
            ControlFlow::Continue(())
        })?;
        if block.count > 0 {
            self.next = before;
            return Ok(Some(block));
        }
        match (failed, lost) {
            (Some(error), _) => Err(error),
            (None, Some((first, last))) => Err(self.reader.lost_events(first, last)),
            (None, None) => Ok(None),
        }
    }

    /// Returns the position before an event. Starts at the nearest recorded position and reads the events between.
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

/// Defines the values of a record from this number on. Lower ones were defined at their first use.
fn define_values(
    reader: &Reader,
    record: &Record,
    from: u64,
    pickle_max: usize,
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

/// Returns the value without its pickle, if that is longer.
fn elsewhere(stored: Stored, pickle_max: usize) -> Stored {
    let content = match stored.content {
        Content::Pickle(pickle) if pickle.len() > pickle_max => {
            Content::File { hash: ContentHash::of(&pickle).name(), size: pickle.len() as u64 }
        }
        other => other,
    };
    Stored { content, ..stored }
}
