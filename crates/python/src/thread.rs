//! Activity of this thread for the run: the state of its script, and its use of the interpreter.

use pyo3::prelude::*;
use rafcon_engine::PathId;
use std::cell::Cell;

thread_local! {
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    static PATH: Cell<Option<PathId>> = const { Cell::new(None) };
    static RESOLVING: Cell<bool> = const { Cell::new(false) };
}

/// Runs `life` inside the interpreter, with a Python thread state for its duration.
pub(crate) fn inhabit(life: &mut (dyn FnMut() + Send)) {
    Python::attach(|_py| {
        INSIDE.set(true);
        life();
        INSIDE.set(false);
    });
}

/// Runs `wait` outside the interpreter, if this thread is inside.
pub(crate) fn park(wait: &mut (dyn FnMut() + Send)) {
    if INSIDE.replace(false) {
        Python::attach(|py| py.detach(wait));
        INSIDE.set(true);
    } else {
        wait();
    }
}

/// Runs `wait` outside the interpreter; for calls from Python on any thread.
pub(crate) fn leave<T: Send>(py: Python<'_>, wait: impl FnOnce() -> T + Send) -> T {
    let inside = INSIDE.replace(false);
    let answer = py.detach(wait);
    INSIDE.set(inside);
    answer
}

/// Runs `ask` outside the interpreter. On a thread of the run, `ask` itself leaves the interpreter while it waits.
pub(crate) fn outside<T: Send>(py: Python<'_>, ask: impl FnOnce() -> T + Send) -> T {
    if is_inside() { ask() } else { leave(py, ask) }
}

/// True if this thread runs inside the interpreter.
pub(crate) fn is_inside() -> bool {
    INSIDE.get()
}

/// The state whose script runs on this thread.
pub(crate) fn current_path() -> Option<PathId> {
    PATH.get()
}

/// Runs `script` as the script of the state at `path`.
pub(crate) fn at<T>(path: PathId, script: impl FnOnce() -> T) -> T {
    let before = PATH.replace(Some(path));
    let answer = script();
    PATH.set(before);
    answer
}

/// Runs `resolve` in Python while this thread has locked the engine.
pub(crate) fn while_engine_waits<T>(resolve: impl FnOnce() -> T) -> T {
    RESOLVING.set(true);
    let answer = resolve();
    RESOLVING.set(false);
    answer
}

/// True if this thread has locked the engine.
pub(crate) fn engine_waits() -> bool {
    RESOLVING.get()
}
