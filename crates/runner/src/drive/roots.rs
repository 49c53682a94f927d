//! Keeps each machine that a run goes by, on a thread of its own: the run does not wait for it. Knows what is to be kept; must
//! never know how.

use crate::drive::driver::Driver;
use crate::places::mailbox::Mailbox;
use crate::record::tell;
use crate::record::tell::reason;
use crate::{Clock, Scripts, StateFiles};
use rafcon_locks::Mutex;
use rafcon_model::Machine;
use rafcon_protocol::{Event, LogLevel};
use rafcon_storage::Packer;
use rafcon_storage::journal::{Hash, Journal, JournalError, Pack};
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
}

#[derive(Debug)]
enum RootsRequest {
    /// This machine, and what was changed.
    Keep(Arc<Machine>, String),
    End,
}

impl<S: Scripts> Driver<S> {
    /// The run begins, or continues, with the machine that was read from these files; one that `is_kept` is not kept again.
    pub(crate) fn keep_first_root(&self, files: StateFiles, is_kept: bool) {
        let files = self.roots().files.get_or_init(|| files);
        if is_kept {
            return;
        }
        let machine = self.machine();
        let at_once = machine.count() <= AT_ONCE_MAX;
        let journal = self.recorder().journal().filter(|_| at_once);
        let hash = journal.and_then(|journal| journal.keep_root(&self.pack(&machine, files)).ok());
        match hash {
            Some(hash) => self.tell_root(hash, String::new()),
            None => self.keep_root(&machine, ""),
        }
    }

    /// The run goes by `machine` from now on; `change` says what was changed, and nothing for the first.
    pub(crate) fn keep_root(&self, machine: &Arc<Machine>, change: &str) {
        if self.recorder().has_journal() {
            self.roots().wanted.post(RootsRequest::Keep(Arc::clone(machine), change.to_owned()));
        } else if !change.is_empty() {
            self.tell(Event::Root { hash: String::new(), change: change.to_owned() });
        }
    }

    /// Waits until all machines are kept.
    pub(crate) fn close_roots(&self) {
        if self.recorder().has_journal() {
            self.recorder().safety().end();
            self.dismiss_roots();
            self.roots().done.wait();
        }
    }

    /// No more machines are kept after those that wait.
    pub(crate) fn dismiss_roots(&self) {
        self.roots().wanted.post(RootsRequest::End);
    }

    fn pack(&self, machine: &Machine, files: &StateFiles) -> Pack {
        self.roots().packer.lock().pack(machine, files.saved().as_deref(), files.libraries())
    }

    fn tell_root(&self, hash: Hash, change: String) {
        self.tell(Event::Root { hash: hash.to_string(), change });
    }
}

/// Keeps machines until [`Driver::close_roots`].
pub(crate) fn serve<S: Scripts>(driver: &Driver<S>) {
    let roots = driver.roots();
    // Also if it ends by a panic: someone waits for that.
    let _done = RootsClosed(&roots.done);
    while let RootsRequest::Keep(machine, change) = roots.wanted.wait() {
        let (journal, files) = (driver.recorder().journal(), roots.files.get());
        if let (Some(journal), Some(files)) = (journal, files)
            && let Some(hash) = keep(driver, &journal, &driver.pack(&machine, files))
        {
            driver.tell_root(hash, change);
        }
    }
}

/// Says that no more machines are kept.
struct RootsClosed<'r>(&'r Mailbox<()>);

impl Drop for RootsClosed<'_> {
    fn drop(&mut self) {
        self.0.post(());
    }
}

/// Keeps one machine; a disk that is full is waited for, as long as the run continues.
fn keep<S: Scripts>(driver: &Driver<S>, journal: &Journal, pack: &Pack) -> Option<Hash> {
    loop {
        match journal.keep_root(pack) {
            Ok(hash) => return Some(hash),
            Err(JournalError::DiskFull { .. }) if !driver.recorder().safety().is_ending() => {
                driver.recorder().wait_closed(Clock::moment(RETRY));
            }
            Err(error) => {
                let message = format!(
                    "the machine cannot be kept, so this run cannot be resumed after a crash: {}",
                    reason(&error)
                );
                let record = tell::log(String::new(), LogLevel::Warning, message);
                driver.recorder().push(driver.clock().now_ns(), [record]);
                return None;
            }
        }
    }
}
