//! Keeps each machine that a run goes by, on a thread of its own: the run does not wait for it. Knows what is to be kept; must
//! never know how.

use crate::driver::Driver;
use crate::mailbox::Mailbox;
use crate::prepare::reason;
use crate::{Clock, Scripts, StateFiles, tell};
use rafcon_model::Machine;
use rafcon_protocol::{Event, LogLevel};
use rafcon_storage::journal::{Hash, Journal, JournalError, Pack, Packer};
use std::sync::Arc;
use std::time::Duration;

/// How long after it found no room it is tried again.
const RETRY: Duration = Duration::from_secs(1);

/// The machines that are to be kept.
#[derive(Debug, Default)]
pub(crate) struct Roots {
    wanted: Mailbox<Wanted>,
    done: Mailbox<()>,
}

#[derive(Debug)]
enum Wanted {
    /// This machine, and what was changed.
    Keep(Arc<Machine>, String),
    End,
}

impl<S: Scripts> Driver<S> {
    /// The run goes by `machine` from now on; `change` says what was changed, and nothing for the first.
    pub(crate) fn keep_root(&self, machine: &Arc<Machine>, change: &str) {
        if self.recorder().has_journal() {
            self.roots().wanted.post(Wanted::Keep(Arc::clone(machine), change.to_owned()));
        } else if !change.is_empty() {
            self.tell(Event::Root { hash: String::new(), change: change.to_owned() });
        }
    }

    /// Waits until all machines are kept.
    pub(crate) fn close_roots(&self) {
        if self.recorder().has_journal() {
            self.recorder().safety().end();
            self.roots().wanted.post(Wanted::End);
            self.roots().done.wait();
        }
    }
}

/// Keeps machines until [`Driver::close_roots`]; `files` are those of the first.
pub(crate) fn serve<S: Scripts>(driver: &Driver<S>, files: &StateFiles) {
    let mut packer = Packer::default();
    while let Wanted::Keep(machine, change) = driver.roots().wanted.wait() {
        if let Some(journal) = driver.recorder().journal() {
            let pack = packer.pack(&machine, Some(files.saved()), files.libraries());
            if let Some(hash) = keep(driver, &journal, &pack) {
                driver.tell(Event::Root { hash: hash.to_string(), change });
            }
        }
    }
    driver.roots().done.post(());
}

/// Keeps one machine; a disk that is full is waited for, as long as the run goes on.
fn keep<S: Scripts>(driver: &Driver<S>, journal: &Journal, pack: &Pack) -> Option<Hash> {
    loop {
        match journal.keep_root(pack) {
            Ok(hash) => return Some(hash),
            Err(JournalError::DiskFull { .. }) if !driver.recorder().safety().is_ending() => {
                driver.recorder().wait_closed(Clock::moment(RETRY));
            }
            Err(error) => {
                let message = format!(
                    "the machine cannot be kept, so this run cannot be taken up after a crash: {}",
                    reason(&error)
                );
                let record = tell::log(String::new(), LogLevel::Warning, message);
                driver.recorder().push(driver.clock().now_ns(), [record]);
                return None;
            }
        }
    }
}
