//! Output that bypasses `sys.stdout` and `sys.stderr`: of child processes and native code. Reads it from the process's own
//! standard output and error, and logs it line by line.
//!
//! A pipe is read from its other end, which the starter of the runner reads only after the run. It is read with a delay, so that
//! the last words of a process that dies are left for the starter. A file is read as it grows.
//! Output belongs to a state if its script is the only one that runs.

use crate::early::Line;
use crate::{functions, thread};
use parking_lot::Mutex;
use pyo3::prelude::*;
use rafcon_engine::PathId;
use rafcon_protocol::{LogLevel, Stream};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FileType, Stat, fstat, inotify};
use std::fs::File;
use std::io::{self, Read as _};
use std::os::fd::{AsFd as _, AsRawFd as _, BorrowedFd, OwnedFd, RawFd};
use std::os::unix::fs::FileExt as _;
use std::sync::atomic::{AtomicBool, Ordering};

/// Size of a read, and of the longest entry.
const CHUNK: usize = 64 * 1024;
/// Reads in a row before the lock is released.
const ROUNDS: usize = 16;
/// Delay of reads from a pipe.
const DELAY: Timespec = Timespec { tv_sec: 0, tv_nsec: 250_000_000 };
const AT_ONCE: Timespec = Timespec { tv_sec: 0, tv_nsec: 0 };
/// Bytes in a pipe that are read without delay.
const SOON: u64 = 16 * 1024;
/// Bytes of a file that are left out once more than these wait.
const BEHIND_MAX: u64 = 4 << 20;

static IS_READ: AtomicBool = AtomicBool::new(false);
static SOURCES: Mutex<Vec<Source>> = Mutex::new(Vec::new());
/// States whose scripts run.
static SCRIPTS: Mutex<Vec<PathId>> = Mutex::new(Vec::new());
/// Descriptors that a forked child closes.
static DESCRIPTORS: Mutex<Vec<RawFd>> = Mutex::new(Vec::new());

/// Reads the output of this process from now on, if it goes to pipes or files.
pub(crate) fn install() -> io::Result<()> {
    let mut sources: Vec<Source> = Vec::new();
    for (number, stream) in [(1, Stream::Stdout), (2, Stream::Stderr)] {
        if let Some(source) = Source::open(number, stream)?
            && !sources.iter().any(|other| other.inode == source.inode)
        {
            sources.push(source);
        }
    }
    if sources.is_empty() {
        return Ok(());
    }
    let wakers = sources.iter().map(Source::waker).collect::<io::Result<Vec<_>>>()?;
    let open = sources.iter().map(|source| source.file.as_raw_fd());
    *DESCRIPTORS.lock() = open.chain(wakers.iter().map(OwnedFd::as_raw_fd)).collect();
    *SOURCES.lock() = sources;
    IS_READ.store(true, Ordering::Relaxed);
    let reader = std::thread::Builder::new().name("output".to_owned());
    reader.spawn(move || follow(&wakers)).map(drop)
}

/// Logs the output until now. The program that started the runner reads later output.
pub(crate) fn close() {
    if IS_READ.swap(false, Ordering::Relaxed) {
        let mut sources = SOURCES.lock();
        for source in sources.iter_mut() {
            source.drain(None);
            source.flush(None);
        }
    }
}

/// Descriptors that a forked child must close. Another thread may have been about to change them.
pub(crate) fn forget() -> Vec<RawFd> {
    IS_READ.store(false, Ordering::Relaxed);
    DESCRIPTORS.try_lock().map(|open| open.clone()).unwrap_or_default()
}

/// Records the start of the script of the state at `path`.
pub(crate) fn script_begins(path: PathId) {
    if IS_READ.load(Ordering::Relaxed) {
        SCRIPTS.lock().push(path);
    }
}

/// Records the end of the script of the state at `path`, after its output was logged.
pub(crate) fn script_ended(py: Python<'_>, path: PathId) {
    if !IS_READ.load(Ordering::Relaxed) {
        return;
    }
    let sole = sole_script();
    let drain = |sources: &mut Vec<Source>| {
        if !has_news(sources) {
            return;
        }
        for source in sources {
            source.drain(sole);
            if sole.is_some() {
                source.flush(sole);
            }
        }
    };
    match SOURCES.try_lock() {
        Some(mut sources) => drain(&mut sources),
        // The reader may wait for capacity of the journal, so wait for it outside the interpreter.
        None => thread::leave(py, || drain(&mut SOURCES.lock())),
    }
    let mut scripts = SCRIPTS.lock();
    if let Some(at) = scripts.iter().position(|&running| running == path) {
        scripts.swap_remove(at);
    }
}

/// True if output may be pending. It takes one system call, because it follows every script.
fn has_news(sources: &[Source]) -> bool {
    let ready = match sources {
        [one] => poll(&mut [one.polled()], Some(&AT_ONCE)),
        [one, other] => poll(&mut [one.polled(), other.polled()], Some(&AT_ONCE)),
        _ => return true,
    };
    ready != Ok(0) || sources.iter().any(|source| source.is_behind || !source.rest.is_empty())
}

/// The state whose script is the only one that runs.
fn sole_script() -> Option<PathId> {
    match SCRIPTS.lock()[..] {
        [path] => Some(path),
        _ => None,
    }
}

/// Logs output as it arrives.
fn follow(wakers: &[OwnedFd]) {
    loop {
        let mut polled: Vec<_> =
            wakers.iter().map(|waker| PollFd::new(waker, PollFlags::IN)).collect();
        match poll(&mut polled, None) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(_) => return,
        }
        let is_over = |polled: &PollFd<'_>| {
            let seen = polled.revents();
            !seen.contains(PollFlags::IN) && seen.intersects(PollFlags::HUP | PollFlags::ERR)
        };
        if polled.iter().any(is_over) {
            return;
        }
        if has_little() {
            // A poll without descriptors only waits.
            poll(&mut [], Some(&DELAY)).unwrap_or_default();
        }
        if !log_news() {
            return;
        }
    }
}

/// True if all output is in pipes with little unread data.
fn has_little() -> bool {
    let mut sources = SOURCES.lock();
    sources.iter_mut().all(|source| source.position.is_none() && source.waiting() < SOON)
}

/// False once the output is no longer read.
fn log_news() -> bool {
    let mut has_more = true;
    while has_more {
        if !IS_READ.load(Ordering::Relaxed) {
            return false;
        }
        let mut sources = SOURCES.lock();
        let sole = sole_script();
        has_more = false;
        for source in sources.iter_mut() {
            has_more |= source.drain(sole);
        }
    }
    true
}

/// The standard output or error.
#[derive(Debug)]
struct Source {
    stream: Stream,
    file: File,
    /// Device and number of the file.
    inode: (u64, u64),
    /// Bytes of a file that were read; `None` of a pipe.
    position: Option<u64>,
    /// Notices of a growing file.
    growth: Option<OwnedFd>,
    /// Bytes of a line that has no end yet.
    rest: Vec<u8>,
    /// True if the last read left output.
    is_behind: bool,
}

impl Source {
    fn open(number: i32, stream: Stream) -> io::Result<Option<Self>> {
        let path = format!("/proc/self/fd/{number}");
        let Ok(Stat { st_mode, .. }) = rustix::fs::stat(&path) else { return Ok(None) };
        let kind = FileType::from_raw_mode(st_mode);
        if kind != FileType::Fifo && kind != FileType::RegularFile {
            return Ok(None);
        }
        let file = File::open(&path)?;
        let about = fstat(&file)?;
        let is_file = kind == FileType::RegularFile;
        let growth = if is_file { Some(growth_of(&path)?) } else { None };
        let position = is_file.then(|| u64::try_from(about.st_size).unwrap_or_default());
        let inode = (about.st_dev, about.st_ino);
        Ok(Some(Self { stream, file, inode, position, growth, rest: Vec::new(), is_behind: false }))
    }

    /// A descriptor that can be read from once there is output.
    fn waker(&self) -> io::Result<OwnedFd> {
        self.news().try_clone_to_owned()
    }

    fn polled(&self) -> PollFd<'_> {
        PollFd::from_borrowed_fd(self.news(), PollFlags::IN)
    }

    /// The descriptor that can be read from once there is output.
    fn news(&self) -> BorrowedFd<'_> {
        self.growth.as_ref().map_or_else(|| self.file.as_fd(), OwnedFd::as_fd)
    }

    /// Logs complete lines; true if there is more to read.
    fn drain(&mut self, path: Option<PathId>) -> bool {
        self.is_behind = self.read_lines(path);
        self.is_behind
    }

    fn read_lines(&mut self, path: Option<PathId>) -> bool {
        self.forget_notices();
        for _ in 0..ROUNDS {
            let waiting = self.waiting();
            if waiting == 0 {
                return false;
            }
            let mut chunk = vec![0; CHUNK.min(usize::try_from(waiting).unwrap_or(CHUNK))];
            let read = match self.position {
                Some(position) => self.file.read_at(&mut chunk, position),
                None => self.file.read(&mut chunk),
            };
            let Ok(read @ 1..) = read else { return false };
            if let Some(position) = &mut self.position {
                *position += read as u64;
            }
            self.rest.extend_from_slice(chunk.get(..read).unwrap_or_default());
            self.log_lines(path);
        }
        true
    }

    fn forget_notices(&self) {
        if let Some(growth) = &self.growth {
            let mut notices = [0; 1024];
            while rustix::io::read(growth, &mut notices).is_ok_and(|read| read > 0) {}
        }
    }

    /// Number of bytes to read now. Skips a part of a file that is far ahead, and starts again in one that was cut.
    fn waiting(&mut self) -> u64 {
        let Some(position) = &mut self.position else {
            return rustix::io::ioctl_fionread(&self.file).unwrap_or_default();
        };
        let size = fstat(&self.file).map(|about| about.st_size).unwrap_or_default();
        let size = u64::try_from(size).unwrap_or_default();
        if size < *position {
            *position = 0;
        }
        let waiting = size - *position;
        if waiting <= BEHIND_MAX {
            return waiting;
        }
        let rest = CHUNK as u64;
        *position = size - rest;
        let left_out = waiting - rest;
        let message = format!(
            "{left_out} bytes that child processes or native code wrote are left out; the file `output` of the run has them"
        );
        log(None, Stream::Engine, message);
        rest
    }

    fn log_lines(&mut self, path: Option<PathId>) {
        let mut start = 0;
        loop {
            let rest = self.rest.get(start..).unwrap_or_default();
            let (end, next) = match rest.iter().position(|&byte| byte == b'\n') {
                Some(end) => (end, end + 1),
                None if rest.len() >= CHUNK => (CHUNK, CHUNK),
                None => break,
            };
            log(path, self.stream, text(rest.get(..end).unwrap_or_default()));
            start += next;
        }
        self.rest.drain(..start);
    }

    /// Logs an unfinished line.
    fn flush(&mut self, path: Option<PathId>) {
        if !self.rest.is_empty() {
            log(path, self.stream, text(&self.rest));
            self.rest.clear();
        }
    }
}

fn growth_of(path: &str) -> io::Result<OwnedFd> {
    let growth = inotify::init(inotify::CreateFlags::CLOEXEC | inotify::CreateFlags::NONBLOCK)?;
    inotify::add_watch(&growth, path, inotify::WatchFlags::MODIFY)?;
    Ok(growth)
}

/// A line in UTF-8; for a progress bar, its last state.
fn text(line: &[u8]) -> String {
    let line = String::from_utf8_lossy(line);
    let drawing = line.rsplit('\r').find(|drawing| !drawing.trim().is_empty());
    drawing.unwrap_or_default().to_owned()
}

/// Logs a line; after the run no log exists.
fn log(path: Option<PathId>, stream: Stream, message: String) {
    let line = Line { level: LogLevel::Info, stream, message };
    functions::note(path, line).unwrap_or_default();
}
