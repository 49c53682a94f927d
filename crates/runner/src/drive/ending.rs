//! The end of a run in its process: decided once, and awaited by one thread.

use rafcon_engine::Finish;
use rafcon_locks::{Condvar, Mutex};

/// The ways in which a run ends in its process.
#[derive(Debug)]
pub(crate) enum RunEnd<D> {
    /// The run is over.
    Finished(Finish<D>),
    /// A script does not end, so the process must end.
    CutOff,
    /// The engine failed, so its state is unreliable and the process must end.
    Broken,
}

/// The end of a run, once it is decided.
#[derive(Debug)]
pub(crate) struct Ending<D> {
    end: Mutex<Option<RunEnd<D>>>,
    is_there: Condvar,
}

impl<D> Default for Ending<D> {
    fn default() -> Self {
        Self { end: Mutex::new(None), is_there: Condvar::new() }
    }
}

impl<D> Ending<D> {
    /// Decides the end, unless it is already decided.
    pub(crate) fn decide(&self, end: RunEnd<D>) {
        self.end.lock().get_or_insert(end);
        self.is_there.notify_all();
    }

    /// Waits for the end, outside the interpreter, and takes it.
    pub(crate) fn wait(&self) -> Option<RunEnd<D>> {
        let mut end = self.end.lock();
        while end.is_none() {
            self.is_there.wait(&mut end);
        }
        end.take()
    }
}
