//! Deletion of runs to free disk space. Handles folders of runs; has no clock.

use crate::journal::folder::{About, Doing, GONE, JournalError, RunLock, writer_of};
use crate::journal::read::{run_folders, size_of};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Retention limits for runs. The newest runs are kept whatever their size, and so are all active runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Retention {
    /// Maximum number of runs.
    pub count: usize,
    /// Maximum age of a run.
    pub age: Option<Duration>,
    /// Maximum total size in bytes.
    pub bytes: u64,
    /// Number of newest runs that are always kept.
    pub newest: usize,
}

impl Default for Retention {
    fn default() -> Self {
        Self { count: 200, age: None, bytes: 20 << 30, newest: 10 }
    }
}

/// A run that was deleted by the retention limits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pruned {
    /// Name of the run's folder.
    pub id: String,
    /// Size that it had on disk, in bytes.
    pub bytes: u64,
}

/// Facts about a run that determine whether it is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Run {
    started_ms: u64,
    bytes: u64,
    is_live: bool,
}

impl Retention {
    /// Deletes the runs in `folder` that exceed the limits at the time `now_ms` (since 1970).
    pub fn prune(&self, folder: &Path, now_ms: u64) -> Result<Vec<Pruned>, JournalError> {
        remove_leftovers(folder);
        let folders = run_folders(folder)?;
        let runs: Vec<Run> = folders.iter().map(|folder| inspect(folder)).collect();
        let doomed = self.doomed(&runs, now_ms);
        let mut pruned = Vec::new();
        for index in doomed {
            match delete(&folders[index]) {
                Ok(Some(id)) => pruned.push(Pruned { id, bytes: runs[index].bytes }),
                // Another process deleted it, or is resuming it now.
                Ok(None) | Err(JournalError::Going { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(pruned)
    }

    /// Selects the runs to delete from a list sorted from old to new.
    fn doomed(&self, runs: &[Run], now_ms: u64) -> Vec<usize> {
        let mut count = runs.len();
        let mut bytes: u64 = runs.iter().map(|run| run.bytes).sum();
        let oldest = self.age.map(|age| now_ms.saturating_sub(millis(age)));
        let may_go = runs.len().saturating_sub(self.newest.max(1));
        let mut doomed = Vec::new();
        for (index, run) in runs.iter().enumerate().take(may_go) {
            let is_old = oldest.is_some_and(|oldest| run.started_ms < oldest);
            if !run.is_live && (is_old || count > self.count || bytes > self.bytes) {
                doomed.push(index);
                count -= 1;
                bytes -= run.bytes;
            }
        }
        doomed
    }
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

fn inspect(folder: &Path) -> Run {
    Run {
        // A run without a start time does not count as old.
        started_ms: About::read(folder).map_or(u64::MAX, |about| about.started_ms),
        bytes: size_of(folder),
        // A run whose lock cannot be checked is kept.
        is_live: writer_of(folder).map_or(true, |process| process.is_some()),
    }
}

/// Deletes a run that is not active. `None` if the folder contains no run.
pub fn remove(folder: &Path) -> Result<Option<Pruned>, JournalError> {
    let bytes = size_of(folder);
    Ok(delete(folder)?.map(|id| Pruned { id, bytes }))
}

/// Deletes the folder of a run. Renames it first, so that a half-deleted run is never visible. The run cannot be resumed meanwhile.
/// `None` if the folder no longer exists.
fn delete(folder: &Path) -> Result<Option<String>, JournalError> {
    let id = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let gone = folder.with_file_name(format!("{id}{GONE}"));
    let failed = |source| JournalError::io(folder, Doing::Remove, source);
    if !folder.is_dir() {
        return Ok(None);
    }
    let _lock = RunLock::take(folder)?;
    match fs::rename(folder, &gone) {
        Ok(()) => {}
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(failed(error)),
    }
    fs::remove_dir_all(&gone).map_err(failed)?;
    Ok(Some(id))
}

/// Finishes deletions that were interrupted.
fn remove_leftovers(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let gone = |path: &PathBuf| path.to_string_lossy().ends_with(GONE);
    for path in entries.map(|entry| entry.path()).filter(gone) {
        // The next call retries.
        drop(fs::remove_dir_all(path));
    }
}

#[cfg(test)]
mod tests {
    use super::{Retention, Run, remove};
    use crate::journal::{About, Journal, JournalError, Options, run_folders};
    use std::time::Duration;

    const ALL: Retention = Retention { count: usize::MAX, age: None, bytes: u64::MAX, newest: 1 };

    /// Runs of 10 bytes that began at 1, 2, … s, at the time of 6 s; the second is active.
    fn check(retention: Retention, doomed: &[usize]) {
        let run = |second: u64| Run { started_ms: second * 1000, bytes: 10, is_live: second == 2 };
        let runs: Vec<Run> = (1..=5).map(run).collect();
        assert_eq!(retention.doomed(&runs, 6000), doomed, "{retention:?}");
    }

    #[test]
    fn the_oldest_go_and_what_goes_on_stays() {
        check(ALL, &[]);
        check(Retention { count: 3, ..ALL }, &[0, 2]);
        check(Retention { age: Some(Duration::from_millis(2500)), ..ALL }, &[0, 2]);
        check(Retention { bytes: 40, ..ALL }, &[0]);
        check(Retention { bytes: 0, ..ALL }, &[0, 2, 3]);
    }

    #[test]
    fn the_newest_stay_whatever_they_take() {
        check(Retention { bytes: 0, newest: 4, ..ALL }, &[0]);
        check(Retention { count: 0, bytes: 0, newest: 0, ..ALL }, &[0, 2, 3]);
    }

    #[test]
    fn a_run_is_deleted_unless_it_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        let journal = Journal::create(&run, &About::default(), &Options::default()).unwrap();
        assert!(matches!(remove(&run), Err(JournalError::Going { .. })));
        drop(journal);
        let removed = remove(&run).unwrap().unwrap();
        assert_eq!((removed.id.as_str(), removed.bytes > 0), ("run", true));
        assert_eq!(remove(&run).unwrap(), None);
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }

    #[test]
    fn a_folder_that_is_being_deleted_is_no_run() {
        let folder = tempfile::tempdir().unwrap();
        let (run, gone) = (folder.path().join("run"), folder.path().join("old.gone"));
        for path in [&run, &gone] {
            Journal::create(path, &About::default(), &Options::default()).unwrap();
        }
        assert_eq!(run_folders(folder.path()).unwrap(), [run]);
    }
}
