//! A carrier of datagrams as bad as a scenario wants it: late, lost, doubled, overtaken, at a rate, and cut.

use crate::random::Random;
use std::collections::BTreeMap;
use std::time::Duration;

/// How long each way takes.
pub(super) const DELAY: Duration = Duration::from_secs(2);

/// What a carrier does to datagrams.
#[derive(Debug, Clone)]
pub struct Conditions {
    /// How long the way takes.
    pub delay: Duration,
    /// The rate, with the headers of IP and UDP.
    pub bits_per_s: u64,
    /// So many of a hundred are lost.
    pub lost: usize,
    /// So many of a hundred come twice.
    pub doubled: usize,
    /// So many of a hundred are late by at most `late_max`, and others overtake them.
    pub late: usize,
    /// See `late`.
    pub late_max: Duration,
    /// What waits longer for its turn is dropped.
    pub queue_max: Duration,
    /// Of so many of a hundred, one bit is another when they arrive.
    pub flipped: usize,
    /// So many bytes are added to the length of what is sent: headers that are not part of it.
    pub overhead: usize,
    /// Whether all of it arrives once and in its order, as what TCP has repaired: late at worst, also after a cut. What is lost comes
    /// a round trip later, and all behind it waits.
    pub in_order: bool,
}

impl Conditions {
    /// A link over 2 s that loses some datagrams, doubles some and delays some more.
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

/// What becomes of datagrams that are sent while the carrier is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    /// They are gone.
    Drops,
    /// They come when the cut is over, as if nothing had been.
    Holds,
}

/// One direction.
#[derive(Debug)]
pub struct Carrier {
    conditions: Conditions,
    random: Random,
    cuts: Vec<(Duration, Duration, Cut)>,
    free_at: Duration,
    on_the_way: BTreeMap<(Duration, u64), Vec<u8>>,
    count: u64,
    /// When the last of it arrives, if it arrives in order.
    last_at: Duration,
    /// Until a cut ends whose end is not known.
    held: Vec<Vec<u8>>,
    /// All that was sent, with the headers of IP and UDP.
    pub bytes: u64,
}

impl Carrier {
    /// A carrier that is whole. Chance follows the seed.
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

    /// What it does to datagrams.
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// From now on it does this to what is sent.
    pub fn set_conditions(&mut self, conditions: Conditions) {
        self.conditions = conditions;
    }

    /// What becomes of what is sent now, if it is cut.
    pub fn cut_at(&self, now: Duration) -> Option<Cut> {
        let cut = self.cuts.iter().find(|(from, to, _)| (*from..*to).contains(&now));
        cut.map(|(_, _, cut)| *cut)
    }

    /// Cuts it from one time to another.
    pub fn cut(&mut self, from: Duration, to: Duration, cut: Cut) {
        self.cuts.push((from, to, cut));
    }

    /// Cuts it from now on.
    pub fn begin_cut(&mut self, now: Duration, cut: Cut) {
        self.end_cut(now);
        self.cut(now, Duration::MAX, cut);
    }

    /// Ends the cut that was begun. What was held comes now, in its order and at the rate.
    pub fn end_cut(&mut self, now: Duration) {
        for (_, to, _) in &mut self.cuts {
            *to = now.min(*to);
        }
        for datagram in std::mem::take(&mut self.held) {
            self.bytes -= self.length(&datagram);
            self.send(now, datagram);
        }
    }

    /// Takes a datagram that is sent now.
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
        // Worlds without flipped bits have the same chance as ever.
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

    /// When the next datagram arrives.
    pub fn next(&self) -> Option<Duration> {
        self.on_the_way.keys().next().map(|(at, _)| *at)
    }

    /// The next datagram that has arrived by now.
    pub fn arrive(&mut self, now: Duration) -> Option<Vec<u8>> {
        let first = self.on_the_way.first_entry().filter(|first| first.key().0 <= now)?;
        Some(first.remove())
    }

    fn length(&self, datagram: &[u8]) -> u64 {
        (datagram.len() + self.conditions.overhead) as u64
    }
}
