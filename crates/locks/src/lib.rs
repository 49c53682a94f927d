//! The locks of the runner and the server. A release build has those of `parking_lot`, as they are. A debug build, and so every
//! test, checks them while they are used: it panics when a thread
//!
//! - takes a lock that it holds already, also for reading twice: a writer that waits in between stops both for ever,
//! - takes two locks of one kind, one inside the other,
//! - takes two locks in an order that contradicts an earlier one in this process, by any thread.
//!
//! An order that can end in a deadlock is found by the first test that executes both of its halves, also without a deadlock. Locks with
//! one place of creation in the source and one type of content are of one kind. An attempt that does not wait (`try_lock`, or one
//! with a bound) cannot deadlock and adds nothing to the order. `ARCHITECTURE.md` lists the orders of this project.

#[cfg(debug_assertions)]
mod checked;
#[cfg(debug_assertions)]
mod order;

#[cfg(debug_assertions)]
pub use checked::{Condvar, Mutex, MutexGuard, RwLock, RwLockReadGuard, RwLockWriteGuard};
#[cfg(not(debug_assertions))]
pub use parking_lot::{Condvar, Mutex, MutexGuard, RwLock, RwLockReadGuard, RwLockWriteGuard};
