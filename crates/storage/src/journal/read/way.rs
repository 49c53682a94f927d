//! Walks through a journal event by event, and replaces an unreadable range by one `damaged` event. Checks the sequence of events.

use super::filter::place_of;
use super::{Damage, Entry, JournalEnd, Reader, Row, Source, Visit};
use crate::journal::folder::{DATABASE_FILE, JournalError};
use crate::journal::record::Record;
use crate::journal::record::binary::BinaryReader;
use rafcon_protocol::Event;
use std::ops::ControlFlow;

impl Reader {
    /// Passes on the events of rows of the database and of all leftovers, starting with number `from`, or with the first of them.
    pub(super) fn read(
        &self,
        from: Option<u64>,
        values: Values,
        rows: impl FnOnce(&Source, &mut Visit<'_>) -> Result<ControlFlow<()>, JournalError>,
        visit: impl FnMut(Entry) -> ControlFlow<()>,
    ) -> Result<(), JournalError> {
        let mut way = Way { reader: self, values, next: from, t_ns: 0, lost: None, visit };
        if rows(&self.source, &mut |row: Row<'_>| way.row(&row))?.is_break() {
            return Ok(());
        }
        for row in self.extra.rows() {
            if way.row(&row).is_break() {
                return Ok(());
            }
        }
        way.end();
        Ok(())
    }
}

/// Handling of the values of ports and variables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Values {
    Read,
    /// Values are left out, which is faster.
    Skipped,
}

/// Position of a reader.
struct Way<'r, V> {
    reader: &'r Reader,
    values: Values,
    /// Number of the next event. `None` before the first row if any number may come.
    next: Option<u64>,
    t_ns: u64,
    /// Unreadable events before the next: the number of the first, and the event that reports them.
    lost: Option<(u64, Damage)>,
    visit: V,
}

impl<V: FnMut(Entry) -> ControlFlow<()>> Way<'_, V> {
    /// Passes on the events of a row.
    fn row(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        let next = *self.next.get_or_insert(row.first);
        if row.first > next {
            if !self.is_given_up(next, row.first) {
                self.t_ns = row.t_before;
                self.lose(next, row.first - 1);
            }
            self.next = Some(row.first);
        }
        let mut records = match self.values {
            Values::Read => BinaryReader::new(row.data),
            Values::Skipped => BinaryReader::without_values(row.data),
        };
        let mut t_before = row.t_before;
        for sequence in row.first.. {
            if records.is_at_end() {
                break;
            }
            let Ok((t_ns, record)) = records.next_record(t_before) else {
                // The rest of the row cannot be read either: the next row shows how many events it had.
                self.lose(sequence, sequence);
                return ControlFlow::Continue(());
            };
            t_before = t_ns;
            if self.next.is_some_and(|next| sequence < next) {
                continue;
            }
            self.t_ns = t_ns;
            if self.is_doubtful(sequence, &record) {
                self.lose(sequence, sequence);
                continue;
            }
            self.tell_lost()?;
            self.next = Some(sequence + 1);
            (self.visit)(Entry { sequence, t_ns, record })?;
        }
        ControlFlow::Continue(())
    }

    /// Reports unreadable events after the last row.
    fn end(mut self) {
        let next = self.next.unwrap_or(1);
        match self.reader.end {
            JournalEnd::At(end) if end >= next => self.lose(next, end),
            JournalEnd::Damaged => {
                self.lose(next, next);
                self.lost = self.lost.map(|(first, _)| (first, Damage::Recorder(first)));
            }
            JournalEnd::At(_) | JournalEnd::Open => {}
        }
        // The walk is over in either case.
        let _over = self.tell_lost();
    }

    fn lose(&mut self, first: u64, last: u64) {
        let first = self.lost.as_ref().map_or(first, |(first, _)| *first);
        self.lost = Some((first, Damage::Events(first, last)));
        self.next = Some(last + 1);
    }

    fn tell_lost(&mut self) -> ControlFlow<()> {
        let Some((first, damage)) = self.lost.take() else { return ControlFlow::Continue(()) };
        let last = match damage {
            Damage::Events(_, last) => last,
            _ => first,
        };
        let what = format!("{DATABASE_FILE}: {damage}");
        self.reader.note(damage);
        let record = Record::Told(Box::new(Event::Damaged { first, last, what }));
        (self.visit)(Entry { sequence: last, t_ns: self.t_ns, record })
    }

    /// Returns true if events are missing because the journal deleted the oldest.
    fn is_given_up(&self, next: u64, first: u64) -> bool {
        let source = &self.reader.source;
        let is_first = || source.first_sequence().is_ok_and(|there| there == first);
        let border = || source.thinned().ok().flatten().unwrap_or(0);
        next < first && first <= border() && is_first()
    }

    /// Returns true if the place of this event is unknown.
    fn is_doubtful(&self, sequence: u64, record: &Record) -> bool {
        let Some(place) = place_of(record) else { return false };
        let Reader { places, doubtful_from, is_live, source, known_until, .. } = self.reader;
        // In an active run, a place may have been defined after the definitions were read.
        let is_known = || *is_live || !source.is_checked() || *known_until == 0;
        let is_unknown = || !is_known() && places.get(place).is_none();
        doubtful_from.is_some_and(|from| from <= sequence) || is_unknown()
    }
}
