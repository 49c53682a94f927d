//! Keeps each machine that a run uses, on a thread of its own, so that the run does not wait. This module knows what to
//! keep, but not how.

use crate::places::mailbox::Mailbox;
use crate::record::recorder::Recorder;
use crate::record::run_record::RunRecord;
use crate::record::tell;
use crate::record::tell::reason;
use crate::{Clock, StateFiles};
use rafcon_locks::Mutex;
use rafcon_model::Machine;
use rafcon_protocol::{Event, LogLevel};
use rafcon_storage::Packer;
use rafcon_storage::journal::{Hash, Journal, JournalError, Pack};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Retry interval after the disk was full.
const RETRY: Duration = Duration::from_secs(1);
/// A machine with at most this many states is kept before its first state runs, which takes a few milliseconds.
const AT_ONCE_MAX: usize = 500;

/// The machines to be kept.
#[derive(Debug, Default)]
pub(crate) struct Roots {
    /// Files of the first machine.
    files: OnceLock<StateFiles>,
    packer: Mutex<Packer>,
    wanted: Mailbox<RootsRequest>,
    done: Mailbox<()>,
    /// Number of machines to be kept, and number of those that are kept or cannot be.
    asked: AtomicU64,
    settled: AtomicU64,
}

#[derive(Debug)]
enum RootsRequest {
    /// Keep this machine, with a description of its change.
    Keep(Arc<Machine>, String),
    End,
}

impl Roots {
    /// Keeps the first machine of a run that begins or continues, with its files. A machine that `is_kept` is not kept
    /// again.
    pub(crate) fn keep_first(
        &self,
        record: &RunRecord,
        machine: &Arc<Machine>,
        files: StateFiles,
        is_kept: bool,
    ) {
        let files = self.files.get_or_init(|| files);
        if is_kept {
            return;
        }
        let at_once = machine.count() <= AT_ONCE_MAX;
        let journal = record.recorder().journal().filter(|_| at_once);
        let hash = journal.and_then(|journal| journal.keep_root(&self.pack(machine, files)).ok());
        match hash {
            Some(hash) => tell(record, hash, String::new()),
            None => self.keep(record, machine, ""),
        }
    }

    /// Keeps the next machine of the run. `change` describes its change, and is empty for the first.
    pub(crate) fn keep(&self, record: &RunRecord, machine: &Arc<Machine>, change: &str) {
        if record.recorder().has_journal() {
            self.asked.fetch_add(1, Ordering::SeqCst);
            self.wanted.post(RootsRequest::Keep(Arc::clone(machine), change.to_owned()));
        } else if !change.is_empty() {
            record.tell(Event::Root { hash: String::new(), change: change.to_owned() });
        }
    }

    /// Keeps machines until [`Roots::close`].
    pub(crate) fn serve(&self, record: &RunRecord) {
        // Also signals the end after a panic, because `close` waits for it.
        let _done = RootsClosed(&self.done);
        while let RootsRequest::Keep(machine, change) = self.wanted.wait() {
            let (journal, files) = (record.recorder().journal(), self.files.get());
            if let (Some(journal), Some(files)) = (journal, files)
                && let Some(hash) = keep(record, &journal, &self.pack(&machine, files))
            {
                tell(record, hash, change);
            }
            self.settled.fetch_add(1, Ordering::SeqCst);
        }
    }

    /// True if all machines that the run has used are kept, as far as possible.
    pub(crate) fn are_kept(&self) -> bool {
        self.settled.load(Ordering::SeqCst) >= self.asked.load(Ordering::SeqCst)
    }

    /// Waits until all machines are kept.
    pub(crate) fn close(&self, recorder: &Recorder) {
        if recorder.has_journal() {
            recorder.safety().end();
            self.dismiss();
            self.done.wait();
        }
    }

    /// Ends the thread after the queued machines.
    pub(crate) fn dismiss(&self) {
        self.wanted.post(RootsRequest::End);
    }

    fn pack(&self, machine: &Machine, files: &StateFiles) -> Pack {
        self.packer.lock().pack(machine, files.saved().as_deref(), files.libraries())
    }
}

fn tell(record: &RunRecord, hash: Hash, change: String) {
    record.tell(Event::Root { hash: hash.to_string(), change });
}

/// Signals on drop that no more machines are kept.
struct RootsClosed<'r>(&'r Mailbox<()>);

impl Drop for RootsClosed<'_> {
    fn drop(&mut self) {
        self.0.post(());
    }
}

/// Keeps one machine. Waits while the disk is full, as long as the run continues.
fn keep(record: &RunRecord, journal: &Journal, pack: &Pack) -> Option<Hash> {
    loop {
        match journal.keep_root(pack) {
            Ok(hash) => return Some(hash),
            Err(JournalError::DiskFull { .. }) if !record.recorder().safety().is_ending() => {
                record.recorder().wait_closed(Clock::moment(RETRY));
            }
            Err(error) => {
                let message = format!(
                    "the machine cannot be kept, so this run cannot be resumed after a crash: {}",
                    reason(&error)
                );
                record.note([tell::log(String::new(), LogLevel::Warning, message)]);
                return None;
            }
        }
    }
}
