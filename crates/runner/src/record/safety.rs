//! What of the record is safe from a power cut, and who waits for it. Knows numbers; knows nothing of a disk.

use rafcon_locks::{Condvar, Mutex, MutexGuard};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

/// How long a first event waits for others, so that they become safe together.
const GROUP: Duration = Duration::from_millis(3);
/// How long after a failure it is tried again.
const RETRY: Duration = Duration::from_secs(1);
/// With more bytes than this on their way, branches wait: what is left is for events that nothing can hold up.
const BACKLOG_BYTES: usize = 2 << 20;

/// The border between what is safe and what is not.
#[derive(Debug, Default)]
pub(crate) struct Safety {
    state: Mutex<State>,
    /// For those who wait for safety or room.
    safer: Condvar,
    /// For the committer.
    work: Condvar,
    /// For those who care about problems.
    turned: Condvar,
    /// The committer waits for work.
    idle: AtomicBool,
    /// The last record that was written.
    written: AtomicU64,
    /// Bytes that were written and are not safe.
    backlog: AtomicUsize,
    /// Whether each script waits until everything before it is safe.
    strict: bool,
}

#[derive(Debug, Default)]
struct State {
    /// The last record that is safe.
    safe: u64,
    /// Why nothing becomes safe now.
    problem: Option<Arc<str>>,
    /// Why a large group cannot even be written now.
    refused: Option<Arc<str>>,
    /// How many wait for safety or room.
    waiting: u32,
    /// How often it was tried to make something safe.
    tries: u64,
    /// No one waits any more while there is a problem: the run is ending.
    ending: bool,
    /// Detail before this record was given up, and no one was told yet.
    thinned: Option<u64>,
    stage: Stage,
}

/// How far the record has come.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    /// It grows.
    #[default]
    Open,
    /// The next try to make it safe is the last.
    Closing,
    /// There are no more tries.
    Over,
    /// Nothing comes any more.
    Closed,
}

impl State {
    fn problem(&self) -> Option<&Arc<str>> {
        self.problem.as_ref().or(self.refused.as_ref())
    }

    /// Whether no one waits any more.
    fn gives_up(&self) -> bool {
        self.stage >= Stage::Over || self.ending && self.problem().is_some()
    }
}

/// What concerns the run.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum RunAction {
    /// Nothing becomes safe now, and why.
    Fails(Arc<str>),
    /// It does again.
    Works,
    /// Detail before this record was given up.
    Thinned(u64),
}

/// What the committer is to do.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum CommitterWork {
    /// Make safe what was written.
    Commit,
    /// The same for the last time.
    Last,
}

impl Safety {
    /// Everything up to record `last` is safe.
    pub(crate) fn new(last: u64, strict: bool) -> Self {
        let state = State { safe: last, ..State::default() };
        Self { state: Mutex::new(state), written: AtomicU64::new(last), strict, ..Self::default() }
    }

    /// The last record that is safe, and why nothing becomes safe now.
    pub(crate) fn state(&self) -> (u64, Option<Arc<str>>) {
        let state = self.state.lock();
        (state.safe, state.problem().cloned())
    }

    /// Records up to `last` were written.
    pub(crate) fn wrote(&self, last: u64, bytes: usize) {
        self.backlog.fetch_add(bytes, Ordering::Relaxed);
        self.written.store(last, Ordering::SeqCst);
        if self.idle.load(Ordering::SeqCst) {
            drop(self.state.lock());
            self.work.notify_one();
        }
    }

    /// Whether too much is on its way.
    pub(crate) fn is_full(&self) -> bool {
        self.backlog.load(Ordering::Relaxed) > BACKLOG_BYTES
    }

    /// Whether a script may have to wait before it begins.
    pub(crate) fn holds(&self) -> bool {
        self.strict || self.is_full()
    }

    /// Waits until less is on its way.
    pub(crate) fn wait_for_room(&self) {
        self.wait_until(|_| !self.is_full());
    }

    /// The same, and with the strict rule until all that was written by now is safe.
    pub(crate) fn wait(&self) {
        let wanted = if self.strict { self.written.load(Ordering::SeqCst) } else { 0 };
        self.wait_until(|state| state.safe >= wanted && !self.is_full());
    }

    /// Waits until the next try to make something safe; false if the run ends and the disk refuses, or there are no more tries.
    pub(crate) fn wait_for_try(&self) -> bool {
        let before = self.state.lock().tries;
        self.wait_until(|state| state.tries > before);
        let state = self.state.lock();
        state.problem().is_none() && state.tries > before || !state.gives_up()
    }

    /// A large group cannot be written: waits a while before it is tried again; false if the run ends.
    pub(crate) fn refused(&self, problem: &str) -> bool {
        let mut state = self.state.lock();
        self.change(&mut state, |state| state.refused = Some(problem.into()));
        self.safer.wait_while_for(&mut state, |state| !state.gives_up(), RETRY);
        !state.gives_up()
    }

    /// It was written after all.
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

    /// The run ends: a disk that refuses must not keep it from that.
    pub(crate) fn end(&self) {
        self.state.lock().ending = true;
        self.safer.notify_all();
    }

    /// Whether it does.
    pub(crate) fn is_ending(&self) -> bool {
        self.state.lock().ending
    }

    /// Makes the committer commit for the last time.
    pub(crate) fn close(&self) {
        let mut state = self.state.lock();
        (state.ending, state.stage) = (true, state.stage.max(Stage::Closing));
        self.work.notify_one();
        self.safer.notify_all();
    }

    /// Waits until there is something to do; called by the committer alone.
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

    /// How much is on its way, for [`Safety::committed`].
    pub(crate) fn backlog(&self) -> usize {
        self.backlog.load(Ordering::Relaxed)
    }

    /// Records up to `last` are safe, and `bytes` that were on their way.
    pub(crate) fn committed(&self, last: u64, bytes: usize) {
        self.backlog.fetch_sub(bytes, Ordering::Relaxed);
        let mut state = self.state.lock();
        state.safe = last;
        self.tried(&mut state, None);
    }

    /// Nothing becomes safe now.
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

    /// It was tried for the last time.
    pub(crate) fn over(&self) {
        let mut state = self.state.lock();
        state.stage = state.stage.max(Stage::Over);
        self.safer.notify_all();
    }

    /// Nothing more is made safe.
    pub(crate) fn closed(&self) {
        self.state.lock().stage = Stage::Closed;
        self.safer.notify_all();
        self.turned.notify_all();
    }

    /// Detail before this record was given up.
    pub(crate) fn thinned(&self, before: u64) {
        self.state.lock().thinned = Some(before);
        self.turned.notify_all();
    }

    /// Waits for what concerns the run; `was` says whether there was a problem before. None if nothing can come any more.
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
