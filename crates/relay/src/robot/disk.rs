//! The disk of a robot's relay has a thread: it writes the files for the next start, and once a second scans the runs and the offered key.
//! So a slow disk delays no datagram.

use super::follow::FromRun;
use super::scanner::RunScanner;
use crate::inbox::Input;
use crate::pairing::{Paired, Pairing};
use crate::report::REPORT_EVERY;
use crate::start::Start;
use parking_lot::{Condvar, Mutex};
use rafcon_link::{Horizon, KeyId};
use rafcon_supervisor::clock;
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::{Duration, Instant};

/// Longest wait for the disk at the end of a relay.
const END_WITHIN: Duration = Duration::from_secs(5);

/// The files of a relay, for its next start.
pub(super) struct RobotFiles {
    pub(super) start: Start,
    pub(super) paired: Paired,
    /// Lists the runs that were sent.
    pub(super) list: PathBuf,
    /// Numbers of the runs.
    pub(super) numbers: PathBuf,
    /// Values that the station watches.
    pub(super) watched: PathBuf,
    pub(super) tell: fn(&str),
}

/// The disk as the relay sees it.
#[derive(Debug)]
pub(super) struct RobotDisk {
    queue: Arc<FileQueue>,
}

#[derive(Debug, Default)]
struct FileQueue {
    todo: Mutex<FileWork>,
    changed: Condvar,
}

/// Newest content of each file that is to be written.
#[derive(Debug, Default)]
struct FileWork {
    heard: Option<(KeyId, Option<Horizon>)>,
    list: Option<String>,
    /// Entries for the end of the file.
    numbers: Vec<u8>,
    watched: Option<Vec<u8>>,
    key: Option<Pairing>,
    ends: bool,
    has_ended: bool,
}

impl FileWork {
    fn is_idle(&self) -> bool {
        let is_idle = self.heard.is_none() && self.list.is_none() && self.numbers.is_empty();
        is_idle && self.watched.is_none() && self.key.is_none() && !self.ends
    }
}

impl RobotDisk {
    /// Begins the thread, which sends its findings to the inbox.
    pub(super) fn begin(
        files: RobotFiles,
        scanner: RunScanner,
        inbox: SyncSender<Input<FromRun>>,
    ) -> io::Result<Self> {
        let queue = Arc::<FileQueue>::default();
        let theirs = Arc::clone(&queue);
        let keeper = FileKeeper { files, scanner, inbox };
        let work = move || {
            keeper.work(&theirs);
            theirs.todo.lock().has_ended = true;
            theirs.changed.notify_all();
        };
        thread::Builder::new().name("disk".to_owned()).spawn(work)?;
        Ok(Self { queue })
    }

    /// Stores the state of the link.
    pub(super) fn keep_heard(&self, key: KeyId, heard: Option<Horizon>) {
        self.set(|todo| todo.heard = Some((key, heard)));
    }

    /// Stores the list of the runs that were sent.
    pub(super) fn keep_list(&self, list: String) {
        self.set(|todo| todo.list = Some(list));
    }

    /// Stores the numbers of further runs.
    pub(super) fn add_numbers(&self, numbers: &[u8]) {
        self.set(|todo| todo.numbers.extend(numbers));
    }

    /// Stores the list of watched values.
    pub(super) fn keep_watched(&self, watched: Vec<u8>) {
        self.set(|todo| todo.watched = Some(watched));
    }

    /// Replaces the pairing, and reports the result.
    pub(super) fn replace_key(&self, next: Pairing) {
        self.set(|todo| todo.key = Some(next));
    }

    /// Writes what waits and ends; does not wait for long for a disk that is stuck.
    pub(super) fn end(&self) {
        self.set(|todo| todo.ends = true);
        let mut todo = self.queue.todo.lock();
        let is_busy = |todo: &mut FileWork| !todo.has_ended;
        let _stuck = self.queue.changed.wait_while_for(&mut todo, is_busy, END_WITHIN);
    }

    fn set(&self, change: impl FnOnce(&mut FileWork)) {
        change(&mut self.queue.todo.lock());
        self.queue.changed.notify_all();
    }
}

impl Drop for RobotDisk {
    fn drop(&mut self) {
        self.set(|todo| todo.ends = true);
    }
}

struct FileKeeper {
    files: RobotFiles,
    scanner: RunScanner,
    inbox: SyncSender<Input<FromRun>>,
}

impl FileKeeper {
    fn work(mut self, queue: &FileQueue) {
        let mut next_scan_at = clock::now();
        loop {
            let mut todo = queue.todo.lock();
            let wait = next_scan_at.saturating_duration_since(clock::now());
            let is_idle = |todo: &mut FileWork| todo.is_idle();
            let _scan = queue.changed.wait_while_for(&mut todo, is_idle, wait);
            let ends = todo.ends;
            let files = std::mem::take(&mut *todo);
            todo.ends = ends;
            drop(todo);
            self.write(files);
            if ends {
                return;
            }
            if clock::now() >= next_scan_at {
                self.scan();
                next_scan_at = Instant::max(next_scan_at, clock::now()) + REPORT_EVERY;
            }
        }
    }

    fn scan(&mut self) {
        let runs = self.scanner.scan();
        self.say(FromRun::Scanned(runs));
        if let Some(next) = self.files.paired.read_next() {
            self.say(FromRun::NextKey(Box::new(next)));
        }
    }

    fn write(&mut self, FileWork { heard, list, numbers, watched, key, .. }: FileWork) {
        let RobotFiles {
            start,
            paired,
            list: list_file,
            numbers: numbers_file,
            watched: watched_file,
            tell,
        } = &mut self.files;
        if let Some((key, heard)) = heard
            && let Err(error) = start.keep_heard(key, heard)
        {
            tell(&format!("the last packet numbers of the station cannot be stored: {error}"));
        }
        if let Some(list) = list
            && let Err(error) = fs::write(&*list_file, list)
        {
            let list_file = list_file.display();
            tell(&format!(
                "{list_file} cannot be written: after a restart, ended runs are not sent: {error}"
            ));
        }
        if !numbers.is_empty() {
            // A lost entry has an effect only on a run with an equal number.
            drop(append(numbers_file, &numbers));
        }
        if let Some(watched) = watched {
            // The station requests a lost list again.
            drop(fs::write(watched_file, watched));
        }
        if let Some(next) = key {
            let replaced = paired.replace(&next).map_err(|error| error.to_string());
            self.say(FromRun::KeyReplaced(replaced));
        }
    }

    fn say(&self, event: FromRun) {
        // A relay that has ended needs to know nothing.
        self.inbox.send(Input::Other(event)).unwrap_or_default();
    }
}

fn append(path: &Path, bytes: &[u8]) -> io::Result<()> {
    OpenOptions::new().append(true).create(true).open(path)?.write_all(bytes)
}
