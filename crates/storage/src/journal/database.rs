//! The tables of a journal, and what is put into them. Knows `SQLite`; must never know where rows come from.

use super::error::{Doing, JournalError};
use super::folder::{DATABASE_FILE, create_file};
use super::group::{Block, Group};
use super::pack::Hash;
use super::record::{Content, Item, Items, Place, PlaceNumber, ValueNumber};
use super::sums::{self, Checked, Damage, RowHeader};
use super::tracker::Keyframe;
use super::{Definition, binary};
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Transaction, params};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The version of the tables.
pub(super) const VERSION: u32 = 2;
/// The version whose rows have no checksums.
pub(super) const UNCHECKED: u32 = 1;
/// How long others may hold the database.
const BUSY: Duration = Duration::from_secs(5);
/// The write-ahead log is cut to this after a checkpoint.
const WAL_BYTES: i64 = 4 << 20;
/// Values shorter than this stand where they are named.
const SHORT: usize = 128;

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

/// Makes the tables of the version before those of this one; what is in them stays without checksums.
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
        let (mut database, found) =
            Self::known(folder, OpenFlags::SQLITE_OPEN_READ_WRITE)?.checked()?;
        if found == UNCHECKED {
            let text =
                format!("BEGIN IMMEDIATE; {UPGRADE} PRAGMA user_version = {VERSION}; COMMIT;");
            database.run(|connection| connection.execute_batch(&text))?;
        }
        Ok(database)
    }

    /// Opens that of any run, alive or not, to read it.
    pub(super) fn open_to_read(folder: &Path) -> Result<Self, JournalError> {
        Ok(Self::known(folder, OpenFlags::SQLITE_OPEN_READ_ONLY)?.checked()?.0)
    }

    /// Opens one that may have no tables yet.
    pub(super) fn open_unchecked(folder: &Path) -> Result<Self, JournalError> {
        Self::known(folder, OpenFlags::SQLITE_OPEN_READ_ONLY)
    }

    fn known(folder: &Path, flags: OpenFlags) -> Result<Self, JournalError> {
        if folder.join(DATABASE_FILE).exists() {
            Self::open_with(folder, flags)
        } else {
            Err(JournalError::NoRun { folder: folder.to_owned(), file: DATABASE_FILE })
        }
    }

    /// Checks that its tables are of a version that is understood, and says of which.
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
    /// record number `committed` and definition number `places` is replaced.
    pub(super) fn put(
        &mut self,
        group: &Group,
        committed: u64,
        places: u64,
    ) -> Result<(), JournalError> {
        self.run(|connection| {
            let transaction = connection.transaction()?;
            delete_after(&transaction, committed)?;
            put_blocks(&transaction, group)?;
            if !group.places.is_empty() {
                put_places(&transaction, group, places)?;
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

    /// The last block, if there is one.
    pub(super) fn last_block(&mut self) -> Result<Option<Block>, JournalError> {
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

    /// What its rows say about their checksums.
    pub(super) fn checks(&mut self) -> Result<Checked, JournalError> {
        self.run(|connection| checks(connection))
    }

    /// The run ended after this record, and its runner came to its end as well.
    pub(super) fn put_end(&mut self, sequence: u64) -> Result<(), JournalError> {
        let sequence = sequence.cast_signed();
        self.run(|connection| {
            let insert = "INSERT OR REPLACE INTO ends VALUES (?1, ?2)";
            connection.execute(insert, [sequence, sums::of_number("ends", sequence)]).map(drop)
        })
    }

    /// The number after the highest that a value has.
    pub(super) fn next_value(&mut self) -> Result<ValueNumber, JournalError> {
        let query = "SELECT coalesce(max(number), 0) + 1 FROM vals";
        let next: i64 = self.run(|connection| connection.query_row(query, [], |row| row.get(0)))?;
        Ok(ValueNumber(next.cast_unsigned()))
    }

    /// All places as they were defined last, and how many definitions there are.
    pub(super) fn places(&mut self) -> Result<(u64, Vec<(PlaceNumber, Place)>), JournalError> {
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
    let mut insert = transaction.prepare(
        "INSERT OR REPLACE INTO blocks(first, count, t_before, t_last, data, sum)
            VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
    )?;
    for block in group.blocks() {
        let head = RowHeader::of(block);
        let RowHeader { first, count, t_before, t_last } = head;
        let sum = head.sum(&block.data);
        insert.execute(params![first, count, t_before, t_last, block.data, sum])?;
    }
    Ok(())
}

fn put_places(transaction: &Transaction<'_>, group: &Group, before: u64) -> rusqlite::Result<()> {
    transaction.execute("DELETE FROM places WHERE nth > ?1", [before.cast_signed()])?;
    let mut insert = transaction
        .prepare("INSERT INTO places(nth, number, first, data, sum) VALUES (?1, ?2, ?3, ?4, ?5)")?;
    let mut data = Vec::new();
    for ((number, first, place), nth) in group.places.iter().zip(before.cast_signed() + 1..) {
        data.clear();
        binary::BinaryWriter::new(&mut data).place_definition(*number, place);
        let (number, first) = (i64::from(number.0), first.cast_signed());
        let sum = sums::of_place(nth, number, first, &data);
        insert.execute(params![nth, number, first, data, sum])?;
    }
    Ok(())
}

fn put_values(transaction: &Transaction<'_>, group: &Group) -> rusqlite::Result<()> {
    let mut insert = transaction
        .prepare("INSERT OR IGNORE INTO vals(number, hash, data, sum) VALUES (?1, ?2, ?3, ?4)")?;
    let keep = "INSERT INTO blobs VALUES (?1, ?2, 1) ON CONFLICT DO UPDATE SET uses = uses + 1";
    let mut keep = transaction.prepare(keep)?;
    for (number, stored) in &group.values {
        let (number, data) = (number.0.cast_signed(), stored.to_bytes());
        let hash = (data.len() >= SHORT).then(|| *blake3::hash(&data).as_bytes());
        let short = if hash.is_some() { None } else { Some(&data[..]) };
        let sum = sums::of_value(number, hash.as_ref().map(|hash| &hash[..]), short);
        if insert.execute(params![number, hash, short, sum])? == 0 {
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
    let insert = "INSERT OR REPLACE INTO keyframes(sequence, data, next_value, sum)
        VALUES (?1, ?2, ?3, ?4)";
    let [sequence, next_value] = [keyframe.sequence, keyframe.next_value.0].map(u64::cast_signed);
    let sum = sums::of_keyframe(sequence, next_value, &keyframe.data);
    transaction.execute(insert, params![sequence, keyframe.data, next_value, sum])?;
    let mut insert = transaction.prepare("INSERT OR REPLACE INTO named VALUES (?1, ?2)")?;
    for (number, last) in &keyframe.named {
        insert.execute([number.0.cast_signed(), last.cast_signed()])?;
    }
    Ok(())
}

/// What the rows of a journal say about their checksums: by the tables themselves, so that a changed number of the version does
/// not make them say something else.
pub(super) fn checks(connection: &Connection) -> rusqlite::Result<Checked> {
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
pub(super) struct DefinedRow {
    nth: i64,
    number: i64,
    pub(super) first: i64,
    data: Vec<u8>,
    sum: Option<i64>,
}

impl DefinedRow {
    /// Of `nth, number, first, data, sum`.
    pub(super) fn of(row: &rusqlite::Row<'_>) -> rusqlite::Result<Self> {
        let [nth, number, first] = [row.get(0)?, row.get(1)?, row.get(2)?];
        Ok(Self { nth, number, first, data: row.get(3)?, sum: row.get(4)? })
    }

    /// The definition, if it is as it was written and the `nth` of all.
    pub(super) fn read(&self, checked: Checked, nth: i64) -> Option<(PlaceNumber, Place)> {
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
