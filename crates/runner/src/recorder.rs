//! The events of a run in memory, numbered, for any number of readers. Knows what happened and when; must never know who reads,
//! and never waits for a reader.

use parking_lot::{Condvar, Mutex, MutexGuard};
use rafcon_engine::PathId;
use rafcon_model::OutcomeId;
use rafcon_protocol::Event;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

/// Events kept at most.
const EVENTS_MAX: usize = 1 << 20;
/// Text of events kept at most, in bytes.
const TEXT_BYTES_MAX: usize = 64 << 20;

/// One thing that happened. States coming and going are numbers, everything else is ready to be told.
#[derive(Debug, Clone)]
pub(crate) enum Record {
    /// A state began.
    Entered(PathId),
    /// A state ended.
    Left(PathId, OutcomeId),
    /// Anything else.
    Told(Arc<Event>),
}

impl Record {
    /// Whether it is told to viewers that want snapshots instead of every step.
    pub(crate) fn is_rare(&self) -> bool {
        matches!(self, Self::Told(_))
    }

    fn text_bytes(&self) -> usize {
        match self {
            Self::Told(event) => match &**event {
                Event::Log { message, .. } => message.len() + 128,
                _ => 256,
            },
            Self::Entered(_) | Self::Left(..) => 0,
        }
    }
}

/// A record with its number (from 1, without gaps) and its time.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// Counts from 1, without gaps.
    pub(crate) sequence: u64,
    /// Time since the start, in ns.
    pub(crate) t_ns: u64,
    /// What happened.
    pub(crate) record: Record,
}

/// What a reader gets.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Read {
    /// The number to go on with.
    pub(crate) next: u64,
    /// How many records before that were dropped because nobody had read them in time.
    pub(crate) missed: u64,
    /// Whether nothing more will ever come.
    pub(crate) closed: bool,
}

/// The bounded list of what happened.
#[derive(Debug)]
pub(crate) struct Recorder {
    ring: Mutex<Ring>,
    grown: Condvar,
    limit: usize,
}

#[derive(Debug, Default)]
struct Ring {
    entries: VecDeque<(u64, Record)>,
    dropped: u64,
    text_bytes: usize,
    sleepers: usize,
    closed: bool,
}

impl Default for Recorder {
    fn default() -> Self {
        Self::with_limit(EVENTS_MAX)
    }
}

impl Recorder {
    fn with_limit(limit: usize) -> Self {
        Self { ring: Mutex::default(), grown: Condvar::new(), limit }
    }

    /// Adds records that happened at the same time.
    pub(crate) fn push(&self, t_ns: u64, records: impl IntoIterator<Item = Record>) {
        let mut ring = self.ring.lock();
        for record in records {
            ring.push(t_ns, record, self.limit);
        }
        self.wake(&ring);
    }

    /// Nothing more will come.
    pub(crate) fn close(&self) {
        let mut ring = self.ring.lock();
        ring.closed = true;
        self.grown.notify_all();
    }

    fn wake(&self, ring: &MutexGuard<'_, Ring>) {
        if ring.sleepers > 0 {
            self.grown.notify_all();
        }
    }

    /// Copies up to `count` records from number `from` on to `into`, leaving out those that are not `wanted`.
    pub(crate) fn read(
        &self,
        from: u64,
        count: usize,
        wanted: impl Fn(&Record) -> bool,
        into: &mut Vec<Entry>,
    ) -> Read {
        let ring = self.ring.lock();
        let first = ring.dropped + 1;
        let begin = from.max(first);
        let skip = usize::try_from(begin - first).unwrap_or(usize::MAX);
        let there = ring.entries.iter().skip(skip).take(count);
        let mut next = begin;
        for (t_ns, record) in there {
            if wanted(record) {
                into.push(Entry { sequence: next, t_ns: *t_ns, record: record.clone() });
            }
            next += 1;
        }
        let exhausted = next == first + ring.entries.len() as u64;
        Read { next, missed: begin - from, closed: ring.closed && exhausted }
    }

    /// Waits until a record with number `from` is there, nothing more will come, or `deadline` has passed.
    pub(crate) fn wait(&self, from: u64, deadline: Option<Instant>) {
        let mut ring = self.ring.lock();
        ring.sleepers += 1;
        while !ring.closed && ring.dropped + (ring.entries.len() as u64) < from {
            match deadline {
                Some(deadline) => {
                    if self.grown.wait_until(&mut ring, deadline).timed_out() {
                        break;
                    }
                }
                None => self.grown.wait(&mut ring),
            }
        }
        ring.sleepers -= 1;
    }

    /// Waits until nothing more will come or `deadline` has passed; records do not wake it.
    pub(crate) fn wait_closed(&self, deadline: Instant) {
        let mut ring = self.ring.lock();
        while !ring.closed {
            if self.grown.wait_until(&mut ring, deadline).timed_out() {
                return;
            }
        }
    }
}

impl Ring {
    /// Makes room first, so that the list never grows beyond its limit.
    fn push(&mut self, t_ns: u64, record: Record, limit: usize) {
        self.text_bytes += record.text_bytes();
        while self.entries.len() >= limit || self.text_bytes > TEXT_BYTES_MAX {
            let Some((_, oldest)) = self.entries.pop_front() else { break };
            self.text_bytes -= oldest.text_bytes();
            self.dropped += 1;
        }
        self.entries.push_back((t_ns, record));
    }
}

#[cfg(test)]
mod tests {
    use super::{Record, Recorder};
    use expect_test::{Expect, expect};
    use rafcon_engine::PathId;

    fn check(pushed: u32, from: u64, count: usize, expect: &Expect) {
        let recorder = Recorder::with_limit(4);
        recorder.push(0, (0..pushed).map(|n| Record::Entered(PathId(n))));
        recorder.close();
        let mut entries = Vec::new();
        let read = recorder.read(from, count, |_| true, &mut entries);
        let numbers: Vec<u64> = entries.iter().map(|entry| entry.sequence).collect();
        expect.assert_eq(&format!("{numbers:?} {read:?}"));
    }

    #[test]
    fn a_reader_goes_on_where_it_was() {
        check(3, 1, 2, &expect!["[1, 2] Read { next: 3, missed: 0, closed: false }"]);
        check(3, 3, 2, &expect!["[3] Read { next: 4, missed: 0, closed: true }"]);
        check(3, 4, 2, &expect!["[] Read { next: 4, missed: 0, closed: true }"]);
    }

    #[test]
    fn a_slow_reader_is_told_what_it_missed() {
        check(6, 1, 9, &expect!["[3, 4, 5, 6] Read { next: 7, missed: 2, closed: true }"]);
    }

    #[test]
    fn what_a_reader_does_not_want_is_counted_all_the_same() {
        let recorder = Recorder::default();
        recorder.push(0, [Record::Entered(PathId(1)), Record::Entered(PathId(2))]);
        let mut entries = Vec::new();
        let read = recorder.read(1, 9, Record::is_rare, &mut entries);
        assert_eq!((entries.len(), read.next), (0, 3));
    }
}
