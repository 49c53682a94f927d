//! Operators who watch values of the mission at the first station: the requests of the station, and the robot's responses.

use super::mission::MissionState;
use super::robot::STREAM;
use rafcon_link::{NewestValue, RobotSession, SessionTime};
use rafcon_protocol::{WatchKind, WatchTarget};
use std::collections::BTreeMap;
use std::time::Duration;

/// Interval at which operators join, also while the link is cut.
const JOIN_EVERY: Duration = Duration::from_mins(7);

/// The operators of the first station.
#[derive(Debug, Default)]
pub(super) struct Operators {
    /// Watched states of each operator.
    targets: Vec<Vec<WatchTarget>>,
    asked: Vec<WatchTarget>,
    number: u64,
}

impl Operators {
    /// Times at which this number of operators join.
    pub(super) fn join_at(count: usize) -> impl Iterator<Item = Duration> {
        (0..u32::try_from(count).unwrap_or_default())
            .map(|operator| Duration::from_secs(30) + JOIN_EVERY * operator)
    }

    /// Adds an operator who watches all of these states, in a different order.
    pub(super) fn join(&mut self, states: &[String]) {
        let target = |path: &String| {
            let (kind, path, name) = (WatchKind::State, path.clone(), String::new());
            WatchTarget { kind, path, name, priority: 0 }
        };
        let mut targets: Vec<_> = states.iter().map(target).collect();
        targets.rotate_left(self.targets.len() % states.len().max(1));
        self.targets.push(targets);
    }

    /// Request of the station to the robot with its number, if it has changed.
    pub(super) fn wish(&mut self) -> Option<(u64, Vec<u8>)> {
        let (union, _) = WatchTarget::union(self.targets.iter().flatten());
        if union == self.asked {
            return None;
        }
        let paths: Vec<_> = union.iter().map(|target| target.path.as_str()).collect();
        let body = paths.join("\n").into_bytes();
        (self.asked, self.number) = (union, self.number + 1);
        Some((self.number, body))
    }

    /// Forgets the last request, after a restart of the station.
    pub(super) fn ask_again(&mut self) {
        self.asked.clear();
    }
}

/// The robot's persistent record of what a station watches.
#[derive(Debug, Default)]
pub(super) struct Watched {
    pub(super) number: u64,
    states: Vec<String>,
    keys: BTreeMap<String, u32>,
}

impl Watched {
    /// Receives the requests of the station.
    pub(super) fn take(&mut self, session: &mut RobotSession) {
        while let Some(subscription) = session.take_subscription() {
            let text = String::from_utf8_lossy(&subscription.body).into_owned();
            let states = text.lines().map(str::to_owned).collect();
            *self = Self { number: subscription.number, states, keys: BTreeMap::new() };
        }
    }

    /// Sends the newest inputs of the watched states, if their events do not arrive in time.
    pub(super) fn tell(
        &mut self,
        now: SessionTime,
        state: &MissionState,
        session: &mut RobotSession,
    ) {
        if self.states.is_empty() || !session.needs_watched(now, STREAM) {
            return;
        }
        for (path, sequence, inputs) in state.inputs() {
            let is_watched = self.states.iter().any(|state| path.starts_with(state));
            if !is_watched || inputs.is_empty() {
                continue;
            }
            let next = u32::try_from(self.keys.len()).unwrap_or(u32::MAX);
            let key = *self.keys.entry(path.clone()).or_insert(next);
            let bytes = format!("{sequence} {path} {inputs}").into_bytes();
            session.set_watched(STREAM, key, NewestValue { priority: 0, sequence, bytes });
        }
    }
}

/// Number of the event of a value that arrived early; `None` if the value is invalid.
pub(super) fn event_of(value: &[u8]) -> Option<u64> {
    std::str::from_utf8(value).ok()?.split(' ').next()?.parse().ok()
}
