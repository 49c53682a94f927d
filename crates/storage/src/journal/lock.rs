//! One writer for each run, and whether a run is alive: a record lock on the file `lock`. Such a lock belongs to the process:
//! children that a script forked do not keep it alive, and asking about it disturbs nobody.
//!
//! Closing any handle of a file drops the process's lock on it, so this module is the only one that opens it, and never twice.

use super::error::JournalError;
use super::folder::LOCK_FILE;
use parking_lot::Mutex;
use rustix::fs::{FlockOperation, fcntl_lock};
use rustix::io::Errno;
use rustix::process::{Flock, FlockType, fcntl_getlk};
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::path::Path;

/// Device and number of the lock files that this process has open.
static OURS: Mutex<BTreeSet<(u64, u64)>> = Mutex::new(BTreeSet::new());

/// Held until dropped.
#[derive(Debug)]
pub(super) struct RunLock {
    file: Option<File>,
    id: (u64, u64),
}

impl RunLock {
    /// Takes the lock of the run in `folder`, or says who has it.
    pub(super) fn take(folder: &Path) -> Result<Self, JournalError> {
        let mut ours = OURS.lock();
        if known(folder).is_some_and(|id| ours.contains(&id)) {
            return Err(going(folder, std::process::id()));
        }
        let failed = |source| JournalError::lock(folder, source);
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false).mode(0o600);
        let file = options.open(folder.join(LOCK_FILE)).map_err(failed)?;
        match fcntl_lock(&file, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => {}
            Err(Errno::AGAIN | Errno::ACCESS) => {
                return Err(going(folder, holder(&file).unwrap_or(0)));
            }
            Err(error) => return Err(failed(error.into())),
        }
        let id = id(&file.metadata().map_err(failed)?);
        ours.insert(id);
        Ok(Self { file: Some(file), id })
    }
}

impl Drop for RunLock {
    fn drop(&mut self) {
        let mut ours = OURS.lock();
        self.file = None;
        ours.remove(&self.id);
    }
}

/// The process that writes the run in `folder`, if one does.
pub fn writer_of(folder: &Path) -> Result<Option<u32>, JournalError> {
    let ours = OURS.lock();
    if known(folder).is_some_and(|id| ours.contains(&id)) {
        return Ok(Some(std::process::id()));
    }
    match File::open(folder.join(LOCK_FILE)) {
        Ok(file) => Ok(holder(&file)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(JournalError::lock(folder, error)),
    }
}

fn holder(file: &File) -> Option<u32> {
    let lock = fcntl_getlk(file, &Flock::from(FlockType::WriteLock)).ok()??;
    lock.pid.map(|pid| pid.as_raw_nonzero().get().unsigned_abs())
}

fn known(folder: &Path) -> Option<(u64, u64)> {
    fs::metadata(folder.join(LOCK_FILE)).ok().as_ref().map(id)
}

fn id(metadata: &fs::Metadata) -> (u64, u64) {
    (metadata.dev(), metadata.ino())
}

fn going(folder: &Path, process: u32) -> JournalError {
    JournalError::Going { folder: folder.to_owned(), process }
}
