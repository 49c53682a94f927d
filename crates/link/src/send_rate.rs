//! Measured send rate: the delay that reports of the receiver show is kept short, so that new data does not wait in a queue of the link
//! behind older data.

use crate::loss_rate::LossRate;
use crate::profile::{CARRIER_OVERHEAD, Profile};
use crate::session_time::{SessionTime, millis};
use std::collections::VecDeque;
use std::time::Duration;

/// Queue of the link from which it is congested, in ms, besides two long datagrams.
const CONGESTED_MS: u64 = 300;
/// Queue below which the link has room, in ms, besides a long datagram.
const FREE_MS: u64 = 150;
/// A longer queue counts as one of an hour.
const HOUR_MS: u64 = 3_600_000;
/// Time in which a queue of the link is to become empty, in ms.
const DRAIN_MS: u64 = 3_000;
/// Shortest interval over which the arrival rate is measured, in ms.
const MEASURED_MS: u64 = 1_000;
/// Percentage of the capacity that is used.
const USED: u64 = 95;
/// Percentages of the capacity that are used while a queue becomes empty, at least and at most.
const USED_DRAINING: (u64, u64) = (25, 90);
/// Growth of the rate in percent at the first probe for more capacity after a congestion; each probe that finds room adds as much.
const GROWTH: u64 = 8;
/// Largest growth at a probe of the rate, in percent.
const FASTEST_GROWTH: u64 = 25;
/// The rate begins at this fraction of the configured one, and doubles at each report that shows no queue.
const BEGIN: u64 = 4;
/// Interval of these probes, unless a round trip takes longer.
const PROBE_EVERY: Duration = Duration::from_secs(5);
/// The rate is at least this fraction of the configured one.
const FLOOR: u64 = 64;
/// The shortest delay is that of the last one to two intervals of this length, because routes change and clocks drift.
const DELAY_EVERY: Duration = Duration::from_mins(1);

/// Percentage of the rate from which the sender counts as limited by it.
const LIMITED: u64 = 80;
/// A sender that is not limited congests the link if it is congested in this many measurements in a row: single datagrams are late.
const CONGESTED_MEASURES: u32 = 3;
/// Interval and number of the notes of what was sent: the round trip of any link but the slowest.
const SENT_EVERY_MS: u64 = 100;
const SENT_MAX: usize = 1_024;

/// Datagrams that have arrived, by a report.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrivals {
    /// Bytes that arrived from this start.
    pub(crate) bytes: u64,
    /// Time of the report by the receiver's clock in ms.
    pub(crate) at_ms: u64,
    /// Time of the newest datagram by this side's clock in ms.
    pub(crate) newest_ms: u64,
    /// Arrival of that datagram by the receiver's clock in ms.
    pub(crate) arrived_ms: u64,
}

impl Arrivals {
    /// Delay of the newest datagram plus the unknown difference of the clocks.
    fn delay(self) -> i64 {
        self.arrived_ms.cast_signed().saturating_sub(self.newest_ms.cast_signed())
    }
}

/// Rate in bits per second that follows from reports. Without reports it stays as it is.
#[derive(Debug)]
pub(crate) struct SendRate {
    configured: u64,
    current: u64,
    /// Between reports that are further apart, in ms, the link was cut.
    cut_ms: u64,
    /// Time that the longest datagram needs at the configured rate, in ms.
    datagram_ms: u64,
    /// Time of the last change of the rate.
    changed: SessionTime,
    /// True until the first congestion, or until the configured rate is reached.
    is_beginning: bool,
    /// Measured while the link was congested. `None` if the link carries the configured rate.
    capacity: Option<u64>,
    growth: u64,
    last: Option<Arrivals>,
    shortest: ShortestDelay,
    congestion: Option<Congestion>,
    /// Measurements in a row that show a queue.
    congested: u32,
    probe_at: SessionTime,
    /// Sent bytes up to some times in ms.
    sent: VecDeque<(u64, u64)>,
    sent_bytes: u64,
    loss: LossRate,
}

/// A time during which the link has a queue.
#[derive(Debug)]
struct Congestion {
    began: SessionTime,
    /// Longest queue in ms.
    queue_ms: u64,
    /// Highest arrival rate. A cut lowers the rate of some measurements.
    arrived: u64,
}

impl SendRate {
    /// The rate from a robot: it begins low and grows with reports.
    pub(crate) fn new(profile: &Profile) -> Self {
        let configured = profile.down_bits_per_s.max(1);
        let datagram_bits = (profile.down_bytes_max + CARRIER_OVERHEAD) as u64 * 8;
        Self {
            configured,
            current: (configured / BEGIN).max(1),
            changed: SessionTime::BEGIN,
            cut_ms: millis(profile.report_idle_every() * 4),
            datagram_ms: datagram_bits * 1_000 / configured,
            is_beginning: true,
            capacity: None,
            growth: GROWTH,
            last: None,
            shortest: ShortestDelay::default(),
            congestion: None,
            congested: 0,
            probe_at: SessionTime::BEGIN,
            sent: VecDeque::new(),
            sent_bytes: 0,
            loss: LossRate::default(),
        }
    }

    /// Counts a datagram with the headers of the carrier.
    pub(crate) fn sent(&mut self, now: SessionTime, length: usize) {
        let now_ms = now.as_millis();
        self.sent_bytes += length as u64;
        match self.sent.back_mut() {
            Some((at_ms, bytes)) if now_ms < *at_ms + SENT_EVERY_MS => *bytes = self.sent_bytes,
            _ => self.sent.push_back((now_ms, self.sent_bytes)),
        }
        if self.sent.len() > SENT_MAX {
            self.sent.pop_front();
        }
    }

    /// Bytes that were sent between two times in ms. 0 if that is not known any more.
    fn sent_between(&self, from_ms: u64, to_ms: u64) -> u64 {
        let at = |ms: u64| {
            let place = self.sent.partition_point(|(at_ms, _)| *at_ms <= ms);
            self.sent.get(place.checked_sub(1)?).map(|(_, bytes)| *bytes)
        };
        at(from_ms).zip(at(to_ms)).map_or(0, |(from, to)| to - from)
    }

    /// Number of sends by the measured losses.
    pub(crate) fn sends(&self) -> u8 {
        self.loss.sends()
    }

    pub(crate) fn bits_per_s(&self) -> u64 {
        self.current
    }

    /// No report has come for long: nothing is known of the link, so a rate that no report has confirmed yet does not grow by reports.
    pub(crate) fn unheard(&mut self) {
        if self.is_beginning {
            (self.is_beginning, self.current) = (false, self.configured);
        }
    }

    /// Applies a report. `round_trip` is the time until the next report shows the effect of a change.
    pub(crate) fn report(&mut self, now: SessionTime, arrivals: Arrivals, round_trip: Duration) {
        let Some(last) = self.last else {
            self.last = Some(arrivals);
            return;
        };
        let is_older = arrivals.newest_ms <= last.newest_ms || arrivals.bytes < last.bytes;
        let passed = arrivals.at_ms.saturating_sub(last.at_ms);
        if passed < MEASURED_MS || is_older && passed < self.cut_ms {
            return;
        }
        self.last = Some(arrivals);
        if is_older || passed > self.cut_ms {
            return;
        }
        let arrived_bytes = arrivals.bytes - last.bytes;
        let arrived = rate(arrived_bytes, passed);
        let queue = arrivals.delay().saturating_sub(self.shortest.add(now, arrivals.delay()));
        let queue_ms = u64::try_from(queue).unwrap_or_default().min(HOUR_MS);
        let sent_bytes = self.sent_between(last.newest_ms, arrivals.newest_ms);
        self.loss.add(sent_bytes, arrived_bytes);
        let sent = rate(sent_bytes, arrivals.newest_ms.saturating_sub(last.newest_ms));
        let is_limited = sent > percent(self.current, LIMITED);
        // The first queue grows fast.
        let free_ms = FREE_MS + self.datagram_ms;
        let congested_ms = CONGESTED_MS + self.datagram_ms * 2;
        let is_queue_long = queue_ms > if self.is_beginning { free_ms } else { congested_ms };
        self.congested = if is_queue_long { self.congested + 1 } else { 0 };
        let is_known = self.congestion.is_some() || is_limited;
        if is_queue_long && (is_known || self.congested >= CONGESTED_MEASURES) {
            self.congest(now, queue_ms, arrived, round_trip);
        } else if queue_ms >= free_ms {
            // The queue becomes neither long nor short.
        } else if self.is_beginning {
            self.begin(now, arrivals.newest_ms);
        } else {
            self.free(now, arrived, round_trip);
        }
    }

    /// Doubles the rate if the report shows its last change.
    fn begin(&mut self, now: SessionTime, newest_ms: u64) {
        if newest_ms >= self.changed.as_millis() {
            (self.current, self.changed) = (self.bounded(self.current.saturating_mul(2)), now);
            self.is_beginning = self.current < self.configured;
        }
    }

    fn congest(&mut self, now: SessionTime, queue_ms: u64, arrived: u64, round_trip: Duration) {
        (self.is_beginning, self.growth) = (false, GROWTH);
        let began = Congestion { began: now, queue_ms, arrived };
        let congestion = self.congestion.get_or_insert(began);
        congestion.queue_ms = congestion.queue_ms.max(queue_ms);
        congestion.arrived = congestion.arrived.max(arrived);
        let drained = Duration::from_millis(congestion.queue_ms * 2 + DRAIN_MS);
        let is_falling = queue_ms * 5 <= congestion.queue_ms * 4;
        if now > congestion.began + round_trip + drained && !is_falling {
            // No queue stays this long at a lower rate: the way has become longer.
            self.shortest = ShortestDelay::default();
            self.congestion = None;
            return self.set(None);
        }
        let capacity = congestion.arrived;
        let used = 100_u64
            .saturating_sub(queue_ms * 100 / DRAIN_MS)
            .clamp(USED_DRAINING.0, USED_DRAINING.1);
        self.probe_at = now + round_trip.max(PROBE_EVERY);
        self.set(Some(capacity));
        self.current = self.bounded(percent(capacity, used));
    }

    fn free(&mut self, now: SessionTime, arrived: u64, round_trip: Duration) {
        self.congestion = None;
        let Some(capacity) = self.capacity else { return };
        let is_used = arrived > percent(self.current, LIMITED);
        if now < self.probe_at || !is_used {
            return self.set(Some(capacity));
        }
        self.probe_at = now + round_trip.max(PROBE_EVERY);
        let known = capacity.min(arrived.saturating_mul(100) / USED);
        self.set(Some(percent(known, 100 + self.growth)));
        self.growth = (self.growth + GROWTH).min(FASTEST_GROWTH);
    }

    fn set(&mut self, capacity: Option<u64>) {
        self.capacity = capacity.filter(|capacity| percent(*capacity, USED) < self.configured);
        let rate = self.capacity.map_or(self.configured, |capacity| percent(capacity, USED));
        self.current = self.bounded(rate);
    }

    fn bounded(&self, rate: u64) -> u64 {
        rate.clamp((self.configured / FLOOR).max(1), self.configured)
    }
}

/// Bits per second.
fn rate(bytes: u64, ms: u64) -> u64 {
    bytes.saturating_mul(8_000) / ms.max(1)
}

fn percent(rate: u64, percentage: u64) -> u64 {
    rate.saturating_mul(percentage) / 100
}

/// The shortest delay of the last minutes.
#[derive(Debug, Default)]
struct ShortestDelay {
    /// That of the present interval, with its end, and that of the one before.
    present: Option<(SessionTime, i64)>,
    before: Option<i64>,
}

impl ShortestDelay {
    /// Adds a delay, and returns the shortest one.
    fn add(&mut self, now: SessionTime, delay: i64) -> i64 {
        match &mut self.present {
            Some((until, shortest)) if now < *until => *shortest = delay.min(*shortest),
            present => {
                self.before = present.map(|(_, shortest)| shortest);
                *present = Some((now + DELAY_EVERY, delay));
            }
        }
        let present = self.present.map(|(_, shortest)| shortest);
        present.into_iter().chain(self.before).min().unwrap_or(delay)
    }
}

#[cfg(test)]
mod tests {
    use super::{Arrivals, SENT_MAX, SendRate};
    use crate::profile::Profile;
    use crate::session_time::SessionTime;
    use proptest::prelude::*;
    use std::time::Duration;

    proptest! {
        #[test]
        fn whatever_is_reported_the_rate_stays_between_its_bounds(
            reports in prop::collection::vec((any::<[u64; 4]>(), any::<bool>()), 1..40),
        ) {
            let mut rate = SendRate::new(&Profile::DELAY_2S);
            for (second, ([bytes, at_ms, newest_ms, arrived_ms], is_usual)) in (1..).zip(reports) {
                let now = SessionTime::after(Duration::from_secs(second));
                let (usual_ms, usual_bytes) = (second * 1_000, second * 9_000);
                let arrivals = if is_usual {
                    let (at_ms, arrived_ms) = (usual_ms, arrived_ms % 10_000);
                    Arrivals { bytes: usual_bytes, at_ms, newest_ms: usual_ms, arrived_ms }
                } else {
                    Arrivals { bytes, at_ms, newest_ms, arrived_ms }
                };
                rate.sent(now, 9_000);
                rate.report(now, arrivals, Duration::from_secs(4));
                prop_assert!((4_000..=256_000).contains(&rate.bits_per_s()));
            }
        }
    }

    #[test]
    fn what_was_sent_is_known_up_to_the_bound() {
        let mut rate = SendRate::new(&Profile::DELAY_2S);
        for nth in 0..=SENT_MAX as u64 {
            rate.sent(SessionTime::from_millis(nth * 100), 100);
        }
        assert_eq!((rate.sent.len(), rate.sent[0].0), (SENT_MAX, 100));
        // Before that, it counts as nothing.
        assert_eq!([rate.sent_between(0, 1_000), rate.sent_between(200, 1_200)], [0, 1_000]);
    }

    /// One event a second, of which some are late: the link has room, whatever arrives in a second.
    #[test]
    fn late_datagrams_of_an_idle_robot_are_no_congestion() {
        let (mut rate, mut bytes) = (SendRate::new(&Profile::DELAY_2S), 0);
        for second in 1..600_u64 {
            let newest_ms = second * 1_000;
            bytes += 150;
            rate.sent(SessionTime::from_millis(newest_ms), 150);
            let late = if second % 7 < 2 { 900 } else { 0 };
            let arrived_ms = newest_ms + 2_000 + late;
            let arrivals = Arrivals { bytes, at_ms: newest_ms + 3_000, newest_ms, arrived_ms };
            let now = SessionTime::from_millis(newest_ms + 5_000);
            rate.report(now, arrivals, Duration::from_secs(5));
        }
        assert_eq!(rate.bits_per_s(), 256_000);
    }
}
