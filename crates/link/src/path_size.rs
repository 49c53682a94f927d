//! Length of datagrams that the path carries. Some paths drop longer ones without a word.

use crate::profile::CARRIER_OVERHEAD;
use crate::session_time::{SessionTime, millis};
use std::collections::VecDeque;
use std::time::Duration;

/// Lengths that are tried one after the other, in bytes.
const LENGTHS: [usize; 6] = [1_200, 1_000, 800, 600, 500, LENGTH_MIN];
/// Every path carries datagrams of this length.
pub(crate) const LENGTH_MIN: usize = 400;
/// Lost datagrams that show that they were too long. Chance loses fewer in a row.
const LOST: usize = 16;
/// If fewer short bytes arrive than one in this many, the link was cut.
const ARRIVED_PART: u64 = 2;
/// Interval of the notes of long datagrams.
const NOTE_EVERY: u64 = 10;
/// Capacity for these notes.
const NOTES_MAX: usize = 1_024;
/// One in this many datagrams is short while the peer sends no reports: perhaps no longer one arrives.
const SHORT_TURN: u64 = 5;
/// The peer reports the longest datagram of at least this time.
pub(crate) const RECENT: Duration = Duration::from_secs(10);
/// Interval after which the length of the profile is tried again: routes change.
const RETRY_EVERY: Duration = Duration::from_mins(10);

/// Limit of the length of sent datagrams.
#[derive(Debug)]
pub(crate) struct PathSize {
    profile_max: usize,
    max: usize,
    /// Long datagrams that no report covers yet.
    sent: VecDeque<Note>,
    /// Bytes of the short datagrams sent.
    short_bytes: u64,
    /// Short and arrived bytes at the last report that covered a long datagram.
    reported: (u64, u64),
    /// Lengths of lost datagrams since one of at least their length arrived.
    lost: Vec<usize>,
    /// When the length of the profile is tried again. `None` while it is in use.
    retry_at: Option<SessionTime>,
    /// Datagrams that were sent without reports.
    unheard: u64,
}

/// A long datagram that was sent.
#[derive(Debug)]
struct Note {
    at_ms: u64,
    length: usize,
    /// Bytes of the short datagrams before it.
    short_bytes: u64,
}

impl PathSize {
    pub(crate) fn new(profile_max: usize) -> Self {
        Self {
            profile_max,
            max: profile_max,
            sent: VecDeque::new(),
            short_bytes: 0,
            reported: (0, 0),
            lost: Vec::new(),
            retry_at: None,
            unheard: 0,
        }
    }

    /// Limit of datagrams in bytes.
    pub(crate) fn max(&self) -> usize {
        self.max
    }

    /// Limit of the next datagram in bytes. `is_heard` if the peer sends reports.
    pub(crate) fn next_max(&mut self, is_heard: bool) -> usize {
        self.unheard = if is_heard { 0 } else { self.unheard + 1 };
        let is_short = !is_heard && self.unheard.is_multiple_of(SHORT_TURN);
        if is_short { self.max.min(LENGTH_MIN) } else { self.max }
    }

    /// The limit, if it is lower than that of the profile.
    pub(crate) fn shortened(&self) -> Option<usize> {
        (self.max < self.profile_max).then_some(self.max)
    }

    /// Counts a sent datagram.
    pub(crate) fn sent(&mut self, now: SessionTime, length: usize) {
        let at_ms = now.as_millis();
        let is_due = self.sent.back().is_none_or(|last| at_ms >= last.at_ms + NOTE_EVERY);
        if length <= LENGTH_MIN {
            self.short_bytes += (length + CARRIER_OVERHEAD) as u64;
        } else if is_due {
            self.sent.push_back(Note { at_ms, length, short_bytes: self.short_bytes });
            if self.sent.len() > NOTES_MAX {
                self.sent.pop_front();
            }
        }
        if self.retry_at.is_some_and(|at| now >= at) {
            (self.max, self.retry_at) = (self.profile_max, None);
            self.sent.clear();
            self.lost.clear();
        }
    }

    /// Applies a report: the longest datagram that the peer has received lately, all bytes that it has received, and the time of the
    /// newest one that was not overtaken. Returns whether the limit has become lower.
    pub(crate) fn report(
        &mut self,
        now: SessionTime,
        longest: usize,
        arrived: u64,
        newest_ms: u64,
    ) -> bool {
        let oldest_ms = newest_ms.saturating_sub(millis(RECENT));
        self.lost.retain(|length| *length > longest);
        let covered = self.sent.partition_point(|note| note.at_ms <= newest_ms);
        let Some(short_bytes) = self.sent.range(..covered).next_back().map(|it| it.short_bytes)
        else {
            return false;
        };
        let (short_before, arrived_before) = self.reported;
        self.reported = (short_bytes, arrived);
        // In a cut short datagrams are lost, too.
        let is_cut =
            arrived.saturating_sub(arrived_before) < (short_bytes - short_before) / ARRIVED_PART;
        for note in self.sent.drain(..covered) {
            // The report does not cover earlier ones.
            if !is_cut && note.at_ms >= oldest_ms && note.length > longest {
                self.lost.push(note.length);
            }
        }
        if self.lost.len() < LOST {
            return false;
        }
        let shortest = self.lost.iter().copied().min().unwrap_or(usize::MAX);
        let fits = |length: &usize| *length < shortest.min(self.max);
        let Some(max) = LENGTHS.into_iter().find(fits) else { return false };
        (self.max, self.retry_at) = (max, Some(now + RETRY_EVERY));
        self.sent.clear();
        self.lost.clear();
        true
    }
}

/// The longest of the datagrams that arrived lately.
#[derive(Debug, Default)]
pub(crate) struct LongestReceived {
    present: usize,
    before: usize,
    until: SessionTime,
}

impl LongestReceived {
    pub(crate) fn add(&mut self, now: SessionTime, length: usize) {
        if now >= self.until {
            let is_recent = now < self.until + RECENT;
            self.before = if is_recent { self.present } else { 0 };
            (self.present, self.until) = (0, now + RECENT);
        }
        self.present = self.present.max(length);
    }

    /// Length in bytes.
    pub(crate) fn get(&self) -> usize {
        self.present.max(self.before)
    }
}

#[cfg(test)]
mod tests {
    use super::{CARRIER_OVERHEAD, LENGTHS, LOST, LongestReceived, NOTES_MAX, PathSize};
    use crate::session_time::SessionTime;
    use std::time::Duration;

    const fn ms(ms: u64) -> SessionTime {
        SessionTime::from_millis(ms)
    }

    /// Limits that follow from reports of a path that drops what is longer than this.
    fn limits(carries: usize) -> Vec<usize> {
        let (mut path, mut received) = (PathSize::new(1_200), LongestReceived::default());
        let (mut limits, mut arrived) = (vec![path.max()], 0);
        for at in (0..60_000).step_by(10) {
            for length in [path.max(), 90] {
                path.sent(ms(at), length);
                if length <= carries {
                    received.add(ms(at), length);
                    arrived += (length + CARRIER_OVERHEAD) as u64;
                }
            }
            if path.report(ms(at), received.get(), arrived, at) {
                limits.push(path.max());
            }
        }
        limits
    }

    #[test]
    fn datagrams_become_shorter_until_the_path_carries_them() {
        assert_eq!(limits(1_200), [1_200]);
        assert_eq!(limits(650), [1_200, 1_000, 800, 600]);
        assert_eq!(limits(400), LENGTHS);
        // Shorter ones carry nothing.
        assert_eq!(limits(300), LENGTHS);
    }

    #[test]
    fn few_losses_shorten_nothing_and_later_the_whole_length_is_tried_again() {
        let mut path = PathSize::new(1_200);
        let lost = |path: &mut PathSize, count: usize| {
            (0..count).for_each(|nth| path.sent(ms(nth as u64 * 10), 1_200));
            path.report(ms(1_000), 600, 0, 1_000)
        };
        assert!(!lost(&mut path, LOST - 1));
        assert!(lost(&mut path, LOST));
        assert_eq!(path.shortened(), Some(1_000));
        path.sent(SessionTime::after(Duration::from_mins(11)), 90);
        assert_eq!(path.shortened(), None);
    }

    /// The first report after a cut covers the end of the cut, and the station has received no long datagram lately.
    #[test]
    fn a_cut_shortens_nothing() {
        let mut path = PathSize::new(1_200);
        for at in (0..60_000).step_by(50) {
            path.sent(ms(at), 1_200);
            path.sent(ms(at), 400);
        }
        assert!(!path.report(ms(62_000), 400, 428, 60_000));
        path.sent(ms(63_000), 1_200);
        assert!(!path.report(ms(65_000), 400, 428, 63_000));
    }

    /// A path that drops long datagrams, of which one is sent each half minute, as of a single long event.
    #[test]
    fn rare_losses_count_until_a_datagram_of_their_length_arrives() {
        let mut path = PathSize::new(1_200);
        let mut send = |nth: u64, length: usize, longest: usize| {
            let at = nth * 30_000;
            path.sent(ms(at), length);
            path.report(ms(at + 2_000), longest, 0, at + 1_000)
        };
        let most = LOST as u64;
        assert!((0..most - 1).all(|nth| !send(nth, 900, 600)));
        assert!(!send(most, 700, 900), "one of the length arrived");
        assert!((most + 1..2 * most).all(|nth| !send(nth, 900, 600)));
        assert!(send(2 * most, 900, 600));
        assert_eq!(path.shortened(), Some(800));
    }

    #[test]
    fn notes_are_kept_up_to_the_bound() {
        let mut path = PathSize::new(1_200);
        (0..=NOTES_MAX as u64).for_each(|nth| path.sent(ms(nth * 10), 1_200));
        assert_eq!((path.sent.len(), path.sent[0].at_ms), (NOTES_MAX, 10));
        // Datagrams before the first note are unknown.
        assert!(!path.report(ms(20_000), 600, 0, 0));
    }
}
