//! The streams of a robot. Open streams expect events; a settled one is a number.

use super::incoming::{Incoming, LAST_REPORTS};
use crate::frame::StreamId;
use crate::range_set::RangeSet;
use crate::session_time::SessionTime;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

/// Capacity of the open streams.
pub(crate) const OPEN_MAX: usize = 4_096;
/// Capacity of the settled streams. The oldest are evicted: a robot that still has one sends it again.
pub(crate) const SETTLED_MAX: usize = 1 << 20;
/// Idle time after which an open stream makes room for a new one.
const UNNAMED_MAX: Duration = Duration::from_mins(10);
/// Duration of the report that a stream was turned away.
const CROWDED_FOR: Duration = Duration::from_secs(30);
/// Settled length of a refused stream: every event counts as received.
const REFUSED: u64 = u32::MAX as u64;

/// Progress of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StreamProgress {
    /// The number of the last event that the robot named.
    pub head: u64,
    /// The last event up to which none is missing.
    pub contiguous: u64,
    /// Number of received events.
    pub count: u64,
    /// True once the robot has reported the end.
    pub is_over: bool,
    /// True if no event is expected.
    pub is_settled: bool,
}

/// A stream of which no event is expected.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settled {
    /// The events up to this one are on the disk.
    pub(super) events: u64,
    pub(super) is_over: bool,
}

/// All streams of a robot.
#[derive(Debug)]
pub(super) struct Streams {
    pub(super) open: BTreeMap<StreamId, Incoming>,
    settled: BTreeMap<StreamId, Settled>,
    /// The settled streams in the order of their settlement.
    order: VecDeque<StreamId>,
    settled_max: usize,
    /// Settled streams with a report due.
    asked: BTreeSet<StreamId>,
    turned_away_at: Option<SessionTime>,
    /// Before this, no open stream makes room.
    room_at: SessionTime,
}

impl Default for Streams {
    fn default() -> Self {
        Self {
            open: BTreeMap::new(),
            settled: BTreeMap::new(),
            order: VecDeque::new(),
            settled_max: SETTLED_MAX,
            asked: BTreeSet::new(),
            turned_away_at: None,
            room_at: SessionTime::BEGIN,
        }
    }
}

impl Streams {
    /// The open stream of this number, opened if it has room; a settled one is opened again.
    pub(super) fn incoming(&mut self, now: SessionTime, stream: StreamId) -> Option<&mut Incoming> {
        if self.open.len() >= OPEN_MAX && !self.open.contains_key(&stream) && !self.make_room(now) {
            self.turned_away_at = Some(now);
            return None;
        }
        let settled = &mut self.settled;
        let incoming = self.open.entry(stream).or_insert_with(|| {
            let before = settled.remove(&stream);
            before.map(Incoming::resumed).unwrap_or_default()
        });
        incoming.named_at = now;
        Some(incoming)
    }

    /// The open stream with events that are on the disk.
    pub(super) fn restore(&mut self, stream: StreamId, events: RangeSet) {
        self.settled.remove(&stream);
        let incoming = self.open.entry(stream).or_default();
        incoming.safe = events.contiguous();
        incoming.head = incoming.safe;
        incoming.received = events;
        incoming.reports = LAST_REPORTS;
    }

    /// Settles a stream of which the events up to this one are on the disk.
    pub(super) fn settle(&mut self, stream: StreamId, events: u64, is_over: bool) {
        let was_over = self.open.remove(&stream).is_some_and(|incoming| incoming.is_over);
        let before = self.settled.get(&stream).is_some_and(|settled| settled.is_over);
        let is_over = is_over || was_over || before;
        if self.settled.insert(stream, Settled { events, is_over }).is_none() {
            self.order.push_back(stream);
        }
        while self.order.len() > self.settled_max
            && let Some(oldest) = self.order.pop_front()
        {
            self.settled.remove(&oldest);
            self.asked.remove(&oldest);
        }
    }

    /// Refuses a stream: it is reported as complete.
    pub(super) fn refuse(&mut self, stream: StreamId) {
        self.settle(stream, REFUSED, true);
        self.asked.insert(stream);
    }

    /// True if a settled stream has this event. Then a report of it is due.
    pub(super) fn touch_settled(&mut self, stream: StreamId, last: u64) -> bool {
        let is_settled = self.settled.get(&stream).is_some_and(|settled| last <= settled.events);
        if is_settled && self.asked.len() < OPEN_MAX {
            self.asked.insert(stream);
        }
        is_settled
    }

    /// Marks a settled stream as over.
    pub(super) fn end_settled(&mut self, stream: StreamId) {
        if let Some(settled) = self.settled.get_mut(&stream) {
            settled.is_over = true;
        }
    }

    pub(super) fn forget(&mut self, stream: StreamId) {
        self.open.remove(&stream);
        self.settled.remove(&stream);
        self.asked.remove(&stream);
    }

    /// Settled streams with a report due.
    pub(super) fn asked(&self) -> Vec<(StreamId, Settled)> {
        let settled = |stream: &StreamId| Some((*stream, *self.settled.get(stream)?));
        self.asked.iter().filter_map(settled).collect()
    }

    pub(super) fn reported(&mut self, stream: StreamId) {
        self.asked.remove(&stream);
    }

    /// Settles the open streams that are complete, on the disk, and reported.
    pub(super) fn settle_complete(&mut self) {
        let is_done = |_: &StreamId, incoming: &mut Incoming| {
            incoming.is_complete() && incoming.reports == 0 && incoming.safe >= incoming.head
        };
        let done: Vec<_> = self.open.extract_if(.., is_done).collect();
        for (stream, incoming) in done {
            self.settle(stream, incoming.head, true);
        }
    }

    pub(super) fn progress(&self, stream: StreamId) -> Option<StreamProgress> {
        if let Some(incoming) = self.open.get(&stream) {
            return Some(StreamProgress {
                head: incoming.head,
                contiguous: incoming.received.contiguous(),
                count: incoming.received.count(),
                is_over: incoming.is_over,
                is_settled: false,
            });
        }
        let Settled { events, is_over } = *self.settled.get(&stream)?;
        let (head, contiguous, count) = (events, events, events);
        Some(StreamProgress { head, contiguous, count, is_over, is_settled: true })
    }

    /// True if a stream was turned away recently.
    pub(super) fn is_crowded(&self, now: SessionTime) -> bool {
        self.turned_away_at.is_some_and(|at| now.since(at) < CROWDED_FOR)
    }

    /// Settles the open stream that the robot has not named for longest, if that is long ago.
    fn make_room(&mut self, now: SessionTime) -> bool {
        if now < self.room_at {
            return false;
        }
        let oldest = self.open.iter().min_by_key(|(_, incoming)| incoming.named_at);
        let Some((stream, incoming)) = oldest else { return false };
        self.room_at = incoming.named_at + UNNAMED_MAX;
        if now < self.room_at {
            return false;
        }
        let (stream, events) = (*stream, incoming.received.contiguous().min(incoming.safe));
        self.settle(stream, events, false);
        true
    }

    #[cfg(test)]
    pub(crate) fn set_settled_max(&mut self, most: usize) {
        self.settled_max = most;
    }

    /// Numbers of open and of settled streams.
    pub(super) fn counts(&self) -> (usize, usize) {
        (self.open.len(), self.settled.len())
    }
}
