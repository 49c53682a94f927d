//! The tables of a journal, and what is put into them. Knows `SQLite`; must never know where rows come from.

use super::error::{Doing, JournalError};
use super::folder::{DATABASE_FILE, create_file};
use super::group::{Block, Group};
use super::pack::Hash;
use super::record::{Content, Item, Items, Place, PlaceNumber, ValueNumber};
use super::tracker::Keyframe;
use super::{Definition, binary};
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Transaction, params};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The version of the tables.
pub(super) const VERSION: u32 = 1;
/// How long others may hold the database.
const BUSY: Duration = Duration::from_secs(5);
/// The write-ahead log is cut to this after a checkpoint.
const WAL_BYTES: i64 = 4 << 20;
/// Values shorter than this stand where they are named.
const SHORT: usize = 128;

const TABLES: &str = "
    CREATE TABLE blocks(first INTEGER PRIMARY KEY, count INTEGER NOT NULL, t_before INTEGER NOT NULL,
        t_last INTEGER NOT NULL, data BLOB NOT NULL);
    CREATE TABLE places(number INTEGER NOT NULL, first INTEGER NOT NULL, data BLOB NOT NULL,
        PRIMARY KEY(number, first)) WITHOUT ROWID;
    CREATE TABLE vals(number INTEGER PRIMARY KEY, hash BLOB, data BLOB);
    CREATE TABLE blobs(hash BLOB PRIMARY KEY, data BLOB NOT NULL, uses INTEGER NOT NULL);
    CREATE TABLE large(name TEXT PRIMARY KEY, size INTEGER NOT NULL, uses INTEGER NOT NULL);
    CREATE TABLE keyframes(sequence INTEGER PRIMARY KEY, data BLOB NOT NULL, next_value INTEGER NOT NULL);
    CREATE TABLE named(number INTEGER PRIMARY KEY, last INTEGER NOT NULL);
    CREATE TABLE roots(hash BLOB PRIMARY KEY, base BLOB, data BLOB NOT NULL);
    CREATE TABLE files(hash BLOB PRIMARY KEY, data BLOB NOT NULL);
    CREATE TABLE lives(life INTEGER PRIMARY KEY, first INTEGER NOT NULL);
    CREATE TABLE thinned(before INTEGER PRIMARY KEY);
";

/// The open database of one run.
#[derive(Debug)]
pub(super) struct Database {
    connection: Connection,
    path: PathBuf,
}

impl Database {
    /// Makes the tables of a new run.
    pub(super) fn create(folder: &Path) -> Result<Self, JournalError> {
        let path = folder.join(DATABASE_FILE);
        // What lies beside it gets the same permissions.
        create_file(&path).map_err(|source| JournalError::io(&path, Doing::Write, source))?;
        let mut database = Self::open_with(folder, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        let text = format!("BEGIN IMMEDIATE; {TABLES} PRAGMA user_version = {VERSION}; COMMIT;");
        database.run(|connection| connection.execute_batch(&text))?;
        Ok(database)
    }

    /// Opens that of an earlier run, to go on with it.
    pub(super) fn open(folder: &Path) -> Result<Self, JournalError> {
        Self::known(folder, OpenFlags::SQLITE_OPEN_READ_WRITE)?.checked()
    }

    /// Opens that of any run, alive or not, to read it.
    pub(super) fn open_to_read(folder: &Path) -> Result<Self, JournalError> {
        Self::known(folder, OpenFlags::SQLITE_OPEN_READ_ONLY)?.checked()
    }

    fn known(folder: &Path, flags: OpenFlags) -> Result<Self, JournalError> {
        if folder.join(DATABASE_FILE).exists() {
            Self::open_with(folder, flags)
        } else {
            Err(JournalError::NoRun { folder: folder.to_owned(), file: DATABASE_FILE })
        }
    }

    /// Checks that its tables are of a version that is understood.
    fn checked(mut self) -> Result<Self, JournalError> {
        let query = |connection: &mut Connection| {
            connection.pragma_query_value(None, "user_version", |row| row.get(0))
        };
        match self.run(query)? {
            0 => Err(self.damaged("it has no tables")),
            found if found > VERSION => {
                Err(JournalError::Newer { path: self.path, found, known: VERSION })
            }
            _ => Ok(self),
        }
    }

    fn open_with(folder: &Path, flags: OpenFlags) -> Result<Self, JournalError> {
        let path = folder.join(DATABASE_FILE);
        let set_up = || {
            let connection =
                Connection::open_with_flags(&path, flags | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
            // A checkpoint of another may hold the database for a moment.
            connection.busy_timeout(BUSY)?;
            if flags.contains(OpenFlags::SQLITE_OPEN_READ_WRITE) {
                connection.pragma_update(None, "journal_mode", "wal")?;
                connection.pragma_update(None, "synchronous", "full")?;
                connection.pragma_update(None, "journal_size_limit", WAL_BYTES)?;
            }
            Ok(connection)
        };
        let connection = set_up().map_err(|source| JournalError::database(&path, source))?;
        Ok(Self { connection, path })
    }

    /// Does something with the connection.
    pub(super) fn run<T>(
        &mut self,
        action: impl FnOnce(&mut Connection) -> rusqlite::Result<T>,
    ) -> Result<T, JournalError> {
        action(&mut self.connection).map_err(|source| JournalError::database(&self.path, source))
    }

    /// Puts a group of events in; it is safe from a power cut when this returns. Whatever an earlier attempt put in after
    /// record number `committed` is replaced.
    pub(super) fn put(&mut self, group: &Group, committed: u64) -> Result<(), JournalError> {
        self.run(|connection| {
            let transaction = connection.transaction()?;
            delete_after(&transaction, committed)?;
            put_blocks(&transaction, group)?;
            if !group.places.is_empty() {
                put_places(&transaction, group)?;
            }
            if !group.values.is_empty() {
                put_values(&transaction, group)?;
            }
            if let Some(keyframe) = &group.keyframe {
                put_keyframe(&transaction, keyframe)?;
            }
            transaction.commit()
        })
    }

    /// Number of the last keyframe's record, and the number after that of the last value then.
    pub(super) fn last_keyframe(&mut self) -> Result<(u64, ValueNumber), JournalError> {
        let query = "SELECT sequence, next_value FROM keyframes ORDER BY sequence DESC LIMIT 1";
        let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
        let last = self.run(|connection| connection.query_row(query, [], row).optional())?;
        let (sequence, next_value): (i64, i64) = last.unwrap_or((0, 1));
        Ok((sequence.cast_unsigned(), ValueNumber(next_value.cast_unsigned())))
    }

    /// The last block, if there is one.
    pub(super) fn last_block(&mut self) -> Result<Option<Block>, JournalError> {
        let query =
            "SELECT first, count, t_before, t_last, data FROM blocks ORDER BY first DESC LIMIT 1";
        self.run(|connection| {
            let block = |row: &rusqlite::Row<'_>| {
                Ok(Block {
                    first: row.get::<_, i64>(0)?.cast_unsigned(),
                    count: row.get::<_, i64>(1)?.cast_unsigned(),
                    t_before: row.get::<_, i64>(2)?.cast_unsigned(),
                    t_last: row.get::<_, i64>(3)?.cast_unsigned(),
                    data: row.get(4)?,
                })
            };
            connection.query_row(query, [], block).optional()
        })
    }

    /// The number after the highest that a value has.
    pub(super) fn next_value(&mut self) -> Result<ValueNumber, JournalError> {
        let query = "SELECT coalesce(max(number), 0) + 1 FROM vals";
        let next: i64 = self.run(|connection| connection.query_row(query, [], |row| row.get(0)))?;
        Ok(ValueNumber(next.cast_unsigned()))
    }

    /// All places as they were defined last.
    pub(super) fn places(&mut self) -> Result<Vec<(PlaceNumber, Place)>, JournalError> {
        let query = "SELECT data, max(first) FROM places GROUP BY number ORDER BY number";
        let rows: Vec<Vec<u8>> = self.run(|connection| {
            let mut statement = connection.prepare(query)?;
            statement.query_map([], |row| row.get(0))?.collect()
        })?;
        let place = |bytes: &Vec<u8>| match Items::new(bytes, 0).next() {
            Some(Ok(Item::Definition(Definition::Place(number, place)))) => Ok((number, place)),
            _ => Err(self.damaged("a place that cannot be read")),
        };
        rows.iter().map(place).collect()
    }

    /// The number of this runner's life, one more than that of the last; events from `first` on are its own.
    pub(super) fn begin_life(&mut self, first: u64) -> Result<u32, JournalError> {
        let query =
            "INSERT INTO lives SELECT coalesce(max(life), 0) + 1, ?1 FROM lives RETURNING life";
        self.run(|connection| connection.query_row(query, [first.cast_signed()], |row| row.get(0)))
    }

    /// Moves everything from the write-ahead log into the database itself, and cuts the log.
    pub(super) fn checkpoint(&mut self) -> Result<(), JournalError> {
        self.run(|connection| {
            connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()))
        })
    }

    /// It has no machine with this hash.
    pub(super) fn no_machine(&self, hash: Hash) -> JournalError {
        JournalError::NoMachine { path: self.path.clone(), hash: hash.to_string() }
    }

    /// What is wrong with it.
    pub(super) fn damaged(&self, what: &str) -> JournalError {
        JournalError::Damaged { path: self.path.clone(), what: what.to_owned() }
    }
}

fn delete_after(transaction: &Transaction<'_>, committed: u64) -> rusqlite::Result<()> {
    let delete = "DELETE FROM blocks WHERE first > ?1";
    transaction.execute(delete, [committed.cast_signed()])?;
    Ok(())
}

fn put_blocks(transaction: &Transaction<'_>, group: &Group) -> rusqlite::Result<()> {
    let mut insert =
        transaction.prepare("INSERT OR REPLACE INTO blocks VALUES (?1, ?2, ?3, ?4, ?5)")?;
    for block in group.blocks() {
        let numbers = [block.first, block.count, block.t_before, block.t_last];
        let [first, count, t_before, t_last] = numbers.map(u64::cast_signed);
        insert.execute(params![first, count, t_before, t_last, block.data])?;
    }
    Ok(())
}

fn put_places(transaction: &Transaction<'_>, group: &Group) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare("INSERT OR REPLACE INTO places VALUES (?1, ?2, ?3)")?;
    let mut data = Vec::new();
    for (number, first, place) in &group.places {
        data.clear();
        binary::Writer::new(&mut data).place_definition(*number, place);
        insert.execute(params![number.0, first.cast_signed(), data])?;
    }
    Ok(())
}

fn put_values(transaction: &Transaction<'_>, group: &Group) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare("INSERT OR IGNORE INTO vals VALUES (?1, ?2, ?3)")?;
    let keep = "INSERT INTO blobs VALUES (?1, ?2, 1) ON CONFLICT DO UPDATE SET uses = uses + 1";
    let mut keep = transaction.prepare(keep)?;
    for (number, stored) in &group.values {
        let (number, data) = (number.0.cast_signed(), stored.to_bytes());
        let hash = (data.len() >= SHORT).then(|| *blake3::hash(&data).as_bytes());
        let short = if hash.is_some() { None } else { Some(&data) };
        if insert.execute(params![number, hash, short])? == 0 {
            continue;
        }
        if let Some(hash) = hash {
            keep.execute(params![hash, data])?;
        }
        if let Content::File { hash, size } = &stored.content {
            put_file(transaction, hash, *size)?;
        }
    }
    Ok(())
}

fn put_file(transaction: &Transaction<'_>, name: &str, size: u64) -> rusqlite::Result<()> {
    let keep = "INSERT INTO large VALUES (?1, ?2, 1) ON CONFLICT DO UPDATE SET uses = uses + 1";
    transaction.execute(keep, params![name, size.cast_signed()])?;
    Ok(())
}

fn put_keyframe(transaction: &Transaction<'_>, keyframe: &Keyframe) -> rusqlite::Result<()> {
    let insert = "INSERT OR REPLACE INTO keyframes VALUES (?1, ?2, ?3)";
    let numbers = [keyframe.sequence, keyframe.next_value.0].map(u64::cast_signed);
    transaction.execute(insert, params![numbers[0], keyframe.data, numbers[1]])?;
    let mut insert = transaction.prepare("INSERT OR REPLACE INTO named VALUES (?1, ?2)")?;
    for (number, last) in &keyframe.named {
        insert.execute([number.0.cast_signed(), last.cast_signed()])?;
    }
    Ok(())
}
