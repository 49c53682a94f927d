//! Last datagrams from the other side, and the bounds of the clocks that follow from them.

use crate::frame::Frame;
use crate::path_size::LongestReceived;
use crate::profile::CARRIER_OVERHEAD;
use crate::seal::Generation;
use crate::session_time::{SessionTime, millis};
use std::time::Duration;

/// The newest time that was in a datagram of the other side.
#[derive(Debug, Default)]
pub(crate) struct Heard {
    newest: Option<Newest>,
}

#[derive(Debug)]
struct Newest {
    start: Generation,
    /// The newest packet number of that start.
    number: u64,
    at_ms: u64,
    heard_at: SessionTime,
    /// By how much overtaken datagrams were late; forgotten slowly.
    late_ms: u64,
    /// Bytes received from that start, with the headers of the carrier.
    bytes: u64,
    longest: LongestReceived,
}

impl Heard {
    /// Records a datagram of this length, with its start, number and time. Returns whether it is the first of a new start.
    pub(crate) fn hear(
        &mut self,
        (start, number): (Generation, u64),
        at_ms: u64,
        length: usize,
        now: SessionTime,
    ) -> bool {
        let bytes = (length + CARRIER_OVERHEAD) as u64;
        match &mut self.newest {
            Some(newest) if newest.start == start => {
                newest.bytes += bytes;
                newest.longest.add(now, length);
                newest.number = newest.number.max(number);
                if at_ms >= newest.at_ms {
                    newest.late_ms -= newest.late_ms / 64;
                    (newest.at_ms, newest.heard_at) = (at_ms, now);
                } else {
                    newest.late_ms = newest.late_ms.max(newest.at_ms - at_ms);
                }
                false
            }
            _ => {
                let mut longest = LongestReceived::default();
                longest.add(now, length);
                let (heard_at, late_ms) = (now, 0);
                self.newest =
                    Some(Newest { start, number, at_ms, heard_at, late_ms, bytes, longest });
                true
            }
        }
    }

    /// Time since the last datagram of the other side.
    pub(crate) fn before(&self, now: SessionTime) -> Option<Duration> {
        self.newest.as_ref().map(|newest| now.since(newest.heard_at))
    }

    /// Datagrams received from the present start of the other side.
    pub(crate) fn arrived(&self) -> Option<Frame<'static>> {
        let Newest { bytes, longest, .. } = self.newest.as_ref()?;
        Some(Frame::Arrived { bytes: *bytes, longest: longest.get() as u64 })
    }

    pub(crate) fn frame(&self, now: SessionTime) -> Option<Frame<'static>> {
        let newest = self.newest.as_ref()?;
        let held = now.since(newest.heard_at);
        Some(Frame::Heard {
            start: newest.start,
            number: newest.number,
            newest_ms: newest.at_ms,
            held_ms: millis(held),
            late_ms: newest.late_ms,
        })
    }
}

/// Between which times the clock of the robot is, as a station knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClockBounds {
    /// The start of the robot that the clock is of.
    pub start: Generation,
    /// It is at least this, in ms.
    pub earliest_ms: u64,
    /// Upper bound in ms. Unknown until the robot has received a datagram.
    pub latest_ms: Option<u64>,
}

/// Two clocks drift by at most one millisecond in this many.
const DRIFT: i32 = 5_000;

/// By how much two clocks part in this time at most, or come together.
pub(crate) fn drift(time: Duration) -> Duration {
    time / DRIFT.unsigned_abs() + Duration::from_millis(1)
}

/// The bounds of the robot's clock from datagrams in both directions: no message arrives before it was sent. A bound that is not
/// renewed widens, because no two clocks are equally fast.
#[derive(Debug, Default)]
pub(crate) struct RobotClock {
    start: Option<Generation>,
    low: Bound,
    high: Option<Bound>,
}

/// A difference robot − here, in ms, and when it was found.
#[derive(Debug, Clone, Copy, Default)]
struct Bound {
    difference: i64,
    found_ms: i64,
}

impl Bound {
    /// Largest drift of the clocks over this time.
    fn drift(self, now_ms: i64) -> i64 {
        now_ms.saturating_sub(self.found_ms).max(0) / i64::from(DRIFT) + 1
    }
}

impl RobotClock {
    /// A datagram of the robot that was sent at `at_ms`.
    pub(crate) fn receive(&mut self, start: Generation, at_ms: u64, now_ms: u64) {
        let now_ms = now_ms.cast_signed();
        let found = at_ms.cast_signed().saturating_sub(now_ms);
        if self.start != Some(start) {
            *self = Self { start: Some(start), low: Bound::default(), high: None };
        } else if found < self.lowest(now_ms) {
            return;
        }
        self.low = Bound { difference: found, found_ms: now_ms };
    }

    /// The robot received at `heard_ms` of its clock a datagram sent at `sent_ms` of this clock.
    pub(crate) fn robot_heard(&mut self, heard_ms: u64, sent_ms: u64, now_ms: u64) {
        let now_ms = now_ms.cast_signed();
        // The robot rounded both its times down.
        let difference = heard_ms.cast_signed().saturating_sub(sent_ms.cast_signed()) + 2;
        if self.highest(now_ms).is_none_or(|highest| difference <= highest) {
            self.high = Some(Bound { difference, found_ms: now_ms });
        }
    }

    fn lowest(&self, now_ms: i64) -> i64 {
        self.low.difference - self.low.drift(now_ms)
    }

    fn highest(&self, now_ms: i64) -> Option<i64> {
        self.high.map(|high| high.difference.saturating_add(high.drift(now_ms)))
    }

    pub(crate) fn bounds(&self, now_ms: u64) -> Option<ClockBounds> {
        let now_ms = now_ms.cast_signed();
        let at = |difference: i64| now_ms.saturating_add(difference).max(0).cast_unsigned();
        Some(ClockBounds {
            start: self.start?,
            earliest_ms: at(self.lowest(now_ms)),
            latest_ms: self.highest(now_ms).map(at),
        })
    }
}
