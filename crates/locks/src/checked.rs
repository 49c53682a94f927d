//! Locks that are checked while they are used. Knows how they are taken; what may be taken inside what, [`crate::order`] knows.

use crate::order::{self, At, Kind};
use parking_lot::WaitTimeoutResult;
use std::any::type_name;
use std::ops::{Deref, DerefMut};
use std::panic::Location;
use std::time::{Duration, Instant};

/// A [`parking_lot::Mutex`] whose locking order is checked.
#[derive(Debug)]
pub struct Mutex<T> {
    made: At,
    lock: parking_lot::Mutex<T>,
}

/// Guard of a [`Mutex`]. Dropping it releases the mutex.
#[derive(Debug)]
pub struct MutexGuard<'l, T> {
    guard: parking_lot::MutexGuard<'l, T>,
    _held: Held,
}

/// A [`parking_lot::RwLock`] whose locking order is checked.
#[derive(Debug)]
pub struct RwLock<T> {
    made: At,
    lock: parking_lot::RwLock<T>,
}

/// Shared access to the content of an [`RwLock`], until it is dropped.
#[derive(Debug)]
pub struct RwLockReadGuard<'l, T> {
    guard: parking_lot::RwLockReadGuard<'l, T>,
    _held: Held,
}

/// Exclusive access to the content of an [`RwLock`], until it is dropped.
#[derive(Debug)]
pub struct RwLockWriteGuard<'l, T> {
    guard: parking_lot::RwLockWriteGuard<'l, T>,
    _held: Held,
}

/// That this thread holds a lock.
#[derive(Debug)]
struct Held(usize);

impl Drop for Held {
    fn drop(&mut self) {
        order::left(self.0);
    }
}

fn address<T>(lock: &T) -> usize {
    std::ptr::from_ref(lock).addr()
}

impl<T> Mutex<T> {
    /// Creates a mutex. The position of the call in the source is part of its kind.
    #[track_caller]
    pub const fn new(content: T) -> Self {
        Self { made: Location::caller(), lock: parking_lot::Mutex::new(content) }
    }

    fn kind(&self) -> Kind {
        Kind { made: self.made, content: type_name::<T>() }
    }

    fn held<'l>(&self, guard: parking_lot::MutexGuard<'l, T>, at: At) -> MutexGuard<'l, T> {
        order::taken(self.kind(), address(self), at);
        MutexGuard { guard, _held: Held(address(self)) }
    }

    /// Waits for the mutex. Panics if waiting could deadlock.
    #[track_caller]
    pub fn lock(&self) -> MutexGuard<'_, T> {
        let at = Location::caller();
        order::before(self.kind(), address(self), at);
        self.held(self.lock.lock(), at)
    }

    /// Takes the mutex if it is free. Never waits, so the order is not checked.
    #[track_caller]
    pub fn try_lock(&self) -> Option<MutexGuard<'_, T>> {
        let at = Location::caller();
        Some(self.held(self.lock.try_lock()?, at))
    }

    /// Waits for at most `time`; `None` after a timeout. The order is not checked.
    #[track_caller]
    pub fn try_lock_for(&self, time: Duration) -> Option<MutexGuard<'_, T>> {
        let at = Location::caller();
        Some(self.held(self.lock.try_lock_for(time)?, at))
    }

    /// Waits until `moment` at the latest; `None` after a timeout. The order is not checked.
    #[track_caller]
    pub fn try_lock_until(&self, moment: Instant) -> Option<MutexGuard<'_, T>> {
        let at = Location::caller();
        Some(self.held(self.lock.try_lock_until(moment)?, at))
    }
}

impl<T: Default> Default for Mutex<T> {
    #[track_caller]
    fn default() -> Self {
        Self::new(T::default())
    }
}

impl<T> Deref for MutexGuard<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.guard
    }
}

impl<T> DerefMut for MutexGuard<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.guard
    }
}

impl<T> RwLock<T> {
    /// Creates a lock. The position of the call in the source is part of its kind.
    #[track_caller]
    pub const fn new(content: T) -> Self {
        Self { made: Location::caller(), lock: parking_lot::RwLock::new(content) }
    }

    fn kind(&self) -> Kind {
        Kind { made: self.made, content: type_name::<T>() }
    }

    fn before(&self, at: At) {
        order::before(self.kind(), address(self), at);
    }

    fn held(&self, at: At) -> Held {
        order::taken(self.kind(), address(self), at);
        Held(address(self))
    }

    /// Waits for shared access. Panics if waiting could deadlock, also if this thread reads already.
    #[track_caller]
    pub fn read(&self) -> RwLockReadGuard<'_, T> {
        let at = Location::caller();
        self.before(at);
        RwLockReadGuard { guard: self.lock.read(), _held: self.held(at) }
    }

    /// Waits for exclusive access. Panics if waiting could deadlock.
    #[track_caller]
    pub fn write(&self) -> RwLockWriteGuard<'_, T> {
        let at = Location::caller();
        self.before(at);
        RwLockWriteGuard { guard: self.lock.write(), _held: self.held(at) }
    }
}

impl<T: Default> Default for RwLock<T> {
    #[track_caller]
    fn default() -> Self {
        Self::new(T::default())
    }
}

impl<T> Deref for RwLockReadGuard<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.guard
    }
}

impl<T> Deref for RwLockWriteGuard<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.guard
    }
}

impl<T> DerefMut for RwLockWriteGuard<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.guard
    }
}

/// A [`parking_lot::Condvar`] for guards of the checked [`Mutex`].
#[derive(Debug, Default)]
pub struct Condvar(parking_lot::Condvar);

impl Condvar {
    /// Creates a condition variable without waiting threads.
    pub const fn new() -> Self {
        Self(parking_lot::Condvar::new())
    }

    /// Wakes one waiting thread; false if none waits.
    pub fn notify_one(&self) -> bool {
        self.0.notify_one()
    }

    /// Wakes all waiting threads and returns their number.
    pub fn notify_all(&self) -> usize {
        self.0.notify_all()
    }

    /// Releases the mutex until a notification, then takes it again.
    pub fn wait<T>(&self, guard: &mut MutexGuard<'_, T>) {
        self.0.wait(&mut guard.guard);
    }

    /// Like [`Self::wait`], but until `moment` at the latest.
    pub fn wait_until<T>(
        &self,
        guard: &mut MutexGuard<'_, T>,
        moment: Instant,
    ) -> WaitTimeoutResult {
        self.0.wait_until(&mut guard.guard, moment)
    }

    /// Like [`Self::wait`], but for at most `time`.
    pub fn wait_for<T>(&self, guard: &mut MutexGuard<'_, T>, time: Duration) -> WaitTimeoutResult {
        self.0.wait_for(&mut guard.guard, time)
    }

    /// Waits until `condition` is false, but for at most `time`.
    pub fn wait_while_for<T>(
        &self,
        guard: &mut MutexGuard<'_, T>,
        condition: impl FnMut(&mut T) -> bool,
        time: Duration,
    ) -> WaitTimeoutResult {
        self.0.wait_while_for(&mut guard.guard, condition, time)
    }
}

#[cfg(test)]
mod tests {
    use super::{Mutex, RwLock};
    use std::panic::{AssertUnwindSafe, catch_unwind};

    /// Runs `act` and compares the message of its panic; empty without a panic.
    fn check(act: impl FnOnce(), expected: &str) {
        let said = match catch_unwind(AssertUnwindSafe(act)) {
            Ok(()) => String::new(),
            Err(panic) => *panic.downcast::<String>().unwrap(),
        };
        assert!(said.contains(expected) && said.is_empty() == expected.is_empty(), "{said}");
    }

    #[test]
    fn a_lock_is_not_read_twice_by_one_thread() {
        let names = RwLock::new(1);
        check(|| drop(names.read()), "");
        let twice = || {
            let first = names.read();
            drop(names.read());
            drop(first);
        };
        check(twice, "by a thread that holds it since crates/locks/src/checked.rs");
    }

    #[test]
    fn two_locks_are_taken_in_one_order_whichever_threads_take_them() {
        let (engine, list) = (Mutex::new(1_u8), Mutex::new("list"));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let first = engine.lock();
                drop(list.lock());
                drop(first);
            });
        });
        let other_way = || {
            let first = list.lock();
            drop(engine.lock());
            drop(first);
        };
        check(other_way, "locks are taken in contradicting orders: the lock of u8");
    }

    #[test]
    fn a_circle_of_three_is_found() {
        let (one, two, three) = (Mutex::new(1_u8), Mutex::new(2_u16), Mutex::new(3_u32));
        let inside = |act: &dyn Fn(), expected: &str| check(act, expected);
        inside(&|| drop((one.lock(), two.lock())), "");
        inside(&|| drop((two.lock(), three.lock())), "");
        inside(&|| drop((three.lock(), one.lock())), "contradicting orders");
    }

    #[test]
    fn locks_of_one_kind_are_not_taken_one_inside_the_other() {
        let seats = [1, 2].map(Mutex::new);
        check(|| drop((seats[0].lock(), seats[1].lock())), "two locks of one kind");
    }

    #[test]
    fn an_attempt_that_does_not_wait_may_be_made_in_any_order() {
        let (one, two) = (Mutex::new(1_u8), Mutex::new(2_u16));
        check(|| drop((one.lock(), two.lock())), "");
        check(|| drop((two.lock(), one.try_lock())), "");
        let twice = || {
            let held = one.lock();
            assert!(one.try_lock().is_none());
            drop(held);
        };
        check(twice, "");
    }
}
