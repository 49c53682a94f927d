//! One save at a time, and no load in the middle of one: an advisory lock on the machine's folder itself, so that no lock
//! file lies around. Where the file system has no such locks, nothing is locked.

use super::commit::{is_interrupted, recover};
use super::disk::RealDisk;
use crate::read::LoadError;
use rustix::fd::OwnedFd;
use rustix::fs::{CWD, FlockOperation, Mode, OFlags, flock, openat};
use std::io;
use std::path::Path;

/// Held until dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    /// Closing it ends the lock.
    _folder: OwnedFd,
}

/// Waits until nobody reads or writes the machine in `dir`.
pub(crate) fn exclusive(dir: &Path) -> io::Result<Lock> {
    let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
    let folder = openat(CWD, dir, flags, Mode::empty())?;
    take(&folder, FlockOperation::LockExclusive)?;
    Ok(Lock { _folder: folder })
}

/// Makes the open machine folder ready to be read: waits for a save that runs, finishes or drops an interrupted one. Saves
/// wait until `folder` (and every duplicate) is closed. Nothing is finished or dropped that `check` refuses.
pub(crate) fn settle_before_reading(
    folder: &OwnedFd,
    dir: &Path,
    check: impl FnOnce() -> Result<(), LoadError>,
) -> Result<(), LoadError> {
    let failed = |source| LoadError::Recovery { path: dir.to_owned(), source };
    take(folder, FlockOperation::LockShared).map_err(failed)?;
    if !is_interrupted(&RealDisk, dir) {
        return Ok(());
    }
    take(folder, FlockOperation::LockExclusive).map_err(failed)?;
    if is_interrupted(&RealDisk, dir) {
        check()?;
        recover(&RealDisk, dir).map_err(failed)?;
    }
    take(folder, FlockOperation::LockShared).map_err(failed)
}

fn take(folder: &OwnedFd, operation: FlockOperation) -> io::Result<()> {
    use rustix::io::Errno;
    loop {
        match flock(folder, operation) {
            Err(Errno::INTR) => {}
            Ok(()) | Err(Errno::NOLCK | Errno::BADF | Errno::OPNOTSUPP | Errno::NOSYS) => {
                return Ok(());
            }
            Err(error) => return Err(error.into()),
        }
    }
}
