//! Keeps each machine that a run goes by, on a thread of its own: the run does not wait for it. Knows what is to be kept; does
//! not know how.

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

/// How long after it found no room it is tried again.
const RETRY: Duration = Duration::from_secs(1);
/// A machine of no more states is kept before its first state runs, which takes a few milliseconds.
const AT_ONCE_MAX: usize = 500;

/// The machines that are to be kept.
#[derive(Debug, Default)]
pub(crate) struct Roots {
    /// Those of the first machine.
    files: OnceLock<StateFiles>,
    packer: Mutex<Packer>,
    wanted: Mailbox<RootsRequest>,
    done: Mailbox<()>,
    /// How many machines were to be kept, and how many of them are, or cannot be.
    asked: AtomicU64,
    settled: AtomicU64,
}

#[derive(Debug)]
enum RootsRequest {
    /// This machine, and what was changed.
    Keep(Arc<Machine>, String),
    End,
}

impl Roots {
    /// The run begins, or continues, with the machine that was read from these files; one that `is_kept` is not kept again.
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

    /// The run goes by `machine` from now on; `change` says what was changed, and nothing for the first.
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
        // Also if it ends by a panic: someone waits for that.
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

    /// Whether all machines that the run went by so far are kept, as far as they can be.
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

    /// No more machines are kept after those that wait.
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

/// Says that no more machines are kept.
struct RootsClosed<'r>(&'r Mailbox<()>);

impl Drop for RootsClosed<'_> {
    fn drop(&mut self) {
        self.0.post(());
    }
}

/// Keeps one machine; a disk that is full is waited for, as long as the run continues.
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
