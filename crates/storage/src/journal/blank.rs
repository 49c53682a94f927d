//! Journals in which nothing has happened: those of runs whose runner died before their first event. Knows files; decides
//! nothing.

use super::database::Database;
use super::error::{Doing, JournalError};
use super::folder::{ABOUT_FILE, DATABASE_FILE, RECORDER_FILE, SPILL_FOLDER, sync_folder};
use super::leftovers::Leftovers;
use std::fs;
use std::io;
use std::path::Path;

/// Whether anything has happened in the run of this folder: no script runs before its first event is kept. What cannot be
/// read has begun.
pub fn has_begun(folder: &Path) -> bool {
    folder.join(ABOUT_FILE).exists() && !is_blank(folder).unwrap_or(false)
}

/// Whether the folder has no event of a run.
pub(super) fn is_blank(folder: &Path) -> Result<bool, JournalError> {
    let in_database = match folder.join(DATABASE_FILE).metadata() {
        // Its first transaction was not committed: it has no tables.
        Ok(about) if about.len() == 0 => 0,
        Ok(_) => events_in_database(folder)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => 0,
        Err(source) => {
            return Err(JournalError::io(&folder.join(DATABASE_FILE), Doing::Read, source));
        }
    };
    Ok(in_database == 0 && Leftovers::read(folder)?.frames(0).is_empty())
}

fn events_in_database(folder: &Path) -> Result<i64, JournalError> {
    let mut database = Database::open_unchecked(folder)?;
    let tables = "SELECT count(*) FROM sqlite_master WHERE name = 'blocks'";
    let events = "SELECT coalesce(max(first + count - 1), 0) FROM blocks";
    let number = |database: &mut Database, query| {
        database.run(|connection| connection.query_row(query, [], |row| row.get::<_, i64>(0)))
    };
    if number(&mut database, tables)? == 0 { Ok(0) } else { number(&mut database, events) }
}

/// Removes a journal, what tells that there is one first.
pub(super) fn discard(folder: &Path) -> Result<(), JournalError> {
    let database = |suffix: &str| format!("{DATABASE_FILE}{suffix}");
    let files = [database("-shm"), database("-wal"), database(""), RECORDER_FILE.to_owned()];
    let mut is_changed = remove(folder, ABOUT_FILE)?;
    for file in files {
        is_changed |= remove(folder, &file)?;
    }
    // What is too large for the recorder; empty, if it is there at all.
    drop(fs::remove_dir_all(folder.join(SPILL_FOLDER)));
    if is_changed { sync_folder(folder) } else { Ok(()) }
}

/// Whether there was such a file.
fn remove(folder: &Path, file: &str) -> Result<bool, JournalError> {
    let path = folder.join(file);
    match fs::remove_file(&path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(source) => Err(JournalError::io(&path, Doing::Remove, source)),
    }
}

#[cfg(test)]
mod tests {
    use super::has_begun;
    use crate::journal::folder::{ABOUT_FILE, DATABASE_FILE, RECORDER_FILE};
    use crate::journal::{About, Journal, JournalError, Options, notation};
    use std::fs;
    use std::path::Path;

    fn create(folder: &Path, name: &str) -> Result<Journal, JournalError> {
        let about = About { name: name.to_owned(), ..About::default() };
        Journal::create(folder, &about, &Options::default())
    }

    #[test]
    fn a_journal_without_an_event_is_begun_anew_and_one_with_an_event_never() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!has_begun(folder.path()));
        drop(create(folder.path(), "first").unwrap());
        assert!(!has_begun(folder.path()));
        let journal = create(folder.path(), "second").unwrap();
        let batch = notation::batch("place R \"Root\" outcome done\nenter R\n", 0).unwrap();
        journal.append(&batch).unwrap();
        drop(journal);
        assert!(has_begun(folder.path()));
        let refused = create(folder.path(), "third").unwrap_err();
        assert!(matches!(refused, JournalError::Exists { .. }), "{refused}");
        assert_eq!(About::read(folder.path()).unwrap().name, "second");
    }

    #[test]
    fn a_journal_that_was_only_half_made_is_made_again() {
        let steps = [DATABASE_FILE, RECORDER_FILE, ABOUT_FILE];
        for made in 0..steps.len() {
            let folder = tempfile::tempdir().unwrap();
            drop(create(folder.path(), "first").unwrap());
            for missing in &steps[made..] {
                fs::remove_file(folder.path().join(missing)).unwrap();
            }
            assert!(!has_begun(folder.path()), "{made} steps");
            drop(create(folder.path(), "second").unwrap());
            assert_eq!(About::read(folder.path()).unwrap().name, "second");
        }
    }

    #[test]
    fn a_database_without_tables_is_one_of_a_run_that_never_began() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(DATABASE_FILE), "").unwrap();
        drop(create(folder.path(), "first").unwrap());
        create(folder.path(), "second").unwrap().discard().unwrap();
        assert!(!folder.path().join(ABOUT_FILE).exists());
    }
}
