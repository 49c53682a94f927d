//! The database of a journal and its tables. Handles `SQLite`, not the source of the rows.

pub(in crate::journal) mod group;
pub(in crate::journal) mod leftovers;
pub(in crate::journal) mod recorder;
pub(in crate::journal) mod sums;

use crate::journal::folder::{DATABASE_FILE, Doing, JournalError, RECORDER_FILE, create_file};
use crate::journal::record::{Definition, Item, Items, Place, PlaceNumber, ValueNumber};
use group::{Block, Group};
use rusqlite::{Connection, OpenFlags, OptionalExtension as _};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use sums::{Checked, Damage, RowHeader};

/// Version of the tables.
pub(in crate::journal) const VERSION: u32 = 2;
/// Version whose rows have no checksums.
pub(in crate::journal) const UNCHECKED: u32 = 1;
/// Timeout for other connections to release the database.
const BUSY: Duration = Duration::from_secs(5);
/// Page size of a new database. Each table takes one page, and journals of short runs consist mostly of these.
const PAGE_BYTES: i64 = 2 << 10;
/// Size of the write-ahead log after a checkpoint.
const WAL_BYTES: i64 = 4 << 20;

const TABLES: &str = "
    CREATE TABLE blocks(first INTEGER PRIMARY KEY, count INTEGER NOT NULL, t_before INTEGER NOT NULL,
        t_last INTEGER NOT NULL, data BLOB NOT NULL, sum INTEGER NOT NULL);
    CREATE TABLE places(nth INTEGER PRIMARY KEY, number INTEGER NOT NULL, first INTEGER NOT NULL,
        data BLOB NOT NULL, sum INTEGER NOT NULL);
    CREATE TABLE vals(number INTEGER PRIMARY KEY, hash BLOB, data BLOB, sum INTEGER NOT NULL);
    CREATE TABLE blobs(hash BLOB PRIMARY KEY, data BLOB NOT NULL, uses INTEGER NOT NULL);
    CREATE TABLE large(name TEXT PRIMARY KEY, size INTEGER NOT NULL, uses INTEGER NOT NULL);
    CREATE TABLE keyframes(sequence INTEGER PRIMARY KEY, data BLOB NOT NULL, next_value INTEGER NOT NULL,
        sum INTEGER NOT NULL);
    CREATE TABLE named(number INTEGER PRIMARY KEY, last INTEGER NOT NULL);
    CREATE TABLE roots(hash BLOB PRIMARY KEY, base BLOB, data BLOB NOT NULL);
    CREATE TABLE files(hash BLOB PRIMARY KEY, data BLOB NOT NULL);
    CREATE TABLE lives(life INTEGER PRIMARY KEY, first INTEGER NOT NULL);
    CREATE TABLE thinned(before INTEGER PRIMARY KEY, sum INTEGER NOT NULL);
    CREATE TABLE ends(sequence INTEGER PRIMARY KEY, sum INTEGER NOT NULL);
";

/// Upgrades the tables of the previous version; their rows stay without checksums.
const UPGRADE: &str = "
    ALTER TABLE blocks ADD COLUMN sum INTEGER;
    ALTER TABLE places RENAME TO places_before;
    CREATE TABLE places(nth INTEGER PRIMARY KEY, number INTEGER NOT NULL, first INTEGER NOT NULL,
        data BLOB NOT NULL, sum INTEGER);
    INSERT INTO places SELECT row_number() OVER (ORDER BY first, number), number, first, data, NULL
        FROM places_before;
    DROP TABLE places_before;
    ALTER TABLE vals ADD COLUMN sum INTEGER;
    ALTER TABLE keyframes ADD COLUMN sum INTEGER;
    ALTER TABLE thinned ADD COLUMN sum INTEGER;
    CREATE TABLE ends(sequence INTEGER PRIMARY KEY, sum INTEGER NOT NULL);
";

/// Open database of one run.
#[derive(Debug)]
pub(in crate::journal) struct Database {
    connection: Connection,
    path: PathBuf,
}

impl Database {
    /// Creates the database of a new run.
    pub(in crate::journal) fn create(folder: &Path) -> Result<Self, JournalError> {
        let path = folder.join(DATABASE_FILE);
        // `SQLite` copies these permissions to the files beside the database.
        create_file(&path).map_err(|source| JournalError::io(&path, Doing::Write, source))?;
        let mut database = Self::open_with(folder, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        let text = format!("BEGIN IMMEDIATE; {TABLES} PRAGMA user_version = {VERSION}; COMMIT;");
        database.run(|connection| connection.execute_batch(&text))?;
        Ok(database)
    }

    /// Opens the database of a run that is resumed.
    pub(in crate::journal) fn open(folder: &Path) -> Result<Self, JournalError> {
        let (mut database, found) =
            Self::known(folder, OpenFlags::SQLITE_OPEN_READ_WRITE)?.checked()?;
        if found == UNCHECKED {
            let text =
                format!("BEGIN IMMEDIATE; {UPGRADE} PRAGMA user_version = {VERSION}; COMMIT;");
            database.run(|connection| connection.execute_batch(&text))?;
        }
        Ok(database)
    }

    /// Opens the database of any run for reading.
    pub(in crate::journal) fn open_to_read(folder: &Path) -> Result<Self, JournalError> {
        Ok(Self::known(folder, OpenFlags::SQLITE_OPEN_READ_ONLY)?.checked()?.0)
    }

    /// Opens a database that may have no tables yet.
    pub(in crate::journal) fn open_unchecked(folder: &Path) -> Result<Self, JournalError> {
        Self::known(folder, OpenFlags::SQLITE_OPEN_READ_ONLY)
    }

    fn known(folder: &Path, flags: OpenFlags) -> Result<Self, JournalError> {
        if folder.join(DATABASE_FILE).exists() {
            Self::open_with(folder, flags)
        } else {
            Err(JournalError::NoRun { folder: folder.to_owned(), file: DATABASE_FILE })
        }
    }

    /// Checks that the version of its tables is known, and returns it.
    fn checked(mut self) -> Result<(Self, u32), JournalError> {
        let query = |connection: &mut Connection| {
            connection.pragma_query_value(None, "user_version", |row| row.get(0))
        };
        match self.run(query)? {
            0 => Err(self.damaged("it has no tables")),
            found if found > VERSION => {
                Err(JournalError::Newer { path: self.path, found, known: VERSION })
            }
            found => Ok((self, found)),
        }
    }

    fn open_with(folder: &Path, flags: OpenFlags) -> Result<Self, JournalError> {
        let path = folder.join(DATABASE_FILE);
        let set_up = || {
            let connection =
                Connection::open_with_flags(&path, flags | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
            // A checkpoint of another connection may hold the database for a moment.
            connection.busy_timeout(BUSY)?;
            if flags.contains(OpenFlags::SQLITE_OPEN_READ_WRITE) {
                connection.pragma_update(None, "page_size", PAGE_BYTES)?;
                connection.pragma_update(None, "journal_mode", "wal")?;
                connection.pragma_update(None, "synchronous", "full")?;
                connection.pragma_update(None, "journal_size_limit", WAL_BYTES)?;
            }
            Ok(connection)
        };
        let connection = set_up().map_err(|source| JournalError::database(&path, source))?;
        Ok(Self { connection, path })
    }

    /// Runs `action` with the connection.
    pub(in crate::journal) fn run<T>(
        &mut self,
        action: impl FnOnce(&mut Connection) -> rusqlite::Result<T>,
    ) -> Result<T, JournalError> {
        action(&mut self.connection).map_err(|source| JournalError::database(&self.path, source))
    }

    /// Writes a group of events, which survives a power cut when this returns. Replaces rows that an earlier attempt wrote after
    /// record number `committed` and definition number `places`.
    pub(in crate::journal) fn put(
        &mut self,
        group: &Group,
        committed: u64,
        places: u64,
    ) -> Result<(), JournalError> {
        self.run(|connection| {
            let transaction = connection.transaction()?;
            group.put(&transaction, committed, places)?;
            transaction.commit()
        })
    }

    /// Returns the record number of the last keyframe, and the lowest unused number of a value at that time.
    pub(in crate::journal) fn last_keyframe(&mut self) -> Result<(u64, ValueNumber), JournalError> {
        let query = "SELECT sequence, next_value, data, sum FROM keyframes ORDER BY sequence DESC";
        let checked = self.checks()?;
        let last = self.run(|connection| {
            let mut statement = connection.prepare(query)?;
            let mut rows = statement.query([])?;
            while let Some(row) = rows.next()? {
                let [sequence, next_value]: [i64; 2] = [row.get(0)?, row.get(1)?];
                let data = row.get_ref(2)?.as_blob()?;
                let right = || sums::of_keyframe(sequence, next_value, data);
                if checked.is_right(row.get(3)?, right) {
                    return Ok(Some([sequence, next_value].map(i64::cast_unsigned)));
                }
            }
            Ok(None)
        })?;
        let [sequence, next_value] = last.unwrap_or([0, 1]);
        Ok((sequence, ValueNumber(next_value)))
    }

    /// Returns the last block, if there is one.
    pub(in crate::journal) fn last_block(&mut self) -> Result<Option<Block>, JournalError> {
        let query = "SELECT first, count, t_before, t_last, data, sum FROM blocks
            ORDER BY first DESC LIMIT 1";
        let checked = self.checks()?;
        let last = self.run(|connection| {
            let row = |row: &rusqlite::Row<'_>| {
                let head = RowHeader {
                    first: row.get(0)?,
                    count: row.get(1)?,
                    t_before: row.get(2)?,
                    t_last: row.get(3)?,
                };
                Ok((head, row.get(4)?, row.get(5)?))
            };
            connection.query_row(query, [], row).optional()
        })?;
        let Some((head, data, sum)): Option<(RowHeader, Vec<u8>, Option<i64>)> = last else {
            return Ok(None);
        };
        if !head.is_possible() || !checked.is_right(sum, || head.sum(&data)) {
            return Err(self.damaged("its last events cannot be read"));
        }
        let numbers = [head.first, head.count, head.t_before, head.t_last].map(i64::cast_unsigned);
        let [first, count, t_before, t_last] = numbers;
        Ok(Some(Block { first, count, t_before, t_last, data }))
    }

    /// Returns which rows have checksums.
    pub(in crate::journal) fn checks(&mut self) -> Result<Checked, JournalError> {
        self.run(|connection| checks(connection))
    }

    /// Records that the run and its runner ended after this record.
    pub(in crate::journal) fn put_end(&mut self, sequence: u64) -> Result<(), JournalError> {
        let sequence = sequence.cast_signed();
        self.run(|connection| {
            let insert = "INSERT OR REPLACE INTO ends VALUES (?1, ?2)";
            connection.execute(insert, [sequence, sums::of_number("ends", sequence)]).map(drop)
        })
    }

    /// Returns the lowest number above those of all values.
    pub(in crate::journal) fn next_value(&mut self) -> Result<ValueNumber, JournalError> {
        let query = "SELECT coalesce(max(number), 0) + 1 FROM vals";
        let next: i64 = self.run(|connection| connection.query_row(query, [], |row| row.get(0)))?;
        Ok(ValueNumber(next.cast_unsigned()))
    }

    /// Returns all places by their latest definitions, and the number of definitions.
    pub(in crate::journal) fn places(
        &mut self,
    ) -> Result<(u64, Vec<(PlaceNumber, Place)>), JournalError> {
        let query = "SELECT nth, number, first, data, sum FROM places ORDER BY nth";
        let checked = self.checks()?;
        let rows = self.run(|connection| {
            let mut statement = connection.prepare(query)?;
            statement.query_map([], DefinedRow::of)?.collect::<Result<Vec<_>, _>>()
        })?;
        let mut places = BTreeMap::new();
        for (row, nth) in rows.iter().zip(1..) {
            let (number, place) =
                row.read(checked, nth).ok_or_else(|| self.damaged(&Damage::Places.to_string()))?;
            places.insert(number, place);
        }
        Ok((rows.len() as u64, places.into_iter().collect()))
    }

    /// Starts the life of a new runner, whose events begin at `first`. Returns the number of the life.
    pub(in crate::journal) fn begin_life(&mut self, first: u64) -> Result<u32, JournalError> {
        let query =
            "INSERT INTO lives SELECT coalesce(max(life), 0) + 1, ?1 FROM lives RETURNING life";
        self.run(|connection| connection.query_row(query, [first.cast_signed()], |row| row.get(0)))
    }

    /// Moves the content of the write-ahead log into the database, and truncates the log.
    pub(in crate::journal) fn checkpoint(&mut self) -> Result<(), JournalError> {
        self.run(|connection| {
            connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()))
        })
    }

    /// Removes the write-ahead log, so that readers leave no files beside the database. Has no effect while the database has
    /// readers.
    pub(in crate::journal) fn leave_log(&mut self) -> Result<(), JournalError> {
        self.run(|connection| {
            connection.busy_timeout(Duration::ZERO)?;
            connection.query_row("PRAGMA journal_mode = delete", [], |_| Ok(()))
        })
    }

    pub(in crate::journal) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns an error: the database is damaged.
    pub(in crate::journal) fn damaged(&self, what: &str) -> JournalError {
        JournalError::Damaged { path: self.path.clone(), what: what.to_owned() }
    }
}

/// Removes the write-ahead log of the run in `folder` if it has no writers and readers. If a run ends while it is read, the reader
/// leaves files beside the database that take more disk space than a short run. Has no effect on a run that was not closed, and
/// none on failure: the next reader can retry.
pub fn leave_log(folder: &Path) {
    let is_left = |file: String| fs::exists(folder.join(file)).unwrap_or(false);
    if is_left(RECORDER_FILE.to_owned()) || !is_left(format!("{DATABASE_FILE}-shm")) {
        return;
    }
    if let Ok(mut database) = Database::open_with(folder, OpenFlags::SQLITE_OPEN_READ_WRITE) {
        drop(database.leave_log());
    }
}

/// Determines which rows of a journal have checksums. Reads the tables themselves, so that a damaged version number does not change
/// the result.
pub(in crate::journal) fn checks(connection: &Connection) -> rusqlite::Result<Checked> {
    let query = "SELECT \"notnull\" FROM pragma_table_info('blocks') WHERE name = 'sum'";
    let always: Option<bool> = connection.query_row(query, [], |row| row.get(0)).optional()?;
    Ok(match always {
        None => Checked::Never,
        Some(false) => Checked::Partly,
        Some(true) => Checked::Always,
    })
}

/// A row with a definition of a place.
#[derive(Debug)]
pub(in crate::journal) struct DefinedRow {
    nth: i64,
    number: i64,
    pub(in crate::journal) first: i64,
    data: Vec<u8>,
    sum: Option<i64>,
}

impl DefinedRow {
    /// Reads the columns `nth, number, first, data, sum`.
    pub(in crate::journal) fn of(row: &rusqlite::Row<'_>) -> rusqlite::Result<Self> {
        let [nth, number, first] = [row.get(0)?, row.get(1)?, row.get(2)?];
        Ok(Self { nth, number, first, data: row.get(3)?, sum: row.get(4)? })
    }

    /// Returns the definition, if it is undamaged and the `nth` of all.
    pub(in crate::journal) fn read(
        &self,
        checked: Checked,
        nth: i64,
    ) -> Option<(PlaceNumber, Place)> {
        let Self { number, first, data, sum, .. } = self;
        let right = || sums::of_place(nth, *number, *first, data);
        let is_right = self.nth == nth && checked.is_right(*sum, right);
        match Items::new(data, 0).next() {
            Some(Ok(Item::Definition(Definition::Place(number, place)))) if is_right => {
                (i64::from(number.0) == self.number).then_some((number, place))
            }
            _ => None,
        }
    }
}
