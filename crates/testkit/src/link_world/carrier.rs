//! A carrier of datagrams with configurable faults: delay, loss, duplication, reordering, a limited rate, and cuts.

use crate::random::Random;
use std::collections::BTreeMap;
use std::time::Duration;

/// One-way delay of the link.
pub(super) const DELAY: Duration = Duration::from_secs(2);

/// Faults of a carrier.
#[derive(Debug, Clone)]
pub struct Conditions {
    /// One-way delay, without the addition of `late`.
    pub delay: Duration,
    /// Rate, including the headers of IP and UDP.
    pub bits_per_s: u64,
    /// Percentage of datagrams that are lost.
    pub lost: usize,
    /// Percentage of datagrams that are duplicated.
    pub doubled: usize,
    /// Percentage of datagrams with an additional delay of at most `late_max`, so that others overtake them.
    pub late: usize,
    /// Maximum additional delay; see `late`.
    pub late_max: Duration,
    /// Datagrams that wait longer in the queue are dropped.
    pub queue_max: Duration,
    /// Percentage of datagrams in which one bit is flipped.
    pub flipped: usize,
    /// Bytes added to the length of each datagram, for headers.
    pub overhead: usize,
    /// True if all data arrives once and in order, as with TCP: only late, also after a cut. Lost data arrives a round trip
    /// later, and delays all data behind it.
    pub in_order: bool,
}

impl Conditions {
    /// A link with a delay of 2 s that loses, duplicates and delays some datagrams.
    pub fn delay_2s(bits_per_s: u64) -> Self {
        Self {
            delay: DELAY,
            bits_per_s,
            lost: 2,
            doubled: 5,
            late: 5,
            late_max: Duration::from_millis(120),
            queue_max: Duration::from_secs(2),
            flipped: 0,
            overhead: rafcon_link::CARRIER_OVERHEAD,
            in_order: false,
        }
    }
}

/// Fate of datagrams that are sent during a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    /// They are lost, except on a carrier with `in_order`.
    Drops,
    /// They arrive when the cut ends, without loss.
    Holds,
}

/// One direction of the link.
#[derive(Debug)]
pub struct Carrier {
    conditions: Conditions,
    random: Random,
    cuts: Vec<(Duration, Duration, Cut)>,
    free_at: Duration,
    on_the_way: BTreeMap<(Duration, u64), Vec<u8>>,
    count: u64,
    /// Arrival time of the last datagram, for arrival in order.
    last_at: Duration,
    /// Datagrams held until the end of an open cut.
    held: Vec<Vec<u8>>,
    /// Number of bytes sent, with the headers of IP and UDP.
    pub bytes: u64,
}

impl Carrier {
    /// A carrier without cuts. Faults are determined by the seed.
    pub fn new(conditions: Conditions, seed: u64) -> Self {
        Self {
            conditions,
            random: Random::new(seed),
            cuts: Vec::new(),
            free_at: Duration::ZERO,
            on_the_way: BTreeMap::new(),
            count: 0,
            last_at: Duration::ZERO,
            held: Vec::new(),
            bytes: 0,
        }
    }

    /// The faults for datagrams sent from now on.
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// Sets the faults for all datagrams from now on.
    pub fn set_conditions(&mut self, conditions: Conditions) {
        self.conditions = conditions;
    }

    /// Fate of datagrams that are sent now, if the carrier is cut.
    pub fn cut_at(&self, now: Duration) -> Option<Cut> {
        let cut = self.cuts.iter().find(|(from, to, _)| (*from..*to).contains(&now));
        cut.map(|(_, _, cut)| *cut)
    }

    /// Cuts the carrier from one time to another.
    pub fn cut(&mut self, from: Duration, to: Duration, cut: Cut) {
        self.cuts.push((from, to, cut));
    }

    /// Begins a cut without a known end.
    pub fn begin_cut(&mut self, now: Duration, cut: Cut) {
        self.end_cut(now);
        self.cut(now, Duration::MAX, cut);
    }

    /// Ends the open cut. Held datagrams are delivered now, in order and at the rate.
    pub fn end_cut(&mut self, now: Duration) {
        for (_, to, _) in &mut self.cuts {
            *to = now.min(*to);
        }
        for datagram in std::mem::take(&mut self.held) {
            self.bytes -= self.length(&datagram);
            self.send(now, datagram);
        }
    }

    /// Sends a datagram now.
    pub fn send(&mut self, now: Duration, mut datagram: Vec<u8>) {
        let length = self.length(&datagram);
        self.bytes += length;
        let cut = self.cuts.iter().find(|(from, to, _)| (*from..*to).contains(&now));
        let enters = match cut {
            Some((_, _, Cut::Drops)) if !self.conditions.in_order => return,
            Some((_, to, _)) if *to == Duration::MAX => return self.held.push(datagram),
            Some((_, to, _)) => *to,
            None => now,
        };
        let Conditions { delay, bits_per_s, lost, doubled, late, late_max, queue_max, .. } =
            self.conditions;
        let free_at = self.free_at.max(enters);
        if free_at > enters + queue_max && !self.conditions.in_order {
            return;
        }
        self.free_at = free_at + Duration::from_nanos(length * 8_000_000_000 / bits_per_s);
        if self.conditions.in_order {
            let repaired = if self.random.percent(lost) { 2 * delay } else { Duration::ZERO };
            self.last_at = self.last_at.max(self.free_at + delay + repaired);
            return self.carry(self.last_at, datagram);
        }
        let lateness = |random: &mut Random| {
            let is_late = random.percent(late);
            let part = u32::try_from(random.below(1_000)).unwrap_or_default();
            if is_late { late_max * part / 1_000 } else { Duration::ZERO }
        };
        let first = self.free_at + delay + lateness(&mut self.random);
        let second = self.free_at + delay + lateness(&mut self.random);
        let (is_lost, is_doubled) = (self.random.percent(lost), self.random.percent(doubled));
        // Without flipped bits no random number is used, so that old seeds give unchanged results.
        if self.conditions.flipped > 0 && self.random.percent(self.conditions.flipped) {
            let place = self.random.below(datagram.len().max(1));
            if let Some(byte) = datagram.get_mut(place) {
                *byte ^= 1 << self.random.below(8);
            }
        }
        if is_doubled {
            self.carry(second, datagram.clone());
        }
        if !is_lost {
            self.carry(first, datagram);
        }
    }

    fn carry(&mut self, at: Duration, datagram: Vec<u8>) {
        self.count += 1;
        self.on_the_way.insert((at, self.count), datagram);
    }

    /// Arrival time of the next datagram.
    pub fn next(&self) -> Option<Duration> {
        self.on_the_way.keys().next().map(|(at, _)| *at)
    }

    /// Returns the next datagram that has arrived by now.
    pub fn arrive(&mut self, now: Duration) -> Option<Vec<u8>> {
        let first = self.on_the_way.first_entry().filter(|first| first.key().0 <= now)?;
        Some(first.remove())
    }

    fn length(&self, datagram: &[u8]) -> u64 {
        (datagram.len() + self.conditions.overhead) as u64
    }
}
