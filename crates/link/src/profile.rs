//! Properties of a link before it is measured, and the schedule of its datagrams.

use crate::session_time::SessionTime;
use std::time::Duration;

/// The properties of a link that its users set. Everything that depends on the delay is measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Profile {
    /// Its name.
    pub name: &'static str,
    /// The rate from the robot, in bits per second, with the headers of the carrier.
    pub down_bits_per_s: u64,
    /// Rate towards the robot, in bytes per second.
    pub up_bits_per_s: u64,
    /// The longest datagram from the robot, in bytes.
    pub down_bytes_max: usize,
    /// The longest datagram to the robot, in bytes: it must not hold up a stop behind it.
    pub up_bytes_max: usize,
    /// Round trip until it is measured.
    pub round_trip: Duration,
    /// Interval of the robot's status, with or without an up-link.
    pub status_every: Duration,
    /// Interval of snapshots of a run that changes.
    pub snapshot_every: Duration,
    /// New events wait for others at most this long after the datagram before.
    pub gather: Duration,
    /// New events are sent again after this time, so that one loss heals without a round trip.
    pub repeat_after: Duration,
    /// Interval of the station's reports while it receives datagrams.
    pub report_every: Duration,
    /// Data that the model coder compresses.
    pub compression: Compression,
}

/// Data that the model coder compresses. It takes some microseconds of processor time for each byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Compression {
    /// Nothing: the link carries more than the coder does.
    Nothing,
    /// New events and snapshots.
    New,
    /// New events, snapshots and back-fill.
    All,
}

const fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

impl Profile {
    /// A cable or a good wireless network.
    pub const LAN: Self = Self {
        name: "lan",
        down_bits_per_s: 50_000_000,
        up_bits_per_s: 50_000_000,
        down_bytes_max: 1_200,
        up_bytes_max: 1_200,
        round_trip: ms(200),
        status_every: ms(250),
        snapshot_every: ms(250),
        gather: ms(10),
        repeat_after: ms(40),
        report_every: ms(50),
        compression: Compression::Nothing,
    };
    /// A wireless network at the edge of its range.
    pub const WIFI: Self = Self {
        name: "wifi",
        down_bits_per_s: 4_000_000,
        up_bits_per_s: 1_000_000,
        round_trip: ms(1_000),
        snapshot_every: ms(500),
        gather: ms(40),
        repeat_after: ms(100),
        report_every: ms(200),
        compression: Compression::New,
        ..Self::LAN
    };
    /// A link to another planet as field tests imitate it: seconds of delay, little bandwidth, long blackouts.
    pub const DELAY_2S: Self = Self {
        name: "delay-2s",
        down_bits_per_s: 256_000,
        up_bits_per_s: 32_000,
        up_bytes_max: 300,
        round_trip: ms(20_000),
        status_every: ms(500),
        snapshot_every: ms(1_000),
        gather: ms(170),
        repeat_after: ms(240),
        report_every: ms(500),
        compression: Compression::All,
        ..Self::LAN
    };
    /// A link of a few kilobits per second and minutes of delay.
    pub const DEEP: Self = Self {
        name: "deep",
        down_bits_per_s: 8_000,
        up_bits_per_s: 1_000,
        down_bytes_max: 500,
        up_bytes_max: 150,
        round_trip: ms(1_200_000),
        status_every: ms(5_000),
        snapshot_every: ms(10_000),
        gather: ms(2_000),
        repeat_after: ms(4_000),
        report_every: ms(10_000),
        compression: Compression::All,
    };
    /// True if new events and snapshots are compressed.
    pub(crate) fn codes_new(&self) -> bool {
        self.compression >= Compression::New
    }

    /// The station reports at least this often while the link is whole.
    pub fn report_idle_every(&self) -> Duration {
        self.report_every * 4
    }

    /// Maximum silence of a robot in contact: eight status intervals.
    pub fn robot_silence(&self) -> Duration {
        self.status_every * 8
    }

    /// Silence after which a side assumes that it is not received. Three idle reports fit into it.
    pub fn silence(&self) -> Duration {
        self.report_idle_every() * 7 / 2
    }
}

/// Datagrams cost their carrier this much besides, in bytes: the headers of IP and UDP.
pub const CARRIER_OVERHEAD: usize = 28;

/// Schedules datagrams at a rate in bits per second.
#[derive(Debug)]
pub(crate) struct Pacer {
    bits_per_s: u64,
    free_at: SessionTime,
}

impl Pacer {
    pub(crate) fn new(bits_per_s: u64) -> Self {
        Self { bits_per_s: bits_per_s.max(1), free_at: SessionTime::BEGIN }
    }

    /// Time at which the last datagram has left.
    pub(crate) fn free_at(&self) -> SessionTime {
        self.free_at
    }

    /// Sets the rate of the following datagrams.
    pub(crate) fn set_rate(&mut self, bits_per_s: u64) {
        self.bits_per_s = bits_per_s.max(1);
    }

    /// Counts a sent datagram of this length.
    pub(crate) fn spend(&mut self, now: SessionTime, datagram: usize) {
        let bits = (datagram + CARRIER_OVERHEAD) as u64 * 8;
        let takes = Duration::from_nanos(bits.saturating_mul(1_000_000_000) / self.bits_per_s);
        self.free_at = self.free_at.max(now) + takes;
    }
}
