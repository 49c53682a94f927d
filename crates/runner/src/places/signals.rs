//! Requests for a running script, and waiting for them. This module knows flags, but no states.

use crate::Clock;
use rafcon_locks::{Condvar, Mutex};
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

/// The state is asked to end.
pub const PREEMPTED: u8 = 1;
/// The run is held.
pub const PAUSED: u8 = 2;
/// The run continues after a pause.
pub const STARTED: u8 = 4;
/// Another thread has something for a waiting script. Both know its meaning.
pub const NUDGED: u8 = 8;

/// The flags of a place. Waiting needs no processor time.
#[derive(Debug, Default)]
pub struct Signals {
    flags: AtomicU8,
    lock: Mutex<()>,
    changed: Condvar,
}

impl Signals {
    /// True if any flag of `mask` is set.
    pub fn any(&self, mask: u8) -> bool {
        self.flags.load(Ordering::Acquire) & mask != 0
    }

    /// Sets (`on`) or clears every flag of `mask`, and wakes all waiting threads.
    pub fn set(&self, mask: u8, on: bool) {
        if on {
            self.update(|flags| flags | mask);
        } else {
            self.update(|flags| flags & !mask);
        }
    }

    /// Sets the flags of a script that begins: asked to end or not. Pause and start keep the values of the run.
    pub(crate) fn begin(&self, preempted: bool) {
        if self.any(PREEMPTED) != preempted {
            self.set(PREEMPTED, preempted);
        }
    }

    /// Waits until any flag of `mask` is set; false if `timeout` passed before that.
    pub fn wait(&self, mask: u8, timeout: Option<Duration>) -> bool {
        if self.any(mask) {
            return true;
        }
        let deadline = timeout.and_then(Clock::moment);
        let mut guard = self.lock.lock();
        while !self.any(mask) {
            match deadline {
                Some(deadline) => {
                    if self.changed.wait_until(&mut guard, deadline).timed_out() {
                        return self.any(mask);
                    }
                }
                None => self.changed.wait(&mut guard),
            }
        }
        true
    }

    fn update(&self, change: impl Fn(u8) -> u8) {
        let _guard = self.lock.lock();
        self.flags.store(change(self.flags.load(Ordering::Relaxed)), Ordering::Release);
        self.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::{PAUSED, PREEMPTED, Signals};
    use std::sync::Arc;
    use std::time::Duration;

    #[test]
    fn a_wait_ends_by_its_flag_or_its_time() {
        let signals = Arc::new(Signals::default());
        assert!(!signals.wait(PREEMPTED, Some(Duration::ZERO)));
        signals.set(PAUSED, true);
        assert!(!signals.wait(PREEMPTED, Some(Duration::from_millis(1))));
        let waiter = {
            let signals = Arc::clone(&signals);
            std::thread::Builder::new().spawn(move || signals.wait(PREEMPTED, None)).unwrap()
        };
        signals.set(PREEMPTED, true);
        assert!(waiter.join().unwrap());
        assert!(signals.wait(PREEMPTED | PAUSED, Some(Duration::MAX)));
    }

    #[test]
    fn a_new_script_starts_without_the_earlier_preemption() {
        let signals = Signals::default();
        signals.set(PREEMPTED | PAUSED, true);
        signals.begin(false);
        assert!(!signals.any(PREEMPTED));
        assert!(signals.any(PAUSED));
    }
}
