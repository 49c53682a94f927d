//! Deferred release of Python objects. The engine drops values under its lock, but an object's clean-up is user code that
//! must not run there. Such objects are kept here and released where no lock is held.

use parking_lot::Mutex;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    static OWN: RefCell<Vec<Py<PyAny>>> = const { RefCell::new(Vec::new()) };
}

/// Objects dropped by threads outside the interpreter.
static OTHERS: Mutex<Vec<Py<PyAny>>> = Mutex::new(Vec::new());
static OTHERS_FILLED: AtomicBool = AtomicBool::new(false);

/// Keeps an object until the next [`clear`].
pub(crate) fn bury(object: Py<PyAny>) {
    let mut object = Some(object);
    // The storage of an ending thread is already destroyed.
    let kept = OWN.try_with(|own| own.borrow_mut().extend(object.take()));
    if kept.is_err() {
        hand_over(object);
    }
}

/// Releases all objects that this thread, or a thread outside the interpreter, has dropped. No lock may be held.
pub(crate) fn clear(_py: Python<'_>) {
    while let Some(object) = OWN.with(|own| own.borrow_mut().pop()) {
        drop(object);
    }
    if OTHERS_FILLED.load(Ordering::Relaxed) {
        let others = {
            let mut others = OTHERS.lock();
            OTHERS_FILLED.store(false, Ordering::Relaxed);
            std::mem::take(&mut *others)
        };
        drop(others);
    }
}

/// Passes the objects that this thread has dropped to threads inside the interpreter.
pub(crate) fn leave_to_others() {
    hand_over(OWN.take());
}

fn hand_over(objects: impl IntoIterator<Item = Py<PyAny>>) {
    let mut objects = objects.into_iter().peekable();
    if objects.peek().is_some() {
        OTHERS.lock().extend(objects);
        OTHERS_FILLED.store(true, Ordering::Relaxed);
    }
}
