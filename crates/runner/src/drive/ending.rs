//! The end of a run in its process: decided once, waited for by one. Knows how a run can end, but not what ends it.

use rafcon_engine::Finish;
use rafcon_locks::{Condvar, Mutex};

/// How a run of a process ends.
#[derive(Debug)]
pub(crate) enum RunEnd<D> {
    /// The run is over.
    Finished(Finish<D>),
    /// A script does not end: the process has to.
    CutOff,
    /// The engine failed: nothing that it says can be trusted any more, and the process has to end.
    Broken,
}

/// The end of a run, once there is one.
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
    /// This is the end, unless there is one already.
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
