//! Files in the folder of a run, and the creation of that folder. Defines names, not the content of the files.

mod about;
mod content_hash;
mod end_values;
mod error;
mod lock;
mod run_name;
mod socket;

pub use about::About;
pub use content_hash::{ContentHash, is_content_here};
pub use end_values::{END_VALUES_FILE, EndValues};
pub use error::{Doing, Full, JournalError};
pub(in crate::journal) use lock::RunLock;
pub use lock::{locks, writer_of};
pub(in crate::journal) use run_name::GONE;
pub use run_name::{BadRunId, RUN_ID_MAX, check_run_id};
pub use socket::bind_socket;

use rafcon_protocol::calendar::Date;
use rustix::fs::{Mode, mkdir};
use rustix::io::Errno;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};

/// Description of the run: [`crate::journal::About`] as JSON.
pub const ABOUT_FILE: &str = "run.json";
/// `SQLite` database of the events that survive a power cut.
pub const DATABASE_FILE: &str = "journal.db";
/// Newest events: a mapped file in front of the database.
pub const RECORDER_FILE: &str = "recorder";
/// Large values, one file each, named by their BLAKE3 hash in hex.
pub const VALUES_FOLDER: &str = "values";
/// Groups of events that are too large for the recorder, until they are in the database.
pub const SPILL_FOLDER: &str = "spill";
/// File that the writing process locks.
pub const LOCK_FILE: &str = "lock";
/// Socket of an active run.
pub const SOCKET_FILE: &str = "socket";
/// Reason as text, in a replica whose history differs from the robot's run.
pub const DIVERGED_FILE: &str = "diverged";
/// An empty file in a replica whose run crashed on the robot, or was deleted there before its end.
pub const CRASHED_FILE: &str = "crashed";

/// Creates the folder of a run and its parents, accessible to the owner only. The folder may exist.
pub fn make_folder(folder: &Path) -> Result<(), JournalError> {
    let failed = |source| JournalError::io(folder, Doing::Make, source);
    if let Some(parent) = folder.parent() {
        fs::create_dir_all(parent).map_err(failed)?;
    }
    match mkdir(folder, Mode::RWXU) {
        // The name of the folder must survive a power cut too.
        Ok(()) => folder.parent().filter(|parent| parent.is_dir()).map_or(Ok(()), sync_folder),
        Err(Errno::EXIST) => Ok(()),
        Err(error) => Err(failed(error.into())),
    }
}

/// Returns the id of a run: its start (UTC), the name of its machine, and four digits that distinguish runs of one second.
pub fn run_id(started_ms: u64, name: &str, salt: u16) -> String {
    let Date { year, month, day, hour, minute, second } = Date::since_1970(started_ms / 1000);
    let name = slug(name);
    format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}-{name}-{salt:04x}")
}

/// Reduces a text to lower case letters and digits, separated by single hyphens.
fn slug(name: &str) -> String {
    const LONGEST: usize = 40;
    let lower = name.to_lowercase();
    let words = lower.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let mut slug = words.collect::<Vec<_>>().join("-");
    slug.truncate(LONGEST);
    let slug = slug.trim_end_matches('-');
    if slug.is_empty() { "run".to_owned() } else { slug.to_owned() }
}

/// Makes the names in `folder` safe from a power cut.
pub(in crate::journal) fn sync_folder(folder: &Path) -> Result<(), JournalError> {
    let synced = File::open(folder).and_then(|folder| folder.sync_all());
    synced.map_err(|source| JournalError::io(folder, Doing::Sync, source))
}

/// Replaces a file atomically: a crash leaves the old one or the new one.
pub fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), JournalError> {
    use std::io::Write as _;
    let fresh = fresh_name(path);
    let write = || {
        let mut file = create_file(&fresh)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&fresh, path)
    };
    write().map_err(|source| JournalError::io(path, Doing::Write, source))?;
    path.parent().map_or(Ok(()), sync_folder)
}

/// Creates a file that only its owner can access, or truncates an existing one.
pub(in crate::journal) fn create_file(path: &Path) -> io::Result<File> {
    OpenOptions::new().read(true).write(true).create(true).truncate(true).mode(0o600).open(path)
}

/// Returns the temporary name of a file.
pub(in crate::journal) fn fresh_name(path: &Path) -> PathBuf {
    path.with_extension("new")
}

#[cfg(test)]
mod tests {
    use super::run_id;

    fn check(started_ms: u64, name: &str, id: &str) {
        assert_eq!(run_id(started_ms, name, 0xbee), id);
    }

    #[test]
    fn ids_of_runs_sort_by_time_and_name_their_machine() {
        check(0, "Pick & Place", "19700101-000000-pick-place-0bee");
        check(951_782_399_999, "é", "20000228-235959-run-0bee");
        check(951_782_400_000, "", "20000229-000000-run-0bee");
        check(
            1_795_290_001_000,
            "x".repeat(90).as_str(),
            &format!("20261121-194001-{}-0bee", "x".repeat(40)),
        );
    }
}
