//! Values of a robot's run that clients watch. The station gets one merged request, and each client receives its own part.
//!
//! Knows the subscriptions. Does not know the transfer from the robot, nor the events, which contain these values later.

use super::run::Run;
use crate::Failure;
use rafcon_locks::Mutex;
use rafcon_protocol::socket::ToClient;
use rafcon_protocol::{WatchKind, WatchTarget, WatchedValue, Watching};
use std::collections::BTreeMap;
use std::sync::Arc;
use tokio::sync::watch;

/// Maximum number of targets in one subscription.
const TARGETS_MAX: usize = 1_024;
/// Capacity of the values of a run.
const VALUES_MAX: usize = 1_024;
/// Maximum number of values in a message to a client; further ones are only counted.
const TOLD_MAX: usize = 256;

/// Subscriptions to values of one run, and the newest values.
#[derive(Debug)]
pub(crate) struct RunWatched {
    watchers: Mutex<Watchers>,
    now: watch::Sender<Arc<WatchedNow>>,
}

#[derive(Debug, Default)]
struct Watchers {
    next: u64,
    targets: BTreeMap<u64, Vec<WatchTarget>>,
    union: Vec<WatchTarget>,
    left_out: u32,
}

/// The newest watched values.
#[derive(Debug, Clone, Default)]
pub(crate) struct WatchedNow {
    watching: Watching,
    left_out: u32,
    values: BTreeMap<(WatchKind, String, String), WatchedValue>,
}

impl Default for RunWatched {
    fn default() -> Self {
        Self { watchers: Mutex::default(), now: watch::Sender::new(Arc::default()) }
    }
}

impl RunWatched {
    /// Targets that are requested from the station.
    pub(super) fn union(&self) -> Vec<WatchTarget> {
        self.watchers.lock().union.clone()
    }

    /// Applies the station's report about watched values.
    pub(super) fn take(&self, watching: Watching, values: Vec<WatchedValue>) {
        self.now.send_modify(|now| {
            let now = Arc::make_mut(now);
            now.watching = watching;
            for value in values {
                let place = (value.kind, value.path.clone(), value.name.clone());
                let known = now.values.get(&place).map(|known| known.sequence);
                let is_room = known.is_some() || now.values.len() < VALUES_MAX;
                if is_room && known.is_none_or(|known| known <= value.sequence) {
                    now.values.insert(place, value);
                }
            }
        });
    }

    /// Sets or removes a subscription. Returns `true` if the station needs a new request.
    fn set(&self, watcher: u64, targets: Option<Vec<WatchTarget>>) -> bool {
        let mut watchers = self.watchers.lock();
        match targets {
            Some(targets) => drop(watchers.targets.insert(watcher, targets)),
            None => drop(watchers.targets.remove(&watcher)),
        }
        let (union, left_out) = WatchTarget::union(watchers.targets.values().flatten());
        watchers.left_out = u32::try_from(left_out).unwrap_or(u32::MAX);
        let is_news = union != watchers.union;
        watchers.union = union;
        // Published under the lock, so that the last publication is the current state.
        self.now.send_modify(|now| {
            let now = Arc::make_mut(now);
            now.left_out = watchers.left_out;
            let is_watched = |value: &WatchedValue| fits(&watchers.union, value);
            now.values.retain(|_, value| is_watched(value));
        });
        is_news
    }
}

/// A subscription to values of a run, until dropped.
#[derive(Debug)]
pub(crate) struct Watcher {
    run: Arc<Run>,
    number: u64,
}

impl Watcher {
    /// Starts a subscription, unless it has too many targets.
    pub(crate) fn begin(run: Arc<Run>, targets: Vec<WatchTarget>) -> Result<Self, Failure> {
        if targets.len() > TARGETS_MAX {
            let message = format!(
                "{} values are too many to watch at once: watch at most {TARGETS_MAX}, or whole states",
                targets.len()
            );
            return Err(Failure::bad("too_many_watched", message));
        }
        let number = {
            let mut watchers = run.watched().watchers.lock();
            watchers.next += 1;
            watchers.next
        };
        let watcher = Self { run, number };
        watcher.set(Some(targets));
        Ok(watcher)
    }

    fn set(&self, targets: Option<Vec<WatchTarget>>) {
        if self.run.watched().set(self.number, targets) {
            self.run.ask_for_watched();
        }
    }

    /// Receiver of the newest watched values.
    pub(crate) fn now(&self) -> watch::Receiver<Arc<WatchedNow>> {
        self.run.watched().now.subscribe()
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        self.set(None);
    }
}

/// Message for a client with these targets. For a local run it is empty, because its events contain the values.
pub(crate) fn frame(
    subscription: u32,
    targets: &[WatchTarget],
    is_replica: bool,
    now: &WatchedNow,
) -> ToClient {
    let WatchedNow { watching, left_out, values } = now;
    let mut values: Vec<_> =
        values.values().filter(|value| fits(targets, value)).cloned().collect();
    let untold = u32::try_from(values.len().saturating_sub(TOLD_MAX)).unwrap_or(u32::MAX);
    values.truncate(TOLD_MAX);
    let left_out = watching.left_out.saturating_add(*left_out).saturating_add(untold);
    let watching = is_replica.then(|| Watching { left_out, ..watching.clone() });
    ToClient::RunWatched { subscription, watching, values }
}

fn fits(targets: &[WatchTarget], value: &WatchedValue) -> bool {
    targets.iter().any(|target| target.fits(value.kind, &value.path, &value.name))
}

#[cfg(test)]
mod tests {
    use super::{RunWatched, TOLD_MAX, VALUES_MAX, frame};
    use rafcon_protocol::socket::ToClient;
    use rafcon_protocol::{WatchKind, WatchTarget, WatchedValue, Watching};

    fn target(path: &str) -> WatchTarget {
        let (kind, path, name) = (WatchKind::Input, path.to_owned(), "x".to_owned());
        WatchTarget { kind, path, name, priority: 0 }
    }

    fn value(path: &str, sequence: u64) -> WatchedValue {
        let (kind, path, name) = (WatchKind::Input, path.to_owned(), "x".to_owned());
        WatchedValue { kind, path, name, sequence, t_ns: 0, value: None, large: None }
    }

    fn told(watched: &RunWatched, paths: &[&str]) -> Vec<(String, u64)> {
        let targets: Vec<_> = paths.iter().map(|path| target(path)).collect();
        let now = watched.now.borrow();
        let ToClient::RunWatched { values, .. } = frame(1, &targets, true, &now) else {
            return Vec::new();
        };
        values.into_iter().map(|value| (value.path, value.sequence)).collect()
    }

    #[test]
    fn each_client_is_told_its_part_and_the_station_is_asked_once() {
        let watched = RunWatched::default();
        assert!(watched.set(1, Some(vec![target("R/A")])));
        assert!(!watched.set(2, Some(vec![target("R/A")])), "that is watched already");
        assert!(watched.set(3, Some(vec![target("R/B")])));
        watched.take(Watching::default(), vec![value("R/A", 5), value("R/B", 6)]);
        watched.take(Watching::default(), vec![value("R/A", 4)]);
        assert_eq!(told(&watched, &["R/A"]), [("R/A".to_owned(), 5)]);
        assert_eq!(told(&watched, &["R/B", "R/C"]), [("R/B".to_owned(), 6)]);
        assert!(!watched.set(1, None), "the second client still watches it");
        assert!(watched.set(2, None));
        assert_eq!(told(&watched, &["R/A", "R/B"]), [("R/B".to_owned(), 6)]);
        assert!(watched.set(3, None));
        assert!(watched.union().is_empty());
    }

    #[test]
    fn of_more_values_than_a_client_is_told_the_number_is_told() {
        let watched = RunWatched::default();
        let whole = WatchTarget { kind: WatchKind::State, ..target("R") };
        watched.set(1, Some(vec![whole.clone()]));
        let values = |count: usize| (0..count).map(|nth| value(&format!("R/{nth}"), 1)).collect();
        let said = || match frame(1, std::slice::from_ref(&whole), true, &watched.now.borrow()) {
            ToClient::RunWatched { watching: Some(watching), values, .. } => {
                (values.len(), watching.left_out as usize)
            }
            other => panic!("{other:?}"),
        };
        watched.take(Watching::default(), values(TOLD_MAX));
        assert_eq!(said(), (TOLD_MAX, 0));
        watched.take(Watching { left_out: 2, ..Watching::default() }, values(TOLD_MAX + 1));
        assert_eq!(said(), (TOLD_MAX, 3));
        watched.take(Watching::default(), values(VALUES_MAX + 1));
        assert_eq!(said(), (TOLD_MAX, VALUES_MAX - TOLD_MAX));
        // A newer version of a known value replaces it, even if the table is full.
        watched.take(Watching::default(), vec![value("R/0", 2), value("R/new", 2)]);
        assert_eq!(told(&watched, &["R/0", "R/new"]), [("R/0".to_owned(), 2)]);
        // A shorter list of targets makes room.
        watched.set(1, Some(vec![target("R/new")]));
        watched.take(Watching::default(), vec![value("R/new", 3)]);
        assert_eq!(told(&watched, &["R/0", "R/new"]), [("R/new".to_owned(), 3)]);
    }
}
