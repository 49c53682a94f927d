//! Atomic saves: new data is prepared in a staging folder, listed in a manifest, and then moved into place. Handles files and
//! folders, not machines.
//!
//! Saves and loads of a machine exclude each other, and so do two saves. They lock the machine's folder itself, so that no lock
//! file remains. A file system without such locks gives no protection.

mod commit;
mod disk;
mod manifest;

pub(crate) use commit::{NewFile, Plan, commit, is_interrupted, recover};
pub(crate) use disk::{Disk, RealDisk};

use crate::problem::LoadError;
use rustix::fd::OwnedFd;
use rustix::fs::{CWD, FlockOperation, Mode, OFlags, flock, openat};
use std::io;
use std::path::Path;

/// A lock that is held until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    /// Closing it ends the lock.
    _folder: OwnedFd,
}

/// Locks the machine in `dir` exclusively, after waiting for others that read or write it.
pub(crate) fn exclusive(dir: &Path) -> io::Result<Lock> {
    let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
    let folder = openat(CWD, dir, flags, Mode::empty())?;
    take(&folder, FlockOperation::LockExclusive)?;
    Ok(Lock { _folder: folder })
}

/// Prepares the open machine folder for reading: waits for a running save, finishes or discards an interrupted one. Saves
/// wait until `folder` (and every duplicate) is closed. Finishes or discards nothing that `check` refuses.
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
