//! Requests of a server to its station for large values, with their progress. Shared between the threads of both.

use parking_lot::Mutex;
use rafcon_protocol::api::ValueFetch;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Capacity of the requests that wait for a station.
const REQUESTS_MAX: usize = 256;
/// Capacity of the fetches. Beyond it, those that failed before are forgotten.
const ENDED_MAX: usize = 256;

/// A value by its run and its number there.
pub(crate) type ValueKey = (String, u64);

/// Requested large values of a station.
#[derive(Debug, Clone, Default)]
pub struct ValueFetchBroker(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    requests: Vec<Request>,
    fetches: BTreeMap<ValueKey, ValueFetch>,
    links: BTreeMap<String, LinkRate>,
}

/// Request to a station.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Request {
    pub(crate) robot: String,
    pub(crate) key: ValueKey,
    /// Budget in bytes. `None` ends the request.
    pub(crate) budget: Option<u64>,
}

/// Cost of a large value on a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LinkRate {
    /// Bytes of a value in one datagram.
    pub(crate) part: u64,
    /// Overhead of a datagram in bytes.
    pub(crate) overhead: u64,
    /// Unused rate in bytes per second. `None` without contact.
    pub(crate) spare_per_s: Option<u64>,
}

/// Present cost of a large value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ValueCost {
    /// Bytes on the link.
    pub link_bytes: u64,
    /// Expected duration in ms. `None` without contact.
    pub takes_ms: Option<u64>,
}

impl ValueFetchBroker {
    /// Requests a value of a robot's run with a budget in bytes. Returns false if the request is rejected.
    pub fn fetch(&self, robot: &str, key: (String, u64), length: u64, budget: u64) -> bool {
        let mut state = self.0.lock();
        if !state.links.contains_key(robot) || state.requests.len() >= REQUESTS_MAX {
            return false;
        }
        let here = state.fetches.get(&key).map_or(0, |fetch| fetch.here.min(length));
        state.fetches.insert(key.clone(), ValueFetch { here, budget, failed: None });
        state.requests.push(Request { robot: robot.to_owned(), key, budget: Some(budget) });
        true
    }

    /// Ends the request for a value.
    pub fn cancel(&self, robot: &str, key: (String, u64)) {
        let mut state = self.0.lock();
        if state.fetches.remove(&key).is_none() {
            return;
        }
        // It takes the place of the request that it ends, or is one more for each fetch that was taken: none is lost.
        state.requests.retain(|request| request.robot != robot || request.key != key);
        state.requests.push(Request { robot: robot.to_owned(), key, budget: None });
    }

    /// Progress of a value that is or was fetched.
    pub fn progress(&self, run: &str, number: u64) -> Option<ValueFetch> {
        self.0.lock().fetches.get(&(run.to_owned(), number)).cloned()
    }

    /// Cost of a value of this length. `None` if this station does not receive the robot.
    pub fn cost(&self, robot: &str, bytes: u64) -> Option<ValueCost> {
        let LinkRate { part, overhead, spare_per_s } = *self.0.lock().links.get(robot)?;
        let link_bytes = bytes + bytes.div_ceil(part.max(1)) * overhead;
        let takes = |per_s: u64| link_bytes.saturating_mul(1_000) / per_s.max(1);
        Some(ValueCost { link_bytes, takes_ms: spare_per_s.map(takes) })
    }

    /// Pending requests for this robot.
    pub(crate) fn take(&self, robot: &str) -> Vec<Request> {
        let requests = &mut self.0.lock().requests;
        requests.extract_if(.., |request| request.robot == robot).collect()
    }

    /// Stores the progress of a value, unless its request has ended.
    pub(crate) fn set_progress(&self, key: &ValueKey, fetch: ValueFetch) {
        let mut state = self.0.lock();
        state.fetches.insert(key.clone(), fetch);
        if state.fetches.len() > ENDED_MAX {
            state.fetches.retain(|other, fetch| other == key || fetch.failed.is_none());
        }
    }

    /// A value is here.
    pub(crate) fn set_here(&self, key: &ValueKey) {
        self.0.lock().fetches.remove(key);
    }

    /// The link to a robot is like this.
    pub(crate) fn set_link(&self, robot: &str, rate: LinkRate) {
        self.0.lock().links.insert(robot.to_owned(), rate);
    }
}

#[cfg(test)]
mod tests {
    use super::{
        ENDED_MAX, LinkRate, REQUESTS_MAX, Request, ValueCost, ValueFetch, ValueFetchBroker,
    };

    fn broker() -> ValueFetchBroker {
        ValueFetchBroker::default()
    }

    #[test]
    fn a_value_costs_its_bytes_and_the_headers_of_its_datagrams() {
        let broker = broker();
        assert_eq!(broker.cost("scout", 1_000), None);
        assert!(!broker.fetch("scout", ("run".to_owned(), 7), 1_000, 2_000), "no such robot");
        let rate = LinkRate { part: 100, overhead: 20, spare_per_s: Some(600) };
        broker.set_link("scout", rate);
        let cost = ValueCost { link_bytes: 1_200, takes_ms: Some(2_000) };
        assert_eq!(broker.cost("scout", 1_000), Some(cost));
        broker.set_link("scout", LinkRate { spare_per_s: None, ..rate });
        assert_eq!(broker.cost("scout", 1_000), Some(ValueCost { takes_ms: None, ..cost }));
    }

    #[test]
    fn requests_are_for_one_robot_each_and_taken_once() {
        let broker = broker();
        let rate = LinkRate { part: 100, overhead: 20, spare_per_s: None };
        for robot in ["scout", "mule"] {
            broker.set_link(robot, rate);
        }
        let key = || ("run".to_owned(), 7);
        assert!(broker.fetch("scout", key(), 1_000, 1_250));
        assert_eq!(broker.progress("run", 7).map(|fetch| fetch.budget), Some(1_250));
        assert!(broker.take("mule").is_empty());
        let request = |budget| Request { robot: "scout".to_owned(), key: key(), budget };
        assert_eq!(broker.take("scout"), [request(Some(1_250))]);
        broker.cancel("scout", key());
        assert_eq!(broker.progress("run", 7), None);
        assert_eq!(broker.take("scout"), [request(None)]);
    }

    fn key(number: usize) -> (String, u64) {
        ("run".to_owned(), number as u64)
    }

    #[test]
    fn so_many_requests_wait_and_none_that_ends_a_fetch_is_lost() {
        let broker = broker();
        broker.set_link("scout", LinkRate { part: 100, overhead: 20, spare_per_s: None });
        let fetch = |number| broker.fetch("scout", key(number), 1_000, 1_250);
        assert!((0..REQUESTS_MAX).all(fetch));
        let before = broker.take("scout");
        assert!((0..REQUESTS_MAX).all(|number| fetch(REQUESTS_MAX + number)));
        assert!(!fetch(9_999));
        assert_eq!(broker.progress("run", 9_999), None);
        // One that the station has, and one that it has not: both are given up.
        broker.cancel("scout", key(0));
        broker.cancel("scout", key(REQUESTS_MAX));
        let ended = |number| Request { robot: "scout".to_owned(), key: key(number), budget: None };
        let requests = broker.take("scout");
        assert_eq!((before.len(), requests.len()), (REQUESTS_MAX, REQUESTS_MAX + 1));
        assert_eq!(requests[REQUESTS_MAX - 1..], [ended(0), ended(REQUESTS_MAX)]);
        assert!(fetch(9_999));
    }

    #[test]
    fn of_many_failed_fetches_the_last_is_told_and_those_under_way_stay() {
        let broker = broker();
        let progress = |failed: Option<&str>| ValueFetch {
            here: 1,
            budget: 2,
            failed: failed.map(str::to_owned),
        };
        broker.set_progress(&key(0), progress(None));
        for number in 1..ENDED_MAX {
            broker.set_progress(&key(number), progress(Some("gone")));
        }
        assert!(broker.progress("run", 1).is_some());
        broker.set_progress(&key(ENDED_MAX), progress(Some("stuck")));
        let known = [0, 1, ENDED_MAX].map(|number| broker.progress("run", number as u64));
        assert_eq!(known, [Some(progress(None)), None, Some(progress(Some("stuck")))]);
    }
}
