//! Measurements of a simulated world, and the figures derived from them.

#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "figures are printed with three digits"
)]

use rafcon_link::Traffic;
use std::time::Duration;

/// Measurements of one seed, or of all.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measures {
    /// Events of the robot that a replica lacks at the end.
    pub missing: u64,
    /// Events of a replica that the robot does not have.
    pub extra: u64,
    /// Events whose bytes differ.
    pub different: u64,
    /// Number of events while the link was whole, and bytes that the robot sent to one station in that time.
    pub events: u64,
    /// Bytes that belong to `events`; see there.
    pub bytes: u64,
    /// Traffic in that time by kind of frame.
    pub traffic: Traffic,
    /// Time from an event to a state at the station that includes it, minus the delay, while the link was whole.
    pub latency: Vec<Duration>,
    /// Latency without an up-link.
    pub one_way_latency: Vec<Duration>,
    /// Time from the end of a cut to a live state, minus the delay.
    pub live_after_return: Vec<Duration>,
    /// Time from the start of a station without a replica and without an up-link to a live state, minus the delay.
    pub late_joiner: Vec<Duration>,
    /// Time from the end of the long cut to a complete replica, with its limit.
    pub backfill: Vec<(Duration, Duration)>,
    /// Time from a command to its effect, minus the delay, while the link was whole.
    pub hold: Vec<Duration>,
    /// Commands executed after expiry, twice, or under an old epoch.
    pub late_or_twice: u64,
    /// Number of commands executed.
    pub commands: u64,
    /// Number of times a server was killed.
    pub kills: u64,
    /// Bits that the robot sent while the mission was quiet; the duration is `idle`.
    pub idle_bits: u64,
    /// Duration that belongs to `idle_bits`; see there.
    pub idle: Duration,
    /// Bytes between a station and the robot while one operator watched the mission, and while five did.
    pub watched: [u64; 2],
}

/// A line of the gate's table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// Name of the measure, for people.
    pub name: &'static str,
    /// Measured value, in `unit`s.
    pub value: f64,
    /// Its unit; empty for a count.
    pub unit: &'static str,
    /// Maximum allowed value, in `unit`s.
    pub bar: f64,
}

impl Measures {
    /// Adds the measurements of another seed.
    pub fn add(&mut self, other: &Self) {
        self.missing += other.missing;
        self.extra += other.extra;
        self.different += other.different;
        self.events += other.events;
        self.bytes += other.bytes;
        self.add_traffic(&other.traffic, &Traffic::default());
        self.latency.extend_from_slice(&other.latency);
        self.one_way_latency.extend_from_slice(&other.one_way_latency);
        self.live_after_return.extend_from_slice(&other.live_after_return);
        self.late_joiner.extend_from_slice(&other.late_joiner);
        self.backfill.extend_from_slice(&other.backfill);
        self.hold.extend_from_slice(&other.hold);
        self.late_or_twice += other.late_or_twice;
        self.commands += other.commands;
        self.kills += other.kills;
        self.idle_bits += other.idle_bits;
        self.idle += other.idle;
        for (sum, bytes) in self.watched.iter_mut().zip(other.watched) {
            *sum += bytes;
        }
    }

    /// Adds the traffic between two times of one session.
    pub(super) fn add_traffic(&mut self, after: &Traffic, before: &Traffic) {
        self.traffic.datagrams += after.datagrams - before.datagrams;
        self.traffic.bytes += after.bytes - before.bytes;
        for (kind, bytes) in &after.by_kind {
            let before = before.by_kind.get(kind).copied().unwrap_or_default();
            *self.traffic.by_kind.entry(*kind).or_default() += bytes - before;
        }
    }

    /// Overhead of an event in bytes: each kind of frame, and the headers.
    pub fn breakdown(&self) -> Vec<(&'static str, f64)> {
        let frames: u64 = self.traffic.by_kind.values().sum();
        let kinds = self.traffic.by_kind.iter().map(|(kind, bytes)| (*kind, *bytes));
        let headers = ("headers", self.traffic.bytes - frames);
        let all = kinds.chain([headers, ("datagrams", self.traffic.datagrams)]);
        all.map(|(kind, bytes)| (kind, ratio(bytes, self.events))).collect()
    }

    /// Lines of the gate's table, each with value and maximum.
    pub fn figures(&self) -> Vec<Figure> {
        let seconds = |name, value: Duration, bar| Figure {
            name,
            value: value.as_secs_f64(),
            unit: "s",
            bar,
        };
        let number = |name, value: f64, unit, bar| Figure { name, value, unit, bar };
        let slowest = self.backfill.iter().max_by(|(one, bar), (other, other_bar)| {
            let over = |took: &Duration, bar: &Duration| took.as_secs_f64() / bar.as_secs_f64();
            over(one, bar).total_cmp(&over(other, other_bar))
        });
        let (backfill, backfill_bar) = slowest.copied().unwrap_or_default();
        vec![
            number("replica_missing", self.missing as f64, "", 0.0),
            number("replica_extra", self.extra as f64, "", 0.0),
            number("replica_different", self.different as f64, "", 0.0),
            number("link_bytes_per_event", ratio(self.bytes, self.events), "B", 50.0),
            number(
                "link_bytes_5_over_1_operators",
                ratio(self.watched[1], self.watched[0]),
                "",
                1.02,
            ),
            seconds("live_after_return_s", quantile(&self.live_after_return, 0.99), 0.5),
            seconds("latency_p50_s", quantile(&self.latency, 0.5), 0.05),
            seconds("latency_p99_s", quantile(&self.latency, 0.99), 0.3),
            seconds("hold_effective_s", quantile(&self.hold, 0.999), 0.2),
            seconds("one_way_latency_p99_s", quantile(&self.one_way_latency, 0.99), 0.5),
            seconds("one_way_late_joiner_s", quantile(&self.late_joiner, 0.99), 10.0),
            seconds("backfill_12min_s", backfill, backfill_bar.as_secs_f64()),
            number("commands_late_or_twice", self.late_or_twice as f64, "", 0.0),
            number(
                "idle_down_bits_per_s",
                self.idle_bits as f64 / self.idle.as_secs_f64().max(1.0),
                "bit/s",
                5_000.0,
            ),
        ]
    }
}

fn ratio(over: u64, under: u64) -> f64 {
    over as f64 / under.max(1) as f64
}

/// Quantile of the values; zero if there are no values.
fn quantile(values: &[Duration], part: f64) -> Duration {
    let mut values = values.to_vec();
    values.sort_unstable();
    let last = values.len().saturating_sub(1);
    let place = (part * last as f64).ceil() as usize;
    values.get(place.min(last)).copied().unwrap_or_default()
}
