//! The requests to start or resume a run, by id. The task that holds the lock of a request performs it; others wait.
//!
//! Knows ids and states of requests, but not their content. The table is limited.

use rafcon_locks::Mutex;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Capacity. Beyond it, the oldest requests are forgotten, except those in progress.
const REQUESTS_MAX: usize = 10_000;

/// The state of a request, locked while it is performed.
pub(super) type Slot = Arc<tokio::sync::Mutex<Option<StartRequestState>>>;

/// State of a recorded request to start a run.
#[derive(Debug)]
pub(super) enum StartRequestState {
    /// It has started the run with this id.
    Begun(String),
    /// Its run has this folder and is not known to have begun.
    Open(PathBuf),
}

/// Progress of a request to start a run.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum StartProgress {
    /// It has started no run.
    Nothing,
    /// It is in progress.
    UnderWay,
    /// It has started the run with this id.
    Begun(String),
    /// An earlier server recorded it in this folder.
    Open(PathBuf),
}

/// The table of remembered requests.
#[derive(Debug, Default)]
pub(super) struct StartRequests(Mutex<Table>);

#[derive(Debug, Default)]
struct Table {
    slots: BTreeMap<String, (u64, Slot)>,
    /// The ids in the order of their arrival.
    order: BTreeMap<u64, String>,
    next: u64,
}

impl StartRequests {
    /// The request with this id.
    pub(super) fn get(&self, id: &str) -> Slot {
        let mut table = self.0.lock();
        if let Some((_, slot)) = table.slots.get(id) {
            return Arc::clone(slot);
        }
        while table.slots.len() >= REQUESTS_MAX && table.forget_oldest() {}
        table.add(id)
    }

    /// Progress of a request to start a run.
    pub(super) fn progress(&self, id: &str) -> StartProgress {
        let table = self.0.lock();
        let Some((_, slot)) = table.slots.get(id) else { return StartProgress::Nothing };
        let Ok(known) = slot.try_lock() else { return StartProgress::UnderWay };
        match &*known {
            Some(StartRequestState::Begun(run)) => StartProgress::Begun(run.clone()),
            Some(StartRequestState::Open(folder)) => StartProgress::Open(folder.clone()),
            None => StartProgress::Nothing,
        }
    }

    /// Removes a request that has started no run, unless another task waits for it.
    pub(super) fn forget(&self, id: &str, slot: &Slot) {
        let mut table = self.0.lock();
        // The table has one of them, and the caller the other.
        if Arc::strong_count(slot) == 2 {
            table.remove(id);
        }
    }

    /// Sets the state of a request, unless a task performs it: that task sets the state itself.
    pub(super) fn note(&self, id: &str, state: StartRequestState) {
        if let Ok(mut known) = self.get(id).try_lock() {
            *known = Some(state);
        }
    }
}

impl Table {
    fn add(&mut self, id: &str) -> Slot {
        let slot = Slot::default();
        self.slots.insert(id.to_owned(), (self.next, Arc::clone(&slot)));
        self.order.insert(self.next, id.to_owned());
        self.next += 1;
        slot
    }

    fn remove(&mut self, id: &str) {
        if let Some((place, _)) = self.slots.remove(id) {
            self.order.remove(&place);
        }
    }

    /// Returns `false` if all are in progress: each ends within the time limits of a start.
    fn forget_oldest(&mut self) -> bool {
        let is_idle = |id: &&String| {
            self.slots.get(*id).is_some_and(|(_, slot)| Arc::strong_count(slot) == 1)
        };
        let oldest = self.order.values().find(is_idle).cloned();
        oldest.inspect(|id| self.remove(id)).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::{REQUESTS_MAX, StartRequestState, StartRequests};

    fn begun(requests: &StartRequests, id: &str) -> Option<String> {
        match requests.get(id).try_lock().unwrap().as_ref()? {
            StartRequestState::Begun(run) => Some(run.clone()),
            StartRequestState::Open(_) => None,
        }
    }

    #[test]
    fn of_many_requests_the_oldest_are_forgotten_and_none_under_way() {
        let requests = StartRequests::default();
        let note = |nth: usize| {
            let run = StartRequestState::Begun(format!("run-{nth}"));
            requests.note(&format!("start/ana/{nth}"), run);
        };
        let under_way = requests.get("start/ana/0");
        (1..REQUESTS_MAX).for_each(note);
        assert_eq!(begun(&requests, "start/ana/1").as_deref(), Some("run-1"));
        (REQUESTS_MAX..REQUESTS_MAX + 3).for_each(note);
        assert_eq!(requests.0.lock().slots.len(), REQUESTS_MAX);
        assert_eq!(requests.0.lock().order.len(), REQUESTS_MAX);
        let known = |nth: usize| requests.0.lock().slots.contains_key(&format!("start/ana/{nth}"));
        assert_eq!([0, 1, 2, 3, 4].map(known), [true, false, false, false, true]);
        // A second task with the id of a request in progress waits for its end.
        let held = under_way.try_lock().unwrap();
        assert!(requests.get("start/ana/0").try_lock().is_err());
        drop(held);
        let last = REQUESTS_MAX + 2;
        assert_eq!(begun(&requests, &format!("start/ana/{last}")), Some(format!("run-{last}")));
    }

    #[test]
    fn a_request_that_began_nothing_is_forgotten_unless_somebody_else_waits_for_it() {
        let requests = StartRequests::default();
        let slot = requests.get("start/ana/1");
        let other = requests.get("start/ana/1");
        requests.forget("start/ana/1", &slot);
        assert_eq!(requests.0.lock().slots.len(), 1);
        drop(other);
        requests.forget("start/ana/1", &slot);
        let table = requests.0.lock();
        assert!(table.slots.is_empty() && table.order.is_empty());
    }
}
