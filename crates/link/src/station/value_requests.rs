//! Requests of a station besides events: watched values and large values. A request is repeated until the robot confirms it.

use super::{FromRobot, StationSession};
use crate::assembly::PART_MIN;
use crate::bytes::number_length;
use crate::frame::{Fetch, Frame, StreamId, ValueFrame, ValueId, ValueName, WatchPart};
use crate::payload_writer::PayloadWriter;
use crate::range_set::RangeSet;
use crate::robot::WATCH_BYTES_MAX;
use crate::session_time::SessionTime;
use std::collections::{BTreeMap, VecDeque};
use std::ops::RangeInclusive;
use std::time::Duration;

/// Capacity in requests for large values.
const FETCHES_MAX: usize = 8;
/// Number of times that the end of a request is sent.
const END_SENDS: u8 = 4;
/// Capacity of a large value in received ranges. Bytes that would add a range are received again.
const RANGES_HERE_MAX: usize = 4_096;
/// Sends of a request before the interval grows. The robot may not know the run or not receive anything.
const ROUNDS_SOON: u32 = 6;

/// Reason why a request is not sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "what is watched has {0} bytes, and at most {1} fit: watch less, or whole states instead of their values"
)]
pub struct NotWatched(usize, u32);

/// Progress of a large value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FetchProgress<'s> {
    /// Which bytes of it are here; the first one is 1.
    pub here: &'s RangeSet,
    /// Bytes that may still be sent.
    pub budget: u64,
}

#[derive(Debug, Default)]
pub(super) struct ValueRequests {
    watches: BTreeMap<StreamId, Watch>,
    fetches: BTreeMap<ValueId, Fetching>,
    /// Ended requests for large values, with the number of remaining announcements.
    ended: VecDeque<(ValueName, u8)>,
    /// The fetch that is named first in the next report.
    turn: usize,
}

#[derive(Debug)]
struct Watch {
    number: u64,
    body: Vec<u8>,
    /// Progress in this round.
    sent: usize,
    due: SessionTime,
    /// Number of complete rounds.
    rounds: u32,
    is_confirmed: bool,
}

#[derive(Debug)]
struct Fetching {
    value: ValueName,
    length: u64,
    here: RangeSet,
    budget: u64,
}

impl ValueRequests {
    /// Drops the watch of a run.
    pub(super) fn forget(&mut self, stream: StreamId) {
        self.watches.remove(&stream);
    }

    /// The robot has started again: it may know of nothing.
    pub(super) fn repeat(&mut self) {
        for watch in self.watches.values_mut() {
            (watch.sent, watch.due, watch.rounds) = (0, SessionTime::BEGIN, 0);
            watch.is_confirmed = false;
        }
    }

    /// Applies an answer of the robot.
    pub(super) fn answered(
        &mut self,
        frame: &ValueFrame<'_>,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        match frame {
            ValueFrame::Watched(watched) => {
                let Some(watch) = self.watches.get_mut(&watched.stream) else { return };
                watch.is_confirmed |= watch.number == watched.number;
                let (stream, number) = (watched.stream, watched.number);
                if let Some(values) = watched.values() {
                    show(FromRobot::Watched { stream, number, values });
                }
            }
            ValueFrame::ValuePart(part) => {
                let (id, offset, bytes) = (part.id, part.offset, part.bytes);
                let Some(fetching) = self.fetches.get_mut(&id) else { return };
                let (length, end) = (bytes.len() as u64, offset + bytes.len() as u64);
                let range = offset + 1..=end;
                let is_far = fetching.here.ranges_count() >= RANGES_HERE_MAX
                    && fetching.here.end_at(offset).is_none();
                if end > fetching.length || is_far || fetching.here.contains(&range) {
                    return;
                }
                fetching.here.insert(range);
                fetching.budget = fetching.budget.saturating_sub(length);
                show(FromRobot::ValuePart { id, offset, bytes });
            }
            ValueFrame::NoValue(id, why) => {
                if self.fetches.contains_key(id) {
                    show(FromRobot::NoValue { id: *id, why: *why });
                }
            }
            ValueFrame::Fetch(_) | ValueFrame::Watch(_) => {}
        }
    }

    /// When a part of what is watched is to be sent.
    pub(super) fn due_at(&self) -> Option<SessionTime> {
        let open = self.watches.values().filter(|watch| !watch.is_confirmed);
        open.map(|watch| watch.due).min()
    }

    /// Repeats the requests for large values, with the received bytes.
    pub(super) fn write_fetches(&mut self, payload: &mut PayloadWriter) {
        for _ in 0..self.ended.len() {
            let Some((value, sends)) = self.ended.pop_front() else { break };
            let fetch = Fetch { value, budget: 0, here: RangeSet::default() };
            if !payload.try_frame(&Frame::Value(ValueFrame::Fetch(fetch))) {
                self.ended.push_front((value, sends));
                return;
            }
            if sends > 1 {
                self.ended.push_back((value, sends - 1));
            }
        }
        let (count, turn) = (self.fetches.len(), self.turn);
        let fetches = self.fetches.values().cycle().skip(turn).take(count);
        for Fetching { value, here, budget, .. } in fetches {
            let fetch = Fetch { value: *value, budget: *budget, here: here.clone() };
            if !payload.try_frame(&Frame::Value(ValueFrame::Fetch(fetch))) {
                return;
            }
            self.turn = (self.turn + 1) % count;
        }
    }

    /// Sends what is watched, until the robot has it. `answer` is how long an answer takes.
    pub(super) fn write_watches(
        &mut self,
        now: SessionTime,
        answer: Duration,
        payload: &mut PayloadWriter,
    ) {
        for (stream, watch) in &mut self.watches {
            if watch.is_confirmed || watch.due > now {
                continue;
            }
            let head = 1 + 5 + number_length(watch.number) + 3 * 3;
            let rest = watch.body.get(watch.sent..).unwrap_or_default();
            let Some(left) = payload.left().checked_sub(head) else { return };
            if left < rest.len().min(PART_MIN) {
                return;
            }
            let bytes = &rest[..rest.len().min(left)];
            let small = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
            let (length, offset) = (small(watch.body.len()), small(watch.sent));
            let (stream, number) = (*stream, watch.number);
            let part = WatchPart { stream, number, length, offset, bytes };
            payload.fitting_frame(&Frame::Value(ValueFrame::Watch(part)));
            watch.sent += bytes.len();
            if watch.sent >= watch.body.len() {
                let wait = answer * (2 << watch.rounds.saturating_sub(ROUNDS_SOON).min(2));
                (watch.sent, watch.due, watch.rounds) = (0, now + wait, watch.rounds + 1);
            }
        }
    }
}

impl StationSession {
    /// Sets the watched values of a run, in the encoding of the servers. Empty ends the watch. The numbers of lists grow over
    /// all starts of the station.
    pub fn watch(
        &mut self,
        stream: StreamId,
        number: u64,
        body: Vec<u8>,
    ) -> Result<(), NotWatched> {
        if body.len() > WATCH_BYTES_MAX as usize {
            return Err(NotWatched(body.len(), WATCH_BYTES_MAX));
        }
        let (sent, due, rounds, is_confirmed) = (0, SessionTime::BEGIN, 0, false);
        let watch = Watch { number, body, sent, due, rounds, is_confirmed };
        self.value_requests.watches.insert(stream, watch);
        Ok(())
    }

    /// True if the robot has the list of a run. `None` if no list was sent.
    pub fn is_watch_confirmed(&self, stream: StreamId) -> Option<bool> {
        self.value_requests.watches.get(&stream).map(|watch| watch.is_confirmed)
    }

    /// Drops the watch of a run without notice to the robot.
    pub fn end_watch(&mut self, stream: StreamId) {
        self.value_requests.forget(stream);
    }

    /// Requests a large value until it is complete or the request ends. `here` has the received bytes, and at most `budget`
    /// bytes are sent. Returns false if the table of requests is full.
    pub fn fetch(&mut self, value: ValueName, length: u64, here: RangeSet, budget: u64) -> bool {
        let is_room = self.value_requests.fetches.len() < FETCHES_MAX;
        if is_room || self.value_requests.fetches.contains_key(&value.id) {
            self.value_requests.ended.retain(|(ended, _)| *ended != value);
            self.value_requests.fetches.insert(value.id, Fetching { value, length, here, budget });
            self.has_news = true;
        }
        is_room
    }

    /// Ends the request for a large value.
    pub fn end_fetch(&mut self, id: ValueId) {
        if let Some(Fetching { value, .. }) = self.value_requests.fetches.remove(&id) {
            self.value_requests.ended.push_back((value, END_SENDS));
            self.value_requests.ended.truncate(FETCHES_MAX);
            self.has_news = true;
        }
        self.value_requests.turn = 0;
    }

    /// These bytes of a large value could not be kept: they have to come again.
    pub fn lose_value(&mut self, id: ValueId, bytes: RangeInclusive<u64>) {
        if let Some(fetching) = self.value_requests.fetches.get_mut(&id) {
            fetching.here.remove(bytes);
        }
    }

    /// Progress of a large value. `None` without a request.
    pub fn fetch_progress(&self, id: ValueId) -> Option<FetchProgress<'_>> {
        let Fetching { here, budget, .. } = self.value_requests.fetches.get(&id)?;
        Some(FetchProgress { here, budget: *budget })
    }
}
