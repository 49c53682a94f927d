//! Journals without events, of runs whose runner died before the first event. Checks and removes files; callers decide.

use crate::journal::folder::{
    ABOUT_FILE, DATABASE_FILE, Doing, JournalError, RECORDER_FILE, SPILL_FOLDER, sync_folder,
};
use crate::journal::store::Database;
use crate::journal::store::leftovers::Leftovers;
use std::fs;
use std::io;
use std::path::Path;

/// Returns true if the run in this folder has an event. No script runs before the first event is stored. A run that cannot be read
/// counts as begun.
pub fn has_begun(folder: &Path) -> bool {
    folder.join(ABOUT_FILE).exists() && !is_blank(folder).unwrap_or(false)
}

/// Returns true if the folder contains no event of a run.
pub(in crate::journal) fn is_blank(folder: &Path) -> Result<bool, JournalError> {
    let in_database = match folder.join(DATABASE_FILE).metadata() {
        // Without its first transaction, the database has no tables.
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

/// Removes a journal, beginning with the file that identifies it.
pub(in crate::journal) fn discard(folder: &Path) -> Result<(), JournalError> {
    let database = |suffix: &str| format!("{DATABASE_FILE}{suffix}");
    let files = [database("-shm"), database("-wal"), database(""), RECORDER_FILE.to_owned()];
    let mut is_changed = remove(folder, ABOUT_FILE)?;
    for file in files {
        is_changed |= remove(folder, &file)?;
    }
    // The folder of large frames. It is empty, if it exists.
    drop(fs::remove_dir_all(folder.join(SPILL_FOLDER)));
    if is_changed { sync_folder(folder) } else { Ok(()) }
}

/// Removes a file. Returns false if it did not exist.
fn remove(folder: &Path, file: &str) -> Result<bool, JournalError> {
    let path = folder.join(file);
    match fs::remove_file(&path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(source) => Err(JournalError::io(&path, Doing::Remove, source)),
    }
}
