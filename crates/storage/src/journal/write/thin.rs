//! Limits the size of a journal while its run is active: each commit deletes some old detail. Values and log texts of old events
//! are deleted first, then the events themselves. Handles the tables of the database.

use crate::journal::folder::{JournalError, VALUES_FOLDER};
use crate::journal::moment::{values_in, without_values};
use crate::journal::record::{Content, Item, Items, Kept, Stored};
use crate::journal::store::Database;
use crate::journal::store::sums::{self, Checked, RowHeader};
use rusqlite::{Connection, OptionalExtension as _, Statement, Transaction, params};
use std::fs;
use std::path::Path;

/// Maximum size of rewritten rows in one commit, in bytes.
const SLICE_BYTES: usize = 2 << 20;
/// Maximum number of examined values or rows in one commit.
const SLICE_ROWS: i64 = 10_000;

/// Progress of a deletion, which may take several commits.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Work {
    /// No deletion is in progress.
    #[default]
    None,
    /// Detail of events up to `until`. Completed up to `at`.
    Detail { until: i64, at: i64 },
    /// Values that no event after `until` uses. Completed below `at`.
    Values { until: i64, at: i64, end: i64 },
    /// Whole rows of events before event number `before`.
    Events { before: i64 },
}

/// Deletes old detail when the journal is too large.
#[derive(Debug)]
pub(in crate::journal) struct DetailPruner {
    size_max: u64,
    work: Work,
    /// Last event without detail.
    border: i64,
    checked: Checked,
}

/// Result of one slice of work.
#[derive(Debug, Default)]
struct Slice {
    next: Work,
    /// Files of unused values.
    files: Vec<String>,
    finished: Option<i64>,
}

impl DetailPruner {
    /// Continues the work that `database` records.
    pub(in crate::journal) fn new(
        size_max: u64,
        database: &mut Database,
    ) -> Result<Self, JournalError> {
        let border = database.run(|connection| {
            let query = "SELECT coalesce(max(before), 1) - 1 FROM thinned";
            connection.query_row(query, [], |row| row.get(0))
        })?;
        let checked = database.checks()?;
        Ok(Self { size_max, work: Work::None, border, checked })
    }

    /// Deletes some detail if the journal is too large. Returns the first event with full detail, if that changed.
    pub(in crate::journal) fn thin(
        &mut self,
        database: &mut Database,
        folder: &Path,
    ) -> Result<Option<u64>, JournalError> {
        if self.work == Work::None {
            if database.run(size)? <= self.size_max {
                return Ok(None);
            }
            let border = self.border;
            self.work = database.run(|connection| choose(connection, border))?;
        }
        let (work, border, checked) = (self.work, self.border, self.checked);
        let slice = database.run(|connection| slice(connection, work, border, checked))?;
        self.work = slice.next;
        for name in slice.files {
            // A file that cannot be removed only takes space.
            drop(fs::remove_file(folder.join(VALUES_FOLDER).join(name)));
        }
        self.border = slice.finished.unwrap_or(self.border);
        Ok(slice.finished.map(|border| border.cast_unsigned() + 1))
    }
}

/// Returns the size of the journal in bytes, without free pages.
fn size(connection: &mut Connection) -> rusqlite::Result<u64> {
    let number = |query: &str| connection.query_row(query, [], |row| row.get::<_, i64>(0));
    let pages =
        number("SELECT page_count - freelist_count FROM pragma_page_count, pragma_freelist_count")?;
    let page = number("SELECT page_size FROM pragma_page_size")?;
    let large = number("SELECT coalesce(sum(size), 0) FROM large")?;
    Ok((pages * page + large).cast_unsigned())
}

/// Selects what to delete: the detail of the older half of the detailed events, or else the older half of the other events.
fn choose(connection: &Connection, border: i64) -> rusqlite::Result<Work> {
    let middle = |condition: &str| {
        let query = format!(
            "SELECT sequence FROM keyframes WHERE {condition} ORDER BY sequence LIMIT 1 OFFSET
                (SELECT count(*) / 2 FROM keyframes WHERE {condition})"
        );
        connection.query_row(&query, [border], |row| row.get::<_, i64>(0)).optional()
    };
    if let Some(until) = middle("sequence > ?1")? {
        return Ok(Work::Detail { until, at: border });
    }
    let before = middle("sequence <= ?1")?;
    let first: Option<i64> =
        connection.query_row("SELECT min(first) FROM blocks", [], |row| row.get(0))?;
    let is_less = |before: &i64| first.is_some_and(|first| first < *before);
    Ok(before.filter(is_less).map_or(Work::None, |before| Work::Events { before }))
}

fn slice(
    connection: &mut Connection,
    work: Work,
    border: i64,
    checked: Checked,
) -> rusqlite::Result<Slice> {
    let transaction = connection.transaction()?;
    let slice = match work {
        Work::None => Slice::default(),
        Work::Detail { until, at } => detail(&transaction, until, at, border, checked)?,
        Work::Values { until, at, end } => values(&transaction, until, at, end)?,
        Work::Events { before } => events(&transaction, before)?,
    };
    transaction.commit()?;
    Ok(slice)
}

/// Rewrites some rows without detail. Damaged rows are not changed.
fn detail(
    transaction: &Transaction<'_>,
    until: i64,
    mut at: i64,
    border: i64,
    checked: Checked,
) -> rusqlite::Result<Slice> {
    let next = "SELECT first, count, t_before, t_last, data, sum FROM blocks
        WHERE first + count - 1 > ?1
        AND first >= coalesce((SELECT max(first) FROM blocks WHERE first <= ?1), 0) ORDER BY first LIMIT 1";
    let mut next = transaction.prepare(next)?;
    let mut update =
        transaction.prepare("UPDATE blocks SET data = ?2, sum = ?3 WHERE first = ?1")?;
    let mut bytes = 0;
    while at < until && bytes < SLICE_BYTES {
        let row = |row: &rusqlite::Row<'_>| {
            let [first, count] = [row.get(0)?, row.get(1)?];
            let [t_before, t_last] = [row.get(2)?, row.get(3)?];
            Ok((RowHeader { first, count, t_before, t_last }, row.get(4)?, row.get(5)?))
        };
        let Some((head, data, sum)) = next.query_row([at], row).optional()? else {
            break;
        };
        let data: Vec<u8> = data;
        let RowHeader { first, count, t_before, .. } = head;
        if checked.is_right(sum, || head.sum(&data)) {
            let thin = thinned(&data, t_before.cast_unsigned(), until - first + 1);
            let sum = (checked == Checked::Always || sum.is_some()).then(|| head.sum(&thin));
            update.execute(params![first, thin, sum])?;
        }
        bytes += data.len();
        at = first.saturating_add(count).saturating_sub(1).clamp(at + 1, until);
    }
    if at < until && bytes >= SLICE_BYTES {
        return Ok(Slice { next: Work::Detail { until, at }, ..Slice::default() });
    }
    keyframes(transaction, until, border)
}

/// Rewrites the keyframes before `until`, and records the values that the keyframe at `until` uses.
fn keyframes(transaction: &Transaction<'_>, until: i64, border: i64) -> rusqlite::Result<Slice> {
    let mut old = transaction.prepare(
        "SELECT sequence, next_value, data, sum FROM keyframes WHERE sequence BETWEEN ?1 AND ?2",
    )?;
    let row = |row: &rusqlite::Row<'_>| {
        Ok((row.get::<_, i64>(0)?, row.get::<_, i64>(1)?, row.get::<_, Vec<u8>>(2)?, row.get(3)?))
    };
    let old: Vec<_> = old.query_map([border, until], row)?.collect::<Result<_, _>>()?;
    let note = "INSERT INTO named VALUES (?1, ?2) ON CONFLICT DO UPDATE SET last = max(last, ?2)";
    let mut note = transaction.prepare(note)?;
    for (sequence, next_value, data, sum) in old {
        let sum: Option<i64> = sum;
        let right = |data: &[u8]| sums::of_keyframe(sequence, next_value, data);
        let is_right = sum.is_none_or(|sum| sum == right(&data));
        if sequence < until {
            // A damaged keyframe is useless.
            let data =
                if is_right { without_values(&data).unwrap_or_default() } else { Vec::new() };
            let update = "UPDATE keyframes SET data = ?2, sum = ?3 WHERE sequence = ?1";
            transaction.execute(update, params![sequence, data, sum.map(|_| right(&data))])?;
            continue;
        }
        let mut numbers = Vec::new();
        let seen = values_in(&data, &mut |value| {
            if let Kept::Value(number) = value {
                numbers.push(number.0.cast_signed());
            }
        });
        drop(seen);
        for number in numbers {
            note.execute([number, until + 1])?;
        }
    }
    let end = "SELECT next_value FROM keyframes WHERE sequence = ?1";
    let end = transaction.query_row(end, [until], |row| row.get(0))?;
    let begin = "SELECT coalesce(max(next_value), 1) FROM keyframes WHERE sequence <= ?1";
    let at = transaction.query_row(begin, [border], |row| row.get(0))?;
    Ok(Slice { next: Work::Values { until, at, end }, ..Slice::default() })
}

/// Deletes some values that are not used after `until`.
fn values(transaction: &Transaction<'_>, until: i64, at: i64, end: i64) -> rusqlite::Result<Slice> {
    let stop = end.min(at + SLICE_ROWS);
    let fresh = "SELECT number FROM vals WHERE number >= ?1 AND number < ?2
        AND number NOT IN (SELECT number FROM named WHERE last > ?3)";
    let mut numbers: Vec<i64> = transaction
        .prepare(fresh)?
        .query_map([at, stop, until], |row| row.get(0))?
        .collect::<Result<_, _>>()?;
    if stop == end {
        let old = "DELETE FROM named WHERE last <= ?1 RETURNING number";
        let mut old = transaction.prepare(old)?;
        numbers.extend(old.query_map([until], |row| row.get(0))?.collect::<Result<Vec<i64>, _>>()?);
    }
    let mut forgetting = Forgetting::new(transaction)?;
    for number in numbers {
        forgetting.value(number)?;
    }
    let files = std::mem::take(&mut forgetting.files);
    if stop < end {
        return Ok(Slice { next: Work::Values { until, at: stop, end }, files, finished: None });
    }
    let insert = "INSERT OR REPLACE INTO thinned(before, sum) VALUES (?1, ?2)";
    transaction.execute(insert, [until + 1, sums::of_number("thinned", until + 1)])?;
    Ok(Slice { next: Work::None, files, finished: Some(until) })
}

/// Deletes some of the oldest events.
fn events(transaction: &Transaction<'_>, before: i64) -> rusqlite::Result<Slice> {
    let delete = "DELETE FROM blocks WHERE first IN
        (SELECT first FROM blocks WHERE first + count <= ?1 ORDER BY first LIMIT ?2)";
    let gone = transaction.execute(delete, [before, SLICE_ROWS])?;
    transaction.execute("DELETE FROM keyframes WHERE sequence < ?1", [before])?;
    let more = i64::try_from(gone).is_ok_and(|gone| gone == SLICE_ROWS);
    Ok(Slice { next: if more { Work::Events { before } } else { Work::None }, ..Slice::default() })
}

/// Returns the items of a row, the first `count` of them without detail. Skips unreadable items.
fn thinned(data: &[u8], t_before: u64, count: i64) -> Vec<u8> {
    let (mut out, mut before) = (Vec::new(), t_before);
    let items = Items::new(data, t_before).map_while(Result::ok);
    for (mut item, index) in items.zip(0_i64..) {
        if let Item::Record(_, record) = &mut item
            && index < count
        {
            record.forget_values();
        }
        item.write(&mut before, &mut out);
    }
    out
}

/// Deletes values one after the other.
#[derive(Debug)]
struct Forgetting<'t> {
    value: Statement<'t>,
    use_less: Statement<'t>,
    unused: Statement<'t>,
    file_use_less: Statement<'t>,
    file_unused: Statement<'t>,
    /// Unused files, to be removed after the commit.
    files: Vec<String>,
}

impl<'t> Forgetting<'t> {
    fn new(transaction: &'t Transaction<'_>) -> rusqlite::Result<Self> {
        let prepare = |text: &str| transaction.prepare(text);
        Ok(Self {
            value: prepare("DELETE FROM vals WHERE number = ?1 RETURNING hash, data")?,
            use_less: prepare("UPDATE blobs SET uses = uses - 1 WHERE hash = ?1 RETURNING data")?,
            unused: prepare("DELETE FROM blobs WHERE hash = ?1 AND uses < 1")?,
            file_use_less: prepare("UPDATE large SET uses = uses - 1 WHERE name = ?1")?,
            file_unused: prepare("DELETE FROM large WHERE name = ?1 AND uses < 1")?,
            files: Vec::new(),
        })
    }

    /// Deletes the value with this number.
    fn value(&mut self, number: i64) -> rusqlite::Result<()> {
        let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
        let value = self.value.query_row([number], row).optional()?;
        let (hash, mut data): (Option<Vec<u8>>, Option<Vec<u8>>) = value.unwrap_or_default();
        if let Some(hash) = hash {
            data = self.use_less.query_row([&hash], |row| row.get(0)).optional()?;
            self.unused.execute([&hash])?;
        }
        match data.as_deref().map(Stored::from_bytes) {
            Some(Ok(Stored { content: Content::File { hash, .. }, .. })) => self.file(hash),
            _ => Ok(()),
        }
    }

    fn file(&mut self, name: String) -> rusqlite::Result<()> {
        self.file_use_less.execute([&name])?;
        if self.file_unused.execute([&name])? > 0 {
            self.files.push(name);
        }
        Ok(())
    }
}
