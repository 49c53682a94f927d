//! How a branch's thread gets its next work from another thread.

use rafcon_locks::{Condvar, Mutex};
use std::collections::VecDeque;

/// What waits for one thread. A branch has one piece of work at a time, so it never holds more than a few.
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
    /// Leaves `mail` for the owner and wakes it.
    pub(crate) fn post(&self, mail: T) {
        self.mail.lock().push_back(mail);
        self.arrived.notify_one();
    }

    /// Waits for the next piece of mail.
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
