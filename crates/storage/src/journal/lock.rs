//! One writer for each run, and whether a run is alive: a lock on the file `lock`, which holds the number of the process that
//! has it.
//!
//! It is a lock of the open file, not of the process: a script may open, read and close `lock`, as it does when it copies the
//! folder of its run. Asking about it disturbs nobody. A forked child has a copy of the open file, so it lets go of it
//! ([`locks`]): a run is not alive because a child is.

use super::error::JournalError;
use super::folder::LOCK_FILE;
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

/// The number of a process is written to the file in so many bytes, at once.
const NUMBER_BYTES: usize = 11;
/// Between the lock and the number of its process lies a moment: so often and so long a reader waits for the number.
const LOOKS: usize = 50;
const PAUSE: Duration = Duration::from_millis(1);

/// The descriptors of all locks of this process.
static OPEN: Mutex<BTreeSet<RawFd>> = Mutex::new(BTreeSet::new());

/// The descriptors of all locks of this process. A forked copy closes them first of all: a run ends with its runner. Never waits.
pub fn locks() -> Vec<RawFd> {
    OPEN.try_lock().map(|open| open.iter().copied().collect()).unwrap_or_default()
}

/// Held until dropped.
#[derive(Debug)]
pub(super) struct RunLock {
    file: File,
}

impl RunLock {
    /// Takes the lock of the run in `folder`, or says who has it.
    pub(super) fn take(folder: &Path) -> Result<Self, JournalError> {
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

/// The process that writes the run in `folder`, if one does.
pub fn writer_of(folder: &Path) -> Result<Option<u32>, JournalError> {
    let failed = |source| JournalError::lock(folder, source);
    match File::open(folder.join(LOCK_FILE)) {
        Ok(file) => holder(&file).map_err(failed),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(failed(error)),
    }
}

/// The process that has the lock. One that died while a child of its own keeps the file open is still named.
fn holder(file: &File) -> io::Result<Option<u32>> {
    let mut number = None;
    for look in 0..LOOKS {
        let mut found = whole_file();
        fcntl(file, FcntlArg::F_OFD_GETLK(&mut found))?;
        if i32::from(found.l_type) == F_UNLCK {
            return Ok(None);
        }
        // A lock of an earlier version belongs to a process, which the system names.
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

/// What is locked, and asked about.
fn whole_file() -> flock {
    #[expect(clippy::cast_possible_truncation, reason = "both are small constants of the system")]
    let (l_type, l_whence) = (F_WRLCK as i16, SEEK_SET as i16);
    flock { l_type, l_whence, l_start: 0, l_len: 0, l_pid: 0 }
}
