//! The limit of open files (descriptors) of this process. A server raises it for itself. The runners that it starts keep the old
//! limit, because scripts may use `select`, which fails beyond 1,024.

use rustix::process::{Pid, Resource, Rlimit, getrlimit, prlimit, setrlimit};
use std::fs;
use std::io;
use std::process::Child;
use std::sync::OnceLock;

/// Folder in which Linux lists the open files of this process.
const OPEN_FOLDER: &str = "/proc/self/fd";

/// The limits before they were raised.
static BEFORE: OnceLock<(Option<u64>, Option<u64>)> = OnceLock::new();

/// Raises the soft limit of this process to its hard limit.
pub fn raise() -> io::Result<()> {
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    if current == maximum {
        return Ok(());
    }
    setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum })?;
    BEFORE.get_or_init(|| (current, maximum));
    Ok(())
}

/// Resets the soft limit of a child to the one with which this process was started.
pub(crate) fn restore(child: &Child) -> io::Result<()> {
    let Some(&(current, maximum)) = BEFORE.get() else { return Ok(()) };
    prlimit(Some(Pid::from_child(child)), Resource::Nofile, Rlimit { current, maximum })?;
    Ok(())
}

/// Number of files that this process can still open.
pub fn free() -> usize {
    let limit = getrlimit(Resource::Nofile).current;
    let limit = limit.map_or(usize::MAX, |limit| usize::try_from(limit).unwrap_or(usize::MAX));
    let open = fs::read_dir(OPEN_FOLDER).map_or(0, Iterator::count);
    limit.saturating_sub(open)
}
