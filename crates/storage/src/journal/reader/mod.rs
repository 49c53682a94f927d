//! Reads the journal of a run, whether it goes on, has ended or died: event by event, or as it stood at any of them.
//!
//! Knows what a journal holds. Writes nothing, and a run that goes on does not notice.

mod event;
mod extra;
mod picture;
mod source;
#[cfg(test)]
mod tests;

pub(super) use event::outcome_of;

use super::about::About;
use super::error::JournalError;
use super::lock::writer_of;
use super::moment::Moment;
use super::places::Places;
use super::record::{Definition, Item, Items, Place, PlaceNumber, Record, Stored, ValueNumber};
use extra::Extra;
use source::{Row, Source, Visit};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// How many rows count as the end of a journal.
const TAIL_ROWS: u64 = 4;

/// One event of a journal.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its number; the first is 1.
    pub sequence: u64,
    /// Time since the start of the run, in ns.
    pub t_ns: u64,
    /// What happened.
    pub record: Record,
}

/// An open journal.
#[derive(Debug)]
pub struct Reader {
    folder: PathBuf,
    about: About,
    source: Source,
    /// What a dead runner left beside the database.
    extra: Extra,
    defined: Vec<Defined>,
    /// Places are known up to this event.
    known_until: u64,
    /// As they were defined last.
    places: Places,
}

/// A place and the first event that it holds for.
#[derive(Debug, Clone, PartialEq)]
struct Defined {
    first: u64,
    number: PlaceNumber,
    place: Place,
}

impl Reader {
    /// Opens the journal in the run's folder.
    pub fn open(folder: &Path) -> Result<Self, JournalError> {
        let about = About::read(folder)?;
        let source = Source::open(folder)?;
        // Asked first: a run that ends in between has nothing but the database then.
        let is_live = writer_of(folder)?.is_some();
        let committed = source.last_sequence()?;
        let extra = if is_live { Extra::default() } else { Extra::read(folder, committed)? };
        Ok(Self {
            folder: folder.to_owned(),
            about,
            source,
            extra,
            defined: Vec::new(),
            known_until: 0,
            places: Places::default(),
        })
    }

    /// What the run is.
    pub fn about(&self) -> &About {
        &self.about
    }

    /// The run's folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Number of the last event; 0 if there is none. Events of a run that goes on count once they are safe from a power cut.
    pub fn last_sequence(&self) -> Result<u64, JournalError> {
        Ok(self.source.last_sequence()?.max(self.extra.last_sequence()))
    }

    /// The places of all events that were read so far, as they were defined last.
    pub fn known_places(&self) -> &Places {
        &self.places
    }

    /// At most `count` events, beginning with number `from`.
    pub fn page(&mut self, from: u64, count: usize) -> Result<Vec<Entry>, JournalError> {
        let mut page = Vec::new();
        if count > 0 {
            self.each(from, |_, entry| {
                page.push(entry);
                if page.len() < count { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            })?;
        }
        Ok(page)
    }

    /// Shows the events one after the other, beginning with number `from`, until `visit` has enough.
    pub fn each(
        &mut self,
        from: u64,
        mut visit: impl FnMut(&Self, Entry) -> ControlFlow<()>,
    ) -> Result<(), JournalError> {
        self.learn()?;
        let reader = &*self;
        let rows = |source: &Source, row: &mut Visit<'_>| source.rows(from, row);
        reader.read(from.max(1), rows, |entry| visit(reader, entry))
    }

    /// Number of the first event at this time or later; the number after the last if there is none.
    pub fn first_at(&mut self, t_ns: u64) -> Result<u64, JournalError> {
        let near = self.source.first_near(t_ns)?;
        let mut next = near.map_or_else(|| self.source.last_sequence().map(|last| last + 1), Ok)?;
        self.each(next, |_, entry| {
            if entry.t_ns >= t_ns {
                return ControlFlow::Break(());
            }
            next = entry.sequence + 1;
            ControlFlow::Continue(())
        })?;
        Ok(next)
    }

    /// The last events: those that lie together, and some before them.
    pub fn tail(&self) -> Result<Vec<Entry>, JournalError> {
        let mut tail = Vec::new();
        let keep = |entry| {
            tail.push(entry);
            ControlFlow::Continue(())
        };
        self.read(1, |source, row| source.last_rows(TAIL_ROWS, row), keep)?;
        Ok(tail)
    }

    /// Shows the events of some rows of the database and of all that was left beside it, from number `next` on.
    fn read(
        &self,
        mut next: u64,
        rows: impl FnOnce(&Source, &mut Visit<'_>) -> Result<ControlFlow<()>, JournalError>,
        mut visit: impl FnMut(Entry) -> ControlFlow<()>,
    ) -> Result<(), JournalError> {
        let mut broken = None;
        let mut row = |row: Row<'_>| match entries(&row, &mut next, &mut visit) {
            Ok(flow) => flow,
            Err(what) => {
                broken = Some(what);
                ControlFlow::Break(())
            }
        };
        if rows(&self.source, &mut row)?.is_continue() {
            for left in self.extra.rows() {
                if row(left).is_break() {
                    break;
                }
            }
        }
        broken.map_or(Ok(()), |what| Err(self.source.damaged(&what)))
    }

    /// How the run stood after event number `sequence`, or after the last one if there are fewer.
    pub fn moment(&mut self, sequence: u64) -> Result<Moment, JournalError> {
        self.learn()?;
        let sequence = sequence.min(self.last_sequence()?);
        let (mut before, mut nearly) = (sequence, None);
        loop {
            let keyframe = self.source.keyframe(before)?;
            if keyframe.is_none() && self.source.first_sequence()? > 1 {
                return nearly.ok_or_else(|| self.source.given_up());
            }
            let start = keyframe.as_ref().map_or(0, |(sequence, _)| *sequence);
            let places = self.places_at(start);
            let moment = match &keyframe {
                None => Some(self.forward(Moment::new(places), sequence)?),
                // One that cannot be read is as good as none: an earlier one leads there as well.
                Some((_, bytes)) => match Moment::from_bytes(bytes, places) {
                    Ok(moment) => Some(self.forward(moment, sequence)?),
                    Err(_) => None,
                },
            };
            match moment {
                Some(moment) if start == 0 || !moment.lacks_steps() => return Ok(moment),
                other => nearly = nearly.or(other),
            }
            before = start.saturating_sub(1 + (sequence - start));
        }
    }

    /// The value with this number; nothing if it was given up to keep the journal small.
    pub fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        match self.extra.value(number) {
            Some(stored) => Ok(Some(stored.clone())),
            None => self.source.value(number),
        }
    }

    /// Goes on from a moment to a later event.
    fn forward(&mut self, mut moment: Moment, sequence: u64) -> Result<Moment, JournalError> {
        let start = moment.sequence();
        if sequence <= start {
            return Ok(moment);
        }
        let defined = std::mem::take(&mut self.defined);
        let mut later = defined.iter().skip_while(|defined| defined.first <= start).peekable();
        let gone = self.each(start + 1, |_, entry| {
            while let Some(defined) = later.next_if(|defined| defined.first <= entry.sequence) {
                moment.define(&Definition::Place(defined.number, defined.place.clone()));
            }
            if entry.sequence <= sequence {
                moment.apply(entry.sequence, entry.t_ns, &entry.record);
            }
            if entry.sequence < sequence {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        self.defined = defined;
        gone.map(|()| moment)
    }

    fn places_at(&self, sequence: u64) -> Places {
        let mut places = Places::default();
        for defined in self.defined.iter().take_while(|defined| defined.first <= sequence) {
            places.define(defined.number, defined.place.clone());
        }
        places
    }

    /// Learns the places that were defined since.
    fn learn(&mut self) -> Result<(), JournalError> {
        let last = self.last_sequence()?;
        if last <= self.known_until {
            return Ok(());
        }
        let mut fresh = self.source.places_after(self.known_until)?;
        fresh.extend(self.extra.places_after(self.known_until));
        fresh.sort_by_key(|defined| defined.first);
        for defined in &fresh {
            self.places.define(defined.number, defined.place.clone());
        }
        self.defined.append(&mut fresh);
        self.known_until = last;
        Ok(())
    }
}

/// Shows the events of one row, from number `next` on; `next` becomes the number after the last.
fn entries(
    row: &Row<'_>,
    next: &mut u64,
    visit: &mut impl FnMut(Entry) -> ControlFlow<()>,
) -> Result<ControlFlow<()>, String> {
    for (sequence, item) in (row.first..).zip(Items::new(row.data, row.t_before)) {
        match item.map_err(|broken| format!("event {sequence}: {broken}"))? {
            Item::Record(t_ns, record) if sequence >= *next => {
                *next = sequence + 1;
                if visit(Entry { sequence, t_ns, record }).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
            _ => {}
        }
    }
    Ok(ControlFlow::Continue(()))
}
