//! The database of a journal, opened for reading. Knows its tables; must never know what their bytes are for.

use super::Defined;
use crate::journal::database::VERSION;
use crate::journal::error::JournalError;
use crate::journal::folder::DATABASE_FILE;
use crate::journal::record::{Definition, Item, Items, Stored, ValueNumber};
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Statement};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Events that lie together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<'b> {
    pub(super) first: u64,
    pub(super) t_before: u64,
    pub(super) data: &'b [u8],
}

/// Takes rows until it has enough.
pub(super) type Visit<'v> = dyn FnMut(Row<'_>) -> ControlFlow<()> + 'v;

#[derive(Debug)]
pub(super) struct Source {
    connection: Connection,
    path: PathBuf,
}

type Found<T> = Result<T, JournalError>;

impl Source {
    pub(super) fn open(folder: &Path) -> Found<Self> {
        let path = folder.join(DATABASE_FILE);
        if !path.exists() {
            return Err(JournalError::NoRun { folder: folder.to_owned(), file: DATABASE_FILE });
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let opened = || {
            let connection = Connection::open_with_flags(&path, flags)?;
            connection.busy_timeout(Duration::from_secs(5))?;
            let found = connection.pragma_query_value(None, "user_version", |row| row.get(0))?;
            Ok((connection, found))
        };
        let (connection, found): (_, u32) =
            opened().map_err(|source| JournalError::database(&path, source))?;
        match found {
            0 => Err(JournalError::Damaged { path, what: "it has no tables".to_owned() }),
            VERSION => Ok(Self { connection, path }),
            _ => Err(JournalError::Newer { path, found, known: VERSION }),
        }
    }

    pub(super) fn last_sequence(&self) -> Found<u64> {
        let query = "SELECT first + count - 1 FROM blocks ORDER BY first DESC LIMIT 1";
        self.ask(query, |statement| {
            let last: Option<i64> = statement.query_row([], |row| row.get(0)).optional()?;
            Ok(last.map_or(0, i64::cast_unsigned))
        })
    }

    /// Number of the first event that is still there; 1 if there is none.
    pub(super) fn first_sequence(&self) -> Found<u64> {
        self.ask("SELECT coalesce(min(first), 1) FROM blocks", |statement| {
            statement.query_row([], |row| row.get(0)).map(i64::cast_unsigned)
        })
    }

    /// What is to be read is not there any more.
    pub(super) fn given_up(&self) -> JournalError {
        JournalError::GivenUp { path: self.path.clone() }
    }

    /// Shows the rows from the one with event number `from` on, until `visit` has enough.
    pub(super) fn rows(&self, from: u64, visit: &mut Visit<'_>) -> Found<ControlFlow<()>> {
        let query = "SELECT first, t_before, data FROM blocks WHERE first >=
            coalesce((SELECT max(first) FROM blocks WHERE first <= ?1), 0) ORDER BY first";
        self.visit(query, from, visit)
    }

    /// Number of the first event that lies together with one at this time or later; nothing if all are earlier.
    pub(super) fn first_near(&self, t_ns: u64) -> Found<Option<u64>> {
        let t_ns = i64::try_from(t_ns).unwrap_or(i64::MAX);
        let query = "SELECT first FROM blocks WHERE t_last >= ?1 ORDER BY first LIMIT 1";
        self.ask(query, |statement| {
            let first: Option<i64> = statement.query_row([t_ns], |row| row.get(0)).optional()?;
            Ok(first.map(i64::cast_unsigned))
        })
    }

    /// Shows the last `count` rows.
    pub(super) fn last_rows(&self, count: u64, visit: &mut Visit<'_>) -> Found<ControlFlow<()>> {
        let query = "SELECT first, t_before, data FROM
            (SELECT * FROM blocks ORDER BY first DESC LIMIT ?1) ORDER BY first";
        self.visit(query, count, visit)
    }

    fn visit(&self, query: &str, parameter: u64, visit: &mut Visit<'_>) -> Found<ControlFlow<()>> {
        self.ask(query, |statement| {
            let parameter = i64::try_from(parameter).unwrap_or(i64::MAX);
            let mut rows = statement.query([parameter])?;
            while let Some(row) = rows.next()? {
                let [first, t_before] = [row.get(0)?, row.get(1)?].map(i64::cast_unsigned);
                let data = row.get_ref(2)?.as_blob()?;
                if visit(Row { first, t_before, data }).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
            Ok(ControlFlow::Continue(()))
        })
    }

    /// Places that were defined for events after number `after`, in that order.
    pub(super) fn places_after(&self, after: u64) -> Found<Vec<Defined>> {
        let query = "SELECT first, data FROM places WHERE first > ?1 ORDER BY first";
        let rows: Vec<(i64, Vec<u8>)> = self.ask(query, |statement| {
            let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
            statement.query_map([after.cast_signed()], row)?.collect()
        })?;
        let place = |(first, bytes): (i64, Vec<u8>)| match Items::new(&bytes, 0).next() {
            Some(Ok(Item::Definition(Definition::Place(number, place)))) => {
                Ok(Defined { first: first.cast_unsigned(), number, place })
            }
            _ => Err(self.damaged("a place that cannot be read")),
        };
        rows.into_iter().map(place).collect()
    }

    pub(super) fn value(&self, number: ValueNumber) -> Found<Option<Stored>> {
        let query = "SELECT coalesce(vals.data, blobs.data) FROM vals
            LEFT JOIN blobs ON blobs.hash = vals.hash WHERE number = ?1";
        let bytes: Option<Option<Vec<u8>>> = self.ask(query, |statement| {
            statement.query_row([number.0.cast_signed()], |row| row.get(0)).optional()
        })?;
        let stored = |bytes: Vec<u8>| {
            Stored::from_bytes(&bytes).map_err(|broken| self.damaged(&broken.to_string()))
        };
        bytes.flatten().map(stored).transpose()
    }

    /// The last moment that was kept at or before event number `sequence`, and the event's number.
    pub(super) fn keyframe(&self, sequence: u64) -> Found<Option<(u64, Vec<u8>)>> {
        let query = "SELECT sequence, data FROM keyframes WHERE sequence <= ?1
            ORDER BY sequence DESC LIMIT 1";
        self.ask(query, |statement| {
            let row =
                |row: &rusqlite::Row<'_>| Ok((row.get::<_, i64>(0)?.cast_unsigned(), row.get(1)?));
            statement.query_row([sequence.cast_signed()], row).optional()
        })
    }

    pub(super) fn damaged(&self, what: &str) -> JournalError {
        JournalError::Damaged { path: self.path.clone(), what: what.to_owned() }
    }

    fn ask<T>(
        &self,
        query: &str,
        answer: impl FnOnce(&mut Statement<'_>) -> rusqlite::Result<T>,
    ) -> Found<T> {
        let answered =
            self.connection.prepare(query).and_then(|mut statement| answer(&mut statement));
        answered.map_err(|source| JournalError::database(&self.path, source))
    }
}
