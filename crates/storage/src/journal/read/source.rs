//! The database of a journal, opened for reading. Checks every row and skips damaged ones. Handles its tables, not the meaning of
//! their bytes.

use super::Defined;
use crate::journal::folder::{DATABASE_FILE, JournalError};
use crate::journal::record::{Stored, ValueNumber};
use crate::journal::store::sums::{self, Checked, Damage, RowHeader};
use crate::journal::store::{DefinedRow, UNCHECKED, VERSION, checks};
use rusqlite::types::FromSql;
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Row as Columns, Statement};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The events of one row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<'b> {
    pub(super) first: u64,
    pub(super) t_before: u64,
    pub(super) data: &'b [u8],
}

/// Receives rows until it breaks.
pub(super) type Visit<'v> = dyn FnMut(Row<'_>) -> ControlFlow<()> + 'v;

#[derive(Debug)]
pub(super) struct Source {
    connection: Connection,
    path: PathBuf,
    checked: Checked,
}

type SourceResult<T> = Result<T, JournalError>;

/// Number of an event, and the keyframe after it.
type KeptMoment = (u64, Result<Vec<u8>, Damage>);

/// Hash of a value or the value itself, and its checksum.
type KeptRow = (Option<Vec<u8>>, Option<Vec<u8>>, Option<i64>);

impl Source {
    pub(super) fn open(folder: &Path) -> SourceResult<Self> {
        let path = folder.join(DATABASE_FILE);
        if !path.exists() {
            return Err(JournalError::NoRun { folder: folder.to_owned(), file: DATABASE_FILE });
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let opened = || {
            let connection = Connection::open_with_flags(&path, flags)?;
            connection.busy_timeout(Duration::from_secs(5))?;
            let found = connection.pragma_query_value(None, "user_version", |row| row.get(0))?;
            let checked = checks(&connection)?;
            Ok((connection, found, checked))
        };
        let (connection, found, checked): (_, u32, _) =
            opened().map_err(|source| JournalError::database(&path, source))?;
        match (found, checked) {
            (UNCHECKED, Checked::Never) | (VERSION, Checked::Partly | Checked::Always) => {
                Ok(Self { connection, path, checked })
            }
            (0, _) => Err(JournalError::Damaged { path, what: "it has no tables".to_owned() }),
            (UNCHECKED | VERSION, _) => {
                let what = format!("its tables are not those of version {found}");
                Err(JournalError::Damaged { path, what })
            }
            _ => Err(JournalError::Newer { path, found, known: VERSION }),
        }
    }

    /// Returns which rows have checksums.
    pub(super) fn checked(&self) -> Checked {
        self.checked
    }

    /// Returns true if all rows have checksums.
    pub(super) fn is_checked(&self) -> bool {
        self.checked == Checked::Always
    }

    /// Returns the number of the last event of the last readable row. 0 without such a row.
    pub(super) fn last_sequence(&self) -> SourceResult<u64> {
        let last = self.first_head("ORDER BY first DESC", |_| true)?;
        Ok(last.map_or(0, |head| (head.first + head.count - 1).cast_unsigned()))
    }

    /// Returns the number of the first remaining event. 1 without events.
    pub(super) fn first_sequence(&self) -> SourceResult<u64> {
        let first = self.first_head("ORDER BY first", |_| true)?;
        Ok(first.map_or(1, |head| head.first.cast_unsigned()))
    }

    /// Returns the last event of a run whose runner ended normally. `None` if none did.
    pub(super) fn end(&self) -> SourceResult<Option<u64>> {
        if self.checked == Checked::Never {
            return Ok(None);
        }
        self.highest("SELECT sequence, sum FROM ends", "ends")
    }

    /// Returns the first event with full detail, if detail was deleted.
    pub(super) fn thinned(&self) -> SourceResult<Option<u64>> {
        self.highest(&self.query("SELECT before, SUM FROM thinned"), "thinned")
    }

    fn highest(&self, query: &str, table: &str) -> SourceResult<Option<u64>> {
        self.ask(query, |statement| {
            let mut rows = statement.query([])?;
            let mut highest = None;
            while let Some(row) = rows.next()? {
                let (number, sum): (i64, Option<i64>) = (row.get(0)?, row.get(1)?);
                if self.checked.is_right(sum, || sums::of_number(table, number)) {
                    highest = highest.max(u64::try_from(number).ok());
                }
            }
            Ok(highest)
        })
    }

    /// Returns an error: the requested part of the journal was deleted.
    pub(super) fn given_up(&self) -> JournalError {
        JournalError::GivenUp { path: self.path.clone() }
    }

    /// Passes the rows from the one with event number `from` on to `visit`, until it breaks. Skips unreadable rows.
    pub(super) fn rows(&self, from: u64, visit: &mut Visit<'_>) -> SourceResult<ControlFlow<()>> {
        let query = "SELECT coalesce(max(first), 0) FROM blocks WHERE first <= ?1";
        let from = i64::try_from(from).unwrap_or(i64::MAX);
        let first = self.ask(query, |statement| statement.query_row([from], |row| row.get(0)));
        // If the index is damaged, all rows are scanned.
        self.visit(readable(first)?.unwrap_or(0), visit)
    }

    /// Returns the number of the first event in the first row with an event at this time or later. `None` if all are earlier.
    pub(super) fn first_near(&self, t_ns: u64) -> SourceResult<Option<u64>> {
        let t_ns = i64::try_from(t_ns).unwrap_or(i64::MAX);
        let near = self.first_head("ORDER BY first", |head| head.t_last >= t_ns)?;
        Ok(near.map(|head| head.first.cast_unsigned()))
    }

    /// Returns the first row in this order whose numbers are valid and match.
    fn first_head(
        &self,
        order: &str,
        wanted: impl Fn(&RowHeader) -> bool,
    ) -> SourceResult<Option<RowHeader>> {
        let query = format!("SELECT first, count, t_before, t_last, SUM FROM blocks {order}");
        self.ask(&self.query(&query), |statement| {
            let mut rows = statement.query([])?;
            while let Some(row) = rows.next()? {
                let found = head(row).filter(|(head, sum)| match (sum, self.checked) {
                    (Some(sum), _) => head.fits(*sum),
                    (None, checked) => checked != Checked::Always && head.is_possible(),
                });
                if let Some((head, _)) = found.filter(|(head, _)| wanted(head)) {
                    return Ok(Some(head));
                }
            }
            Ok(None)
        })
    }

    /// Passes the last `count` rows to `visit`.
    pub(super) fn last_rows(
        &self,
        count: u64,
        visit: &mut Visit<'_>,
    ) -> SourceResult<ControlFlow<()>> {
        let query = "SELECT coalesce(min(first), 0) FROM
            (SELECT first FROM blocks ORDER BY first DESC LIMIT ?1)";
        let count = i64::try_from(count).unwrap_or(i64::MAX);
        let first = self.ask(query, |statement| statement.query_row([count], |row| row.get(0)))?;
        self.visit(first, visit)
    }

    /// Passes the rows from this key on to `visit`. Reads each separately: a damaged row does not hide those behind it.
    fn visit(&self, mut key: i64, visit: &mut Visit<'_>) -> SourceResult<ControlFlow<()>> {
        let failed = |source| JournalError::database(&self.path, source);
        // A commit in between would cause gaps between the rows.
        let begin = || self.connection.unchecked_transaction().map(Some);
        let snapshot = if self.connection.is_autocommit() { begin() } else { Ok(None) };
        let _snapshot = snapshot.map_err(failed)?;
        let row = "SELECT first, count, t_before, t_last, SUM, data FROM blocks WHERE first = ?1";
        let mut row = self.connection.prepare(&self.query(row)).map_err(failed)?;
        let next = "SELECT first FROM blocks WHERE first > ?1 ORDER BY first LIMIT 1";
        let mut next = self.connection.prepare(next).map_err(failed)?;
        loop {
            let shown = self.show(&mut row, key, visit).map_err(failed);
            if readable(shown)?.is_some_and(|flow| flow.is_break()) {
                return Ok(ControlFlow::Break(()));
            }
            let found = next.query_row([key], |row| row.get::<_, i64>(0)).optional();
            let found = match readable(found.map_err(failed))? {
                Some(found) => found,
                None => readable(self.behind(key).map_err(failed))?.flatten(),
            };
            match found {
                Some(found) if found > key => key = found,
                _ => return Ok(ControlFlow::Continue(())),
            }
        }
    }

    /// Passes the row with this key to `visit`, if it exists and is undamaged.
    fn show(
        &self,
        row: &mut Statement<'_>,
        key: i64,
        visit: &mut Visit<'_>,
    ) -> rusqlite::Result<ControlFlow<()>> {
        let mut rows = row.query([key])?;
        let Some(row) = rows.next()? else { return Ok(ControlFlow::Continue(())) };
        let data = row.get_ref(5)?.as_blob()?;
        let Some((head, sum)) = head(row).filter(|(head, _)| head.first == key) else {
            return Ok(ControlFlow::Continue(()));
        };
        if !head.is_possible() || !self.checked.is_right(sum, || head.sum(data)) {
            return Ok(ControlFlow::Continue(()));
        }
        let [first, t_before] = [head.first, head.t_before].map(i64::cast_unsigned);
        Ok(visit(Row { first, t_before, data }))
    }

    /// Returns the first key after this one that can be reached from the end of a damaged index.
    fn behind(&self, key: i64) -> rusqlite::Result<Option<i64>> {
        let query = "SELECT first FROM blocks WHERE first > ?1 ORDER BY first DESC";
        let mut statement = self.connection.prepare(query)?;
        let mut rows = statement.query([key])?;
        let mut found = None;
        while let Ok(Some(row)) = rows.next() {
            found = row.get(0).ok().or(found);
        }
        Ok(found)
    }

    /// Returns the definitions of places after the first `count`, in their order, and whether all could be read.
    pub(super) fn places_after(&self, count: u64) -> SourceResult<(Vec<Defined>, bool)> {
        let query = match self.checked {
            Checked::Never => "SELECT nth, number, first, data, NULL FROM (SELECT number, first, data,
                row_number() OVER (ORDER BY first, number) AS nth FROM places) WHERE nth > ?1 ORDER BY nth",
            _ => "SELECT nth, number, first, data, sum FROM places WHERE nth > ?1 ORDER BY nth",
        };
        let mut defined = Vec::new();
        let whole = self.ask(query, |statement| {
            let mut rows = statement.query([count.cast_signed()])?;
            while let Some(row) = rows.next()? {
                let nth =
                    count.cast_signed() + 1 + i64::try_from(defined.len()).unwrap_or(i64::MAX);
                let row = DefinedRow::of(row).ok();
                let read = row.and_then(|row| Some((row.first, row.read(self.checked, nth)?)));
                let Some((first, (number, place))) = read else { return Ok(false) };
                defined.push(Defined { first: first.cast_unsigned(), number, place });
            }
            Ok(true)
        });
        match whole {
            Err(JournalError::Damaged { .. }) => Ok((defined, false)),
            whole => Ok((defined, whole?)),
        }
    }

    pub(super) fn value(&self, number: ValueNumber) -> SourceResult<Option<Stored>> {
        let key = number.0.cast_signed();
        if key <= 0 {
            // Values are counted from 1.
            return Ok(None);
        }
        let query = self.query("SELECT hash, data, SUM FROM vals WHERE number = ?1");
        let row = |row: &Columns<'_>| Ok((row.get(0)?, row.get(1)?, row.get(2)?));
        let value: Option<KeptRow> =
            self.ask(&query, |statement| statement.query_row([key], row).optional())?;
        let damaged = || self.damaged(&Damage::Value(number.0).to_string());
        let Some((hash, data, sum)) = value else {
            return if self.is_given_up(number)? { Ok(None) } else { Err(damaged()) };
        };
        if !self.checked.is_right(sum, || sums::of_value(key, hash.as_deref(), data.as_deref())) {
            return Err(damaged());
        }
        let bytes = match (hash, data) {
            (None, Some(data)) => data,
            (Some(hash), None) => self.blob(&hash)?.ok_or_else(damaged)?,
            _ => return Err(damaged()),
        };
        Stored::from_bytes(&bytes).map(Some).map_err(|_broken| damaged())
    }

    /// Returns a longer value by its hash, if it exists and has that hash.
    fn blob(&self, hash: &[u8]) -> SourceResult<Option<Vec<u8>>> {
        let query = "SELECT data FROM blobs WHERE hash = ?1";
        let data: Option<Vec<u8>> =
            self.ask(query, |statement| statement.query_row([hash], |row| row.get(0)).optional())?;
        Ok(data.filter(|data| blake3::hash(data).as_bytes() == hash))
    }

    /// Returns true if a missing value may have been deleted: no event with detail uses it.
    fn is_given_up(&self, number: ValueNumber) -> SourceResult<bool> {
        if self.checked == Checked::Never {
            return Ok(true);
        }
        let Some(before) = self.thinned()? else { return Ok(false) };
        let query = "SELECT coalesce(max(next_value), 0) FROM keyframes WHERE sequence < ?1";
        let floor: i64 = self.ask(query, |statement| {
            statement.query_row([before.cast_signed()], |row| row.get(0))
        })?;
        Ok(number.0 < floor.cast_unsigned())
    }

    /// Returns the last keyframe at or before event number `sequence`, with the event's number, or the damage of that keyframe.
    pub(super) fn keyframe(&self, sequence: u64) -> SourceResult<Option<KeptMoment>> {
        let query = self.query(
            "SELECT sequence, next_value, data, SUM FROM keyframes WHERE sequence <= ?1
            ORDER BY sequence DESC LIMIT 1",
        );
        self.ask(&query, |statement| {
            let row = |row: &Columns<'_>| {
                let at: i64 = row.get(0)?;
                let (next_value, data): (Option<i64>, Option<Vec<u8>>) =
                    (read(row, 1), read(row, 2));
                let right = |next_value, data: &Vec<u8>| {
                    self.checked.is_right(read(row, 3), || sums::of_keyframe(at, next_value, data))
                };
                let data = next_value.zip(data).filter(|(next, data)| right(*next, data));
                let at = at.cast_unsigned();
                Ok((at, data.map(|(_, data)| data).ok_or(Damage::Keyframe(at))))
            };
            statement.query_row([sequence.cast_signed()], row).optional()
        })
    }

    pub(super) fn damaged(&self, what: &str) -> JournalError {
        JournalError::Damaged { path: self.path.clone(), what: what.to_owned() }
    }

    /// Returns a query in which `SUM` is replaced by the checksum of a row.
    fn query(&self, text: &str) -> String {
        text.replace("SUM", if self.checked == Checked::Never { "NULL" } else { "sum" })
    }

    fn ask<T>(
        &self,
        query: &str,
        answer: impl FnOnce(&mut Statement<'_>) -> rusqlite::Result<T>,
    ) -> SourceResult<T> {
        let answered =
            self.connection.prepare(query).and_then(|mut statement| answer(&mut statement));
        answered.map_err(|source| JournalError::database(&self.path, source))
    }
}

/// Returns the numbers of a row, and its checksum, from its first five columns.
fn head(row: &Columns<'_>) -> Option<(RowHeader, Option<i64>)> {
    let [first, count] = [read(row, 0)?, read(row, 1)?];
    let [t_before, t_last] = [read(row, 2)?, read(row, 3)?];
    Some((RowHeader { first, count, t_before, t_last }, row.get(4).ok()?))
}

/// Returns the result. `None` if it is damaged.
fn readable<T>(found: SourceResult<T>) -> SourceResult<Option<T>> {
    match found {
        Err(JournalError::Damaged { .. }) => Ok(None),
        found => found.map(Some),
    }
}

/// Returns a column, if it has the right type.
fn read<T: FromSql>(row: &Columns<'_>, column: usize) -> Option<T> {
    row.get(column).ok()
}
