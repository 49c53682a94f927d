//! Tracks the records that are safe from a power cut, and the threads that wait for that. This module knows numbers,
//! but no disk.

use rafcon_locks::{Condvar, Mutex, MutexGuard};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

/// Time that a first event waits for others, so that they are committed together.
const GROUP: Duration = Duration::from_millis(3);
/// Retry interval after a failure.
const RETRY: Duration = Duration::from_secs(1);
/// Limit of the bytes that are not safe, beyond which branches wait. The room above it is for events that cannot wait.
const BACKLOG_BYTES: usize = 2 << 20;

/// The border between safe and unsafe records.
#[derive(Debug, Default)]
pub(crate) struct Safety {
    state: Mutex<State>,
    /// Wakes threads that wait for safety or room.
    safer: Condvar,
    /// Wakes the committer for new work.
    work: Condvar,
    /// Wakes the thread that handles problems.
    turned: Condvar,
    /// True while the committer waits for work.
    idle: AtomicBool,
    /// The last record that was written.
    written: AtomicU64,
    /// Number of bytes that were written and are not safe.
    backlog: AtomicUsize,
    /// True if each script waits until everything before it is safe.
    strict: bool,
}

#[derive(Debug, Default)]
struct State {
    /// The last record that is safe.
    safe: u64,
    /// Reason why commits fail now.
    problem: Option<Arc<str>>,
    /// Reason why a large group cannot be written now.
    refused: Option<Arc<str>>,
    /// Number of threads that wait for safety or room.
    waiting: u32,
    /// Number of commits tried.
    tries: u64,
    /// True if the run is ending, so that no thread waits while a problem exists.
    ending: bool,
    /// The record before which detail was dropped, until that is reported.
    thinned: Option<u64>,
    stage: Stage,
}

/// The stages of the record's life.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    /// Records are still added.
    #[default]
    Open,
    /// The next commit is the last.
    Closing,
    /// No more commits follow.
    Over,
    /// The record is closed.
    Closed,
}

impl State {
    fn problem(&self) -> Option<&Arc<str>> {
        self.problem.as_ref().or(self.refused.as_ref())
    }

    /// True if no thread waits any more.
    fn gives_up(&self) -> bool {
        self.stage >= Stage::Over || self.ending && self.problem().is_some()
    }
}

/// A change that concerns the run.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum RunAction {
    /// Commits fail now, for this reason.
    Fails(Arc<str>),
    /// Commits succeed again after failures.
    Works,
    /// Detail before this record was dropped.
    Thinned(u64),
}

/// The committer's next work.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum CommitterWork {
    /// Commit the written records.
    Commit,
    /// Commit for the last time.
    Last,
}

impl Safety {
    /// The state in which everything up to record `last` is safe.
    pub(crate) fn new(last: u64, strict: bool) -> Self {
        let state = State { safe: last, ..State::default() };
        Self { state: Mutex::new(state), written: AtomicU64::new(last), strict, ..Self::default() }
    }

    /// The last record that is safe, and the reason if commits fail now.
    pub(crate) fn state(&self) -> (u64, Option<Arc<str>>) {
        let state = self.state.lock();
        (state.safe, state.problem().cloned())
    }

    /// Notes that records up to `last` were written.
    pub(crate) fn wrote(&self, last: u64, bytes: usize) {
        self.backlog.fetch_add(bytes, Ordering::Relaxed);
        self.written.store(last, Ordering::SeqCst);
        if self.idle.load(Ordering::SeqCst) {
            drop(self.state.lock());
            self.work.notify_one();
        }
    }

    /// True if the limit of unsafe bytes is exceeded.
    pub(crate) fn is_full(&self) -> bool {
        self.backlog.load(Ordering::Relaxed) > BACKLOG_BYTES
    }

    /// True if a script may have to wait before it begins.
    pub(crate) fn holds(&self) -> bool {
        self.strict || self.is_full()
    }

    /// Waits until the unsafe bytes are within the limit.
    pub(crate) fn wait_for_room(&self) {
        self.wait_until(|_| !self.is_full());
    }

    /// Waits for room. With the strict rule, also waits until everything written before is safe.
    pub(crate) fn wait(&self) {
        let wanted = if self.strict { self.written.load(Ordering::SeqCst) } else { 0 };
        self.wait_until(|state| state.safe >= wanted && !self.is_full());
    }

    /// Waits for the next commit. False if the run ends and the disk fails, or if no more commits follow.
    pub(crate) fn wait_for_try(&self) -> bool {
        let before = self.state.lock().tries;
        self.wait_until(|state| state.tries > before);
        let state = self.state.lock();
        state.problem().is_none() && state.tries > before || !state.gives_up()
    }

    /// Notes that a large group cannot be written, and waits before the retry. False if the run ends.
    pub(crate) fn refused(&self, problem: &str) -> bool {
        let mut state = self.state.lock();
        self.change(&mut state, |state| state.refused = Some(problem.into()));
        self.safer.wait_while_for(&mut state, |state| !state.gives_up(), RETRY);
        !state.gives_up()
    }

    /// Notes that the large group was written.
    pub(crate) fn taken(&self) {
        self.change(&mut self.state.lock(), |state| state.refused = None);
    }

    fn wait_until(&self, done: impl Fn(&State) -> bool) {
        let mut state = self.state.lock();
        state.waiting += 1;
        self.work.notify_one();
        while !(done(&state) || state.gives_up()) {
            self.safer.wait(&mut state);
        }
        state.waiting -= 1;
    }

    /// Notes that the run ends, so that a failing disk does not prevent that.
    pub(crate) fn end(&self) {
        self.state.lock().ending = true;
        self.safer.notify_all();
    }

    /// True if the run ends.
    pub(crate) fn is_ending(&self) -> bool {
        self.state.lock().ending
    }

    /// Requests the last commit.
    pub(crate) fn close(&self) {
        let mut state = self.state.lock();
        (state.ending, state.stage) = (true, state.stage.max(Stage::Closing));
        self.work.notify_one();
        self.safer.notify_all();
    }

    /// Waits for the next work. Called by the committer only.
    pub(crate) fn next_work(&self) -> CommitterWork {
        let mut state = self.state.lock();
        if state.problem.is_some() && state.stage == Stage::Open {
            self.work.wait_for(&mut state, RETRY);
        } else {
            self.wait_for_records(&mut state);
        }
        if state.stage > Stage::Open { CommitterWork::Last } else { CommitterWork::Commit }
    }

    fn wait_for_records(&self, state: &mut MutexGuard<'_, State>) {
        self.idle.store(true, Ordering::SeqCst);
        while state.stage == Stage::Open && state.waiting == 0 && self.is_all_safe(state) {
            self.work.wait(state);
        }
        self.idle.store(false, Ordering::SeqCst);
        if state.stage == Stage::Open && state.waiting == 0 {
            self.work.wait_for(state, GROUP);
        }
    }

    fn is_all_safe(&self, state: &State) -> bool {
        self.written.load(Ordering::SeqCst) <= state.safe
    }

    /// The number of unsafe bytes, for [`Safety::committed`].
    pub(crate) fn backlog(&self) -> usize {
        self.backlog.load(Ordering::Relaxed)
    }

    /// Notes that records up to `last` are safe, with `bytes` of the unsafe bytes.
    pub(crate) fn committed(&self, last: u64, bytes: usize) {
        self.backlog.fetch_sub(bytes, Ordering::Relaxed);
        let mut state = self.state.lock();
        state.safe = last;
        self.tried(&mut state, None);
    }

    /// Notes that a commit failed.
    pub(crate) fn failed(&self, problem: &str) {
        self.tried(&mut self.state.lock(), Some(problem.into()));
    }

    fn tried(&self, state: &mut State, problem: Option<Arc<str>>) {
        self.change(state, |state| state.problem = problem);
        state.tries += 1;
        self.safer.notify_all();
    }

    fn change(&self, state: &mut State, change: impl FnOnce(&mut State)) {
        let was = state.problem().is_some();
        change(state);
        if state.problem().is_some() != was {
            self.turned.notify_all();
        }
    }

    /// Notes that the last commit was tried.
    pub(crate) fn over(&self) {
        let mut state = self.state.lock();
        state.stage = state.stage.max(Stage::Over);
        self.safer.notify_all();
    }

    /// Notes that the record is closed.
    pub(crate) fn closed(&self) {
        self.state.lock().stage = Stage::Closed;
        self.safer.notify_all();
        self.turned.notify_all();
    }

    /// Notes that detail before this record was dropped.
    pub(crate) fn thinned(&self, before: u64) {
        self.state.lock().thinned = Some(before);
        self.turned.notify_all();
    }

    /// Waits for the next change that concerns the run; `was` is true if a problem was reported before. `None` if no
    /// change can follow.
    pub(crate) fn next_turn(&self, was: bool) -> Option<RunAction> {
        let mut state = self.state.lock();
        loop {
            if let Some(before) = state.thinned.take() {
                return Some(RunAction::Thinned(before));
            }
            match state.problem() {
                Some(problem) if !was => return Some(RunAction::Fails(Arc::clone(problem))),
                None if was => return Some(RunAction::Works),
                _ if state.stage == Stage::Closed => return None,
                _ => self.turned.wait(&mut state),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Safety;

    #[test]
    fn a_large_group_that_cannot_be_written_stays_a_problem_until_it_is() {
        let safety = Safety::new(0, false);
        safety.end();
        assert!(!safety.refused("there is no room"));
        safety.committed(0, 0);
        assert_eq!(safety.state().1.as_deref(), Some("there is no room"));
        safety.taken();
        assert_eq!(safety.state().1, None);
    }

    #[test]
    fn nobody_waits_for_a_try_after_the_last() {
        let safety = Safety::new(0, false);
        safety.over();
        assert!(!safety.wait_for_try());
    }
}
