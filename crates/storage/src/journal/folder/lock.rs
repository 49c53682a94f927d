//! A lock on the file `lock`: it admits one writer per run and shows that a run is active. The file contains the id of the process
//! that holds the lock.
//!
//! It is a lock of the open file, not of the process: a script may open, read and close `lock`, as it does when it copies the
//! folder of its run. Checking the lock does not disturb its holder. A forked child closes its copy of the open file
//! ([`locks`]): a child does not keep a run active.

use super::LOCK_FILE;
use super::error::JournalError;
use nix::errno::Errno;
use nix::fcntl::{FcntlArg, fcntl};
use nix::libc::{F_UNLCK, F_WRLCK, SEEK_SET, flock};
use parking_lot::Mutex;
use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::{AsRawFd as _, RawFd};
use std::os::unix::fs::{FileExt as _, OpenOptionsExt as _};
use std::path::Path;
use std::thread;
use std::time::Duration;

/// Length of the process id in the file. It is written at once.
const NUMBER_BYTES: usize = 11;
/// Number and interval of a reader's attempts: the process id is written after the file is locked.
const LOOKS: usize = 50;
const PAUSE: Duration = Duration::from_millis(1);

/// File descriptors of all locks of this process.
static OPEN: Mutex<BTreeSet<RawFd>> = Mutex::new(BTreeSet::new());

/// Returns the file descriptors of all locks of this process. A forked child closes them first, so that a run ends with its runner.
/// Never waits.
pub fn locks() -> Vec<RawFd> {
    OPEN.try_lock().map(|open| open.iter().copied().collect()).unwrap_or_default()
}

/// A lock that is held until it is dropped.
#[derive(Debug)]
pub(in crate::journal) struct RunLock {
    file: File,
}

impl RunLock {
    /// Locks the run in `folder`. The error names the process that holds the lock.
    pub(in crate::journal) fn take(folder: &Path) -> Result<Self, JournalError> {
        let failed = |source| JournalError::lock(folder, source);
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false).mode(0o600);
        let file = options.open(folder.join(LOCK_FILE)).map_err(failed)?;
        match fcntl(&file, FcntlArg::F_OFD_SETLK(&whole_file())) {
            Ok(_) => {}
            Err(Errno::EAGAIN | Errno::EACCES) => {
                let process = holder(&file).map_err(failed)?.unwrap_or(0);
                return Err(JournalError::Going { folder: folder.to_owned(), process });
            }
            Err(error) => return Err(failed(error.into())),
        }
        let number = format!("{:<width$}\n", std::process::id(), width = NUMBER_BYTES - 1);
        file.write_all_at(number.as_bytes(), 0).map_err(failed)?;
        OPEN.lock().insert(file.as_raw_fd());
        Ok(Self { file })
    }
}

impl Drop for RunLock {
    fn drop(&mut self) {
        OPEN.lock().remove(&self.file.as_raw_fd());
    }
}

/// Returns the process that writes the run in `folder`, if there is one.
pub fn writer_of(folder: &Path) -> Result<Option<u32>, JournalError> {
    let failed = |source| JournalError::lock(folder, source);
    match File::open(folder.join(LOCK_FILE)) {
        Ok(file) => holder(&file).map_err(failed),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(failed(error)),
    }
}

/// Returns the process that holds the lock. It may be dead if one of its children keeps the file open.
fn holder(file: &File) -> io::Result<Option<u32>> {
    let mut number = None;
    for look in 0..LOOKS {
        let mut found = whole_file();
        fcntl(file, FcntlArg::F_OFD_GETLK(&mut found))?;
        if i32::from(found.l_type) == F_UNLCK {
            return Ok(None);
        }
        // A lock of an earlier version belongs to a process, which the system reports.
        if let Ok(process @ 1..) = u32::try_from(found.l_pid) {
            return Ok(Some(process));
        }
        number = written_number(file).or(number);
        if number.is_some_and(is_alive) {
            break;
        }
        if look + 1 < LOOKS {
            thread::park_timeout(PAUSE);
        }
    }
    Ok(Some(number.unwrap_or(0)))
}

fn written_number(file: &File) -> Option<u32> {
    let mut bytes = [0; NUMBER_BYTES];
    file.read_exact_at(&mut bytes, 0).ok()?;
    std::str::from_utf8(&bytes).ok()?.trim_end().parse().ok()
}

fn is_alive(process: u32) -> bool {
    let Some(pid) = i32::try_from(process).ok().and_then(rustix::process::Pid::from_raw) else {
        return false;
    };
    !matches!(rustix::process::test_kill_process(pid), Err(rustix::io::Errno::SRCH))
}

/// Returns the range of bytes that is locked and checked.
fn whole_file() -> flock {
    #[expect(clippy::cast_possible_truncation, reason = "both are small constants of the system")]
    let (l_type, l_whence) = (F_WRLCK as i16, SEEK_SET as i16);
    flock { l_type, l_whence, l_start: 0, l_len: 0, l_pid: 0 }
}
