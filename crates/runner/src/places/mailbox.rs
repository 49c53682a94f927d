//! Passes work from one thread to the thread of a branch.

use rafcon_locks::{Condvar, Mutex};
use std::collections::VecDeque;

/// The queue of one thread. A branch has one piece of work at a time, so the queue stays short.
#[derive(Debug)]
pub(crate) struct Mailbox<T> {
    mail: Mutex<VecDeque<T>>,
    arrived: Condvar,
}

impl<T> Default for Mailbox<T> {
    fn default() -> Self {
        Self { mail: Mutex::new(VecDeque::new()), arrived: Condvar::new() }
    }
}

impl<T> Mailbox<T> {
    /// Adds `mail` for the owner and wakes it.
    pub(crate) fn post(&self, mail: T) {
        self.mail.lock().push_back(mail);
        self.arrived.notify_one();
    }

    /// Waits for the next entry.
    pub(crate) fn wait(&self) -> T {
        let mut mail = self.mail.lock();
        loop {
            if let Some(first) = mail.pop_front() {
                return first;
            }
            self.arrived.wait(&mut mail);
        }
    }
}
