//! The newest values of data ports that the station watches. Events contain them, too: values are sent ahead only while older
//! events are pending, or without an up-link. Only the newest of each value is sent.

use super::outgoing::TransmitContext;
use crate::assembly::Assembly;
use crate::bytes::{number_length, write_bytes};
use crate::frame::{Frame, StreamId, ValueFrame, WatchPart, Watched};
use crate::payload_writer::PayloadWriter;
use crate::profile::Pacer;
use crate::profile::Profile;
use crate::session_time::SessionTime;
use std::collections::BTreeMap;

/// Longest list of watched values, in bytes.
pub(crate) const WATCH_BYTES_MAX: u32 = 16 << 10;
/// Capacity of a run, in values.
const VALUES_MAX: usize = 1_024;
/// Values take at most this part of the rate.
const RATE_PART: u64 = 8;
/// Number of times that a value is sent while the up-link works.
const SENDS: u8 = 2;
/// The same without an up-link. Later repetitions are less frequent.
const SENDS_UNHEARD: u8 = 3;
/// Interval of repetitions without reports, in status intervals.
const AGAIN_STATUSES: u32 = 20;
/// The longest value that fits into any datagram, in bytes.
pub const VALUE_BYTES_MAX: usize = 320;

/// A value that is watched, as its run has it now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewestValue {
    /// Lower ones go first.
    pub priority: u8,
    /// The event that it is of.
    pub sequence: u64,
    /// The value with its name; at most 320 bytes.
    pub bytes: Vec<u8>,
}

/// A complete list of watched values from a station.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WatchSubscription {
    /// The run.
    pub stream: StreamId,
    /// Number of the list. It grows with each list.
    pub number: u64,
    /// Watched values, in the encoding of the servers. Empty if none is watched.
    pub body: Vec<u8>,
}

/// Watched values of all runs.
#[derive(Debug)]
pub(super) struct WatchedValues {
    runs: BTreeMap<StreamId, WatchedRun>,
    pacer: Pacer,
}

#[derive(Debug, Default)]
struct WatchedRun {
    /// Number of the list in force.
    number: u64,
    parts: Assembly,
    /// The list in force is to be announced.
    is_told_due: bool,
    values: BTreeMap<u32, Sent>,
}

#[derive(Debug)]
struct Sent {
    value: NewestValue,
    sends: u8,
    due: SessionTime,
}

/// State of a run at the station: whether reports arrive, and the first event that may be missing without being in flight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Behind {
    pub(super) is_heard: bool,
    pub(super) from: Option<u64>,
}

impl Behind {
    /// True if a value of this event is sent in addition to the event.
    fn needs(self, sequence: u64) -> bool {
        !self.is_heard || self.from.is_some_and(|from| from < sequence)
    }
}

impl WatchedValues {
    pub(super) fn new(profile: &Profile) -> Self {
        let pacer = Pacer::new(profile.down_bits_per_s / RATE_PART);
        Self { runs: BTreeMap::new(), pacer }
    }

    /// Adds a part of a list. Returns the list once it is complete and new.
    pub(super) fn add_part(&mut self, part: &WatchPart<'_>) -> Option<WatchSubscription> {
        let WatchPart { stream, number, length, offset, bytes } = *part;
        if length > WATCH_BYTES_MAX {
            return None;
        }
        let run = self.runs.entry(stream).or_default();
        if number <= run.number {
            run.is_told_due |= number == run.number;
            return None;
        }
        let whole = match length {
            0 => Some(Vec::new()),
            _ => run.parts.add(number, length, offset, bytes),
        };
        let body = whole?;
        self.count(stream, number);
        Some(WatchSubscription { stream, number, body })
    }

    /// Drops the watch of a run.
    pub(super) fn forget(&mut self, stream: StreamId) {
        self.runs.remove(&stream);
    }

    /// Applies a list and drops the one before.
    pub(super) fn count(&mut self, stream: StreamId, number: u64) {
        let run = self.runs.entry(stream).or_default();
        *run = WatchedRun { number, is_told_due: true, ..WatchedRun::default() };
    }

    /// The newest of a value.
    pub(super) fn set(&mut self, stream: StreamId, key: u32, value: NewestValue) {
        let Some(run) = self.runs.get_mut(&stream) else { return };
        let is_room = run.values.len() < VALUES_MAX || run.values.contains_key(&key);
        let known = run.values.get(&key).map(|sent| &sent.value);
        if is_room && value.bytes.len() <= VALUE_BYTES_MAX && known != Some(&value) {
            run.values.insert(key, Sent { value, sends: 0, due: SessionTime::BEGIN });
        }
    }

    /// When something is due.
    pub(super) fn due_at(&self, behind: impl Fn(StreamId) -> Behind) -> Option<SessionTime> {
        let due = self.runs.iter().map(|(stream, run)| run.due_at(behind(*stream)));
        SessionTime::earliest(due).map(|at| at.max(self.pacer.free_at()))
    }

    /// Writes what is due of a run, as far as it fits.
    pub(super) fn write(
        &mut self,
        stream: StreamId,
        behind: Behind,
        turn: TransmitContext<'_>,
        payload: &mut PayloadWriter,
    ) {
        let Some(run) = self.runs.get_mut(&stream) else { return };
        let is_due = run.due_at(behind).is_some_and(|at| at <= turn.now);
        if self.pacer.free_at() > turn.now || !is_due {
            return;
        }
        let head = 1 + 5 + number_length(run.number) + 3;
        let Some(room) = payload.left().checked_sub(head) else { return };
        let values = run.take(room, behind, turn);
        if values.is_empty() && !run.is_told_due {
            return;
        }
        run.is_told_due = false;
        let before = payload.len();
        let number = run.number;
        payload.fitting_frame(&Frame::Value(ValueFrame::Watched(Watched {
            stream,
            number,
            values: &values,
        })));
        self.pacer.spend(turn.now, payload.len() - before);
    }
}

impl WatchedRun {
    fn due_at(&self, behind: Behind) -> Option<SessionTime> {
        let due = self.values.values().filter(|sent| sent.is_open(behind)).map(|sent| sent.due);
        if self.is_told_due { Some(SessionTime::BEGIN) } else { due.min() }
    }

    /// Due values that fit, in order of priority.
    fn take(&mut self, room: usize, behind: Behind, turn: TransmitContext<'_>) -> Vec<u8> {
        let TransmitContext { now, profile, .. } = turn;
        let is_due = |sent: &&mut Sent| sent.is_open(behind) && sent.due <= now;
        let mut due: Vec<_> = self.values.values_mut().filter(is_due).collect();
        due.sort_by_key(|sent| (sent.value.priority, sent.sends, sent.due, sent.value.sequence));
        let mut values = Vec::new();
        for sent in due {
            let length = sent.value.bytes.len();
            if values.len() + number_length(length as u64) + length > room {
                break;
            }
            write_bytes(&sent.value.bytes, &mut values);
            sent.sends = sent.sends.saturating_add(1);
            let is_again = !behind.is_heard && sent.sends >= SENDS_UNHEARD;
            let wait = profile.status_every * AGAIN_STATUSES;
            sent.due = now + if is_again { wait } else { profile.repeat_after };
        }
        values
    }
}

impl Sent {
    fn is_open(&self, behind: Behind) -> bool {
        behind.needs(self.value.sequence) && (!behind.is_heard || self.sends < SENDS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RUN: StreamId = StreamId(1);

    fn value(bytes: usize) -> NewestValue {
        NewestValue { priority: 0, sequence: 1, bytes: vec![7; bytes] }
    }

    /// Which of these values are kept.
    fn kept(watched: &WatchedValues, keys: [u32; 3]) -> [Option<usize>; 3] {
        let values = &watched.runs[&RUN].values;
        keys.map(|key| values.get(&key).map(|sent| sent.value.bytes.len()))
    }

    #[test]
    fn values_are_kept_up_to_the_bound_until_another_wish_counts() {
        let mut watched = WatchedValues::new(&Profile::LAN);
        watched.count(RUN, 1);
        let most = u32::try_from(VALUES_MAX).unwrap();
        (0..=most).for_each(|key| watched.set(RUN, key, value(1)));
        assert_eq!(kept(&watched, [0, most - 1, most]), [Some(1), Some(1), None]);
        watched.set(RUN, 0, value(2));
        assert_eq!(kept(&watched, [0, 1, most]), [Some(2), Some(1), None]);
        watched.count(RUN, 2);
        watched.set(RUN, most, value(1));
        assert_eq!(kept(&watched, [0, 1, most]), [None, None, Some(1)]);
    }

    #[test]
    fn a_value_that_is_too_long_does_not_go_ahead_and_a_shorter_one_does() {
        let mut watched = WatchedValues::new(&Profile::LAN);
        watched.count(RUN, 1);
        watched.set(RUN, 0, value(VALUE_BYTES_MAX));
        watched.set(RUN, 1, value(VALUE_BYTES_MAX + 1));
        assert_eq!(kept(&watched, [0, 1, 2]), [Some(320), None, None]);
        watched.set(RUN, 1, value(3));
        assert_eq!(kept(&watched, [0, 1, 2]), [Some(320), Some(3), None]);
    }

    #[test]
    fn a_wish_that_is_too_long_is_ignored_and_the_next_one_counts() {
        let mut watched = WatchedValues::new(&Profile::LAN);
        let bytes = vec![7; WATCH_BYTES_MAX as usize + 1];
        let mut add = |number, length: u32| {
            let bytes = &bytes[..length as usize];
            let part = WatchPart { stream: RUN, number, length, offset: 0, bytes };
            watched.add_part(&part).map(|subscription| subscription.body.len())
        };
        assert_eq!(add(1, WATCH_BYTES_MAX + 1), None);
        assert_eq!(add(1, WATCH_BYTES_MAX), Some(16_384));
        assert_eq!(add(2, 3), Some(3));
    }
}
