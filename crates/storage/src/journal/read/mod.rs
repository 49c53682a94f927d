//! Reads the journal of a run that is active, ended or died: event by event, or the state of the run after any of them.
//!
//! Writes nothing, and does not disturb an active run.

mod filter;
mod found;
mod hits;
mod outline;
mod statistics;
mod summary;

pub use filter::{Filter, FilterState, KINDS, kind, kind_of, path_of, place_of};
pub use found::{Found, Looked, Search, is_about_values};
pub use outline::{Outline, Span};
pub use statistics::Tally;
pub use summary::{RunState, Summary, run_folders, runs, size_of};

mod end;
mod event;
mod extra;
mod picture;
mod source;
mod way;

pub(super) use event::outcome_of;

use crate::journal::folder::{About, DATABASE_FILE, Doing, JournalError, VALUES_FOLDER, writer_of};
use crate::journal::moment::Moment;
use crate::journal::record::{
    Content, Definition, Kept, Place, PlaceNumber, Places, Record, Stored, ValueNumber,
};
use crate::journal::store::leftovers::Marks;
use crate::journal::store::sums::{Checked, Damage};
use extra::Extra;
use rafcon_protocol::Event;
use source::{Row, Source, Visit};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::ops::{ControlFlow, RangeInclusive};
use std::path::{Path, PathBuf};
use way::Values;

/// Number of rows that count as the end of a journal.
const TAIL_ROWS: u64 = 4;

/// One event of a journal.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Number of the event, counted from 1.
    pub sequence: u64,
    /// Time since the start of the run, in ns.
    pub t_ns: u64,
    /// Content of the event.
    pub record: Record,
}

/// Reader of a run's journal: events, values and moments.
#[derive(Debug)]
pub struct Reader {
    folder: PathBuf,
    about: About,
    source: Source,
    /// Events that a dead runner left beside the database.
    extra: Extra,
    defined: Vec<Defined>,
    /// Number of those definitions that are in the database.
    defined_there: u64,
    /// Last event whose places are known.
    known_until: u64,
    /// Latest definition of each place.
    places: Places,
    /// First event with unknown places, because a definition cannot be read.
    doubtful_from: Option<u64>,
    is_live: bool,
    end: JournalEnd,
    /// Damage found until now.
    damage: RefCell<BTreeSet<Damage>>,
}

/// Knowledge about the last event of a run that is not active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum JournalEnd {
    /// Nothing beyond the content of the files.
    Open,
    /// At least this number.
    At(u64),
    /// A recorded number that cannot be read.
    Damaged,
}

/// The definition of a place and the first event that it applies to.
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
        // Checked before the recorder is read: a run that ends in between has only the database.
        let is_live = writer_of(folder)?.is_some();
        let extra =
            if is_live { Extra::default() } else { Extra::read(folder, source.last_sequence()?)? };
        let end = if is_live { JournalEnd::Open } else { end(&source, &extra)? };
        Ok(Self {
            folder: folder.to_owned(),
            about,
            source,
            extra,
            defined: Vec::new(),
            defined_there: 0,
            known_until: 0,
            places: Places::default(),
            doubtful_from: None,
            is_live,
            end,
            damage: RefCell::default(),
        })
    }

    /// Returns messages about the damage found until now. Parts that were not read were not checked.
    pub fn damage(&self) -> Vec<String> {
        self.damage.borrow().iter().map(|damage| format!("{DATABASE_FILE}: {damage}")).collect()
    }

    /// Fails if damage was found. The error lists it.
    pub fn check(&self) -> Result<(), JournalError> {
        let found: Vec<String> = self.damage.borrow().iter().map(Damage::to_string).collect();
        if found.is_empty() { Ok(()) } else { Err(self.source.damaged(&shortened(&found))) }
    }

    /// Returns an error: these events cannot be read, with the consequence `what`.
    pub(super) fn lost(&self, first: u64, last: u64, what: &str) -> JournalError {
        self.source.damaged(&format!("{}, so {what}", Damage::Events(first, last)))
    }

    /// Fails if event number `sequence` is in the damaged range `found`.
    pub fn check_event(&self, sequence: u64, found: Option<&Entry>) -> Result<(), JournalError> {
        match found.and_then(|entry| damaged(&entry.record)) {
            Some((first, last)) if (first..=last).contains(&sequence) => {
                Err(self.source.damaged(&Damage::Events(first, last).to_string()))
            }
            _ => Ok(()),
        }
    }

    /// Checks that global variables and persistent data of a moment are unchanged since they were written. Data of states needs no
    /// such check: a state that needs an unrestorable value gets an error instead.
    pub fn check_values(&self, moment: &Moment) -> Result<(), JournalError> {
        let remembered = moment.persistent().map(|(_, value)| value);
        for kept in moment.globals().values().chain(remembered) {
            let Kept::Value(number) = kept else { continue };
            if let Some(Stored { content: Content::File { hash, .. }, .. }) = self.value(*number)? {
                self.check_file(&hash)?;
            }
        }
        Ok(())
    }

    /// Checks that a large value is unchanged since it was written. A missing file is not an error here, because restoring the
    /// value reports it.
    fn check_file(&self, hash: &str) -> Result<(), JournalError> {
        let path = self.folder.join(VALUES_FOLDER).join(hash);
        match fs::read(&path) {
            Ok(bytes) if blake3::hash(&bytes).to_hex().as_str() != hash => {
                Err(JournalError::Damaged { path, what: "its content has changed".to_owned() })
            }
            Ok(_) => Ok(()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            Err(source) => Err(JournalError::io(&path, Doing::Read, source)),
        }
    }

    fn note(&self, damage: Damage) {
        self.damage.borrow_mut().insert(damage);
    }

    /// Returns the description of the run.
    pub fn about(&self) -> &About {
        &self.about
    }

    /// Returns the folder of the run.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the number of the last event. 0 if there are no events. Events of an active run count once they survive a power cut.
    pub fn last_sequence(&self) -> Result<u64, JournalError> {
        let last = self.source.last_sequence()?.max(self.extra.last_sequence());
        Ok(match self.end {
            JournalEnd::Open => last,
            JournalEnd::At(end) => last.max(end),
            JournalEnd::Damaged => last + 1,
        })
    }

    /// Returns the first event with full detail, if detail was deleted.
    pub(in crate::journal) fn thinned_before(&self) -> Result<Option<u64>, JournalError> {
        self.source.thinned()
    }

    /// Returns an error: events were deleted.
    pub(in crate::journal) fn given_up(&self) -> JournalError {
        JournalError::GivenUp { path: self.folder().join(DATABASE_FILE) }
    }

    /// Returns the places of all events read until now, by their latest definitions.
    pub fn known_places(&self) -> &Places {
        &self.places
    }

    /// Returns at most `count` events, starting with number `from`.
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

    /// Passes the events to `visit` in order, starting with number `from`, until it breaks.
    pub fn each(
        &mut self,
        from: u64,
        visit: impl FnMut(&Self, Entry) -> ControlFlow<()>,
    ) -> Result<(), JournalError> {
        self.walk(from, Values::Read, visit)
    }

    /// Passes events without the values of ports and variables, as if states had left them out.
    pub(super) fn each_without_values(
        &mut self,
        from: u64,
        visit: impl FnMut(&Self, Entry) -> ControlFlow<()>,
    ) -> Result<(), JournalError> {
        self.walk(from, Values::Skipped, visit)
    }

    fn walk(
        &mut self,
        from: u64,
        values: Values,
        mut visit: impl FnMut(&Self, Entry) -> ControlFlow<()>,
    ) -> Result<(), JournalError> {
        self.learn()?;
        let reader = &*self;
        let rows = |source: &Source, row: &mut Visit<'_>| source.rows(from, row);
        reader.read(Some(from.max(1)), values, rows, |entry| visit(reader, entry))
    }

    /// Returns the number of the first event at this time or later, or the number after the last event.
    pub fn first_at(&mut self, t_ns: u64) -> Result<u64, JournalError> {
        let near = self.source.first_near(t_ns)?;
        let mut next = near.map_or_else(|| self.source.last_sequence().map(|last| last + 1), Ok)?;
        self.each_without_values(next, |_, entry| {
            if entry.t_ns >= t_ns {
                return ControlFlow::Break(());
            }
            next = entry.sequence + 1;
            ControlFlow::Continue(())
        })?;
        Ok(next)
    }

    /// Returns the events of the last rows.
    pub fn tail(&self) -> Result<Vec<Entry>, JournalError> {
        let mut tail = Vec::new();
        let keep = |entry| {
            tail.push(entry);
            ControlFlow::Continue(())
        };
        self.read(None, Values::Read, |source, row| source.last_rows(TAIL_ROWS, row), keep)?;
        Ok(tail)
    }

    /// Returns the state of the run after event number `sequence`, or after the last event if there are fewer.
    pub fn moment(&mut self, sequence: u64) -> Result<Moment, JournalError> {
        self.learn()?;
        let sequence = sequence.min(self.last_sequence()?);
        if self.doubtful_from.is_some_and(|from| from <= sequence) {
            return Err(self.source.damaged(&Damage::Places.to_string()));
        }
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
                // A keyframe that cannot be read is skipped: an earlier one leads there too.
                Some((_, Err(damage))) => {
                    self.note(damage.clone());
                    None
                }
                Some((_, Ok(bytes))) => match Moment::from_bytes(bytes, places) {
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

    /// Returns the value with this number. `None` if it was deleted to limit the size of the journal.
    pub fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        if let Some(stored) = self.extra.value(number) {
            return Ok(Some(stored.clone()));
        }
        let value = self.source.value(number);
        if let Err(JournalError::Damaged { .. }) = value {
            self.note(Damage::Value(number.0));
        }
        value
    }

    /// Returns the definitions of places for these events: the first event of each, its number and the place.
    pub(in crate::journal) fn definitions(
        &mut self,
        events: RangeInclusive<u64>,
    ) -> Result<Vec<(u64, PlaceNumber, Place)>, JournalError> {
        self.learn()?;
        let defined = self.defined.iter().filter(|defined| events.contains(&defined.first));
        Ok(defined.map(|it| (it.first, it.number, it.place.clone())).collect())
    }

    /// Returns an error: these events are damaged.
    pub(in crate::journal) fn lost_events(&self, first: u64, last: u64) -> JournalError {
        self.lost(first, last, "they cannot be sent")
    }

    /// Returns the state of the run after its last event, starting from an earlier moment.
    pub fn advance(&mut self, moment: Moment) -> Result<Moment, JournalError> {
        self.learn()?;
        let last = self.last_sequence()?;
        self.forward(moment, last)
    }

    /// Advances a moment to a later event.
    fn forward(&mut self, mut moment: Moment, sequence: u64) -> Result<Moment, JournalError> {
        let start = moment.sequence();
        if sequence <= start {
            return Ok(moment);
        }
        let defined = std::mem::take(&mut self.defined);
        let mut later = defined.iter().skip_while(|defined| defined.first <= start).peekable();
        let mut lost = None;
        let gone = self.each(start + 1, |_, entry| {
            if let Some((first, last)) = damaged(&entry.record) {
                lost = (first <= sequence).then_some((first, last));
                return ControlFlow::Break(());
            }
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
        gone?;
        lost.map_or(Ok(moment), |(first, last)| {
            let what = format!("the state of the run after event {sequence} is unknown");
            Err(self.lost(first, last, &what))
        })
    }

    fn places_at(&self, sequence: u64) -> Places {
        let mut places = Places::default();
        for defined in self.defined.iter().take_while(|defined| defined.first <= sequence) {
            places.define(defined.number, defined.place.clone());
        }
        places
    }

    /// Reads the definitions of places that were added since the last call.
    fn learn(&mut self) -> Result<(), JournalError> {
        let last = self.last_sequence()?;
        if last <= self.known_until {
            return Ok(());
        }
        let (mut fresh, whole) = self.source.places_after(self.defined_there)?;
        self.defined_there += fresh.len() as u64;
        if !whole {
            // Later definitions apply to later events.
            let known = fresh.iter().chain(&self.defined).map(|defined| defined.first);
            self.doubtful_from = known.max().or(Some(1));
            self.note(Damage::Places);
        }
        if self.known_until == 0 {
            fresh.extend_from_slice(self.extra.places());
        }
        fresh.sort_by_key(|defined| defined.first);
        for defined in &fresh {
            self.places.define(defined.number, defined.place.clone());
        }
        self.defined.append(&mut fresh);
        self.known_until = last;
        Ok(())
    }
}

/// Determines the knowledge about the last event of a run that is not active.
fn end(source: &Source, extra: &Extra) -> Result<JournalEnd, JournalError> {
    Ok(match (source.checked(), extra.marks, source.end()?) {
        (Checked::Never, Marks::None | Marks::Unmarked, _) | (_, Marks::Unmarked, None) => {
            JournalEnd::Open
        }
        (_, Marks::Read { appended, committed }, end) => {
            JournalEnd::At(appended.max(committed).max(end.unwrap_or(0)))
        }
        (_, Marks::None | Marks::Unmarked, Some(end)) => JournalEnd::At(end),
        // A run that died before its first event may have no recorder.
        (_, Marks::None, None) if source.last_sequence()? == 0 => JournalEnd::Open,
        (_, Marks::Damaged | Marks::None, _) => JournalEnd::Damaged,
    })
}

/// Returns the range of unreadable events that a `damaged` event replaces.
pub(in crate::journal) fn damaged(record: &Record) -> Option<(u64, u64)> {
    let Record::Told(event) = record else { return None };
    let Event::Damaged { first, last, .. } = &**event else { return None };
    Some((*first, *last))
}

/// Returns the start of a list, for a message.
fn shortened(found: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown = found.iter().take(SHOWN).cloned().collect::<Vec<_>>().join("; ");
    let more = found.len().saturating_sub(SHOWN);
    if more > 0 { format!("{shown}; and {more} more") } else { shown }
}
