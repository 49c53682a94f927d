//! The numbered record of a run, for any number of readers. The recorder knows what is written and what is safe to
//! send, but not who reads. It never waits for a reader.

use crate::record::blocks::{Blocks, Chunk};
use crate::record::names::Names;
use crate::record::record_encoder::RecordEncoder;
use crate::record::safety::Safety;
use crate::record::tell::reason;
use rafcon_locks::{Condvar, Mutex, MutexGuard};
use rafcon_protocol::Keeping;
use rafcon_storage::journal::{Full, Journal, Place, PlaceNumber, Record, ResumePoint};
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Limit in bytes of the encoded records in memory, for a run without a journal.
const MEMORY_BYTES: usize = 64 << 20;
/// Limit in bytes with a journal, in which readers find older records. Tests use little memory, to reach the journal.
const MEMORY_BYTES_WITH_JOURNAL: usize = if cfg!(test) { 1 << 20 } else { 16 << 20 };

/// The result of a read.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Read {
    /// The number to continue with.
    pub(crate) next: u64,
    /// Number of skipped records that are no longer in memory.
    pub(crate) missed: u64,
    /// True if no further record will follow.
    pub(crate) closed: bool,
}

/// The record of a run, in memory and in its journal.
#[derive(Debug)]
pub(crate) struct Recorder {
    names: Names,
    keeping: Keeping,
    /// The folder of the journal, if the run has one.
    folder: Option<PathBuf>,
    safety: Safety,
    inner: Mutex<RecorderInner>,
    ring: Mutex<Ring>,
    grown: Condvar,
}

/// State of the record that one writer locks at a time.
#[derive(Debug)]
struct RecorderInner {
    writer: RecordEncoder,
    /// `None` if the run keeps no journal, or has closed it.
    journal: Option<Arc<Journal>>,
}

/// State of the record that readers see.
#[derive(Debug)]
struct Ring {
    blocks: Blocks,
    /// The number before which all records are safe. Without a journal, all records count as safe.
    safe: u64,
    sleepers: usize,
    closed: bool,
}

impl Ring {
    fn new(next: u64, limit: usize, safe: u64) -> Self {
        Self { blocks: Blocks::new(next, limit), safe, sleepers: 0, closed: false }
    }

    /// The number before which all records may be sent.
    fn tellable(&self) -> u64 {
        self.blocks.next().min(self.safe)
    }
}

impl Default for Recorder {
    fn default() -> Self {
        Self::with_limit(MEMORY_BYTES)
    }
}

impl Recorder {
    /// A record in memory only.
    pub(crate) fn with_limit(limit: usize) -> Self {
        Self {
            names: Names::default(),
            keeping: Keeping::Off,
            folder: None,
            safety: Safety::default(),
            inner: Mutex::new(RecorderInner {
                writer: RecordEncoder::after(0, 0, 0),
                journal: None,
            }),
            ring: Mutex::new(Ring::new(1, limit, u64::MAX)),
            grown: Condvar::new(),
        }
    }

    /// A record with a journal, which may be that of a resumed run.
    pub(crate) fn with_journal(
        journal: Journal,
        resume_point: Option<&ResumePoint>,
        keeping: Keeping,
        strict: bool,
    ) -> Self {
        let last = journal.sequence();
        let names = Names::default();
        for (number, place) in resume_point.into_iter().flat_map(|run| &run.places) {
            names.define(0, *number, Arc::new(place.clone()));
        }
        let writer = match resume_point {
            Some(run) => RecordEncoder::after(last, run.t_ns, run.next_value.0.saturating_sub(1)),
            None => RecordEncoder::after(last, 0, 0),
        };
        Self {
            names,
            keeping,
            folder: Some(journal.folder().to_owned()),
            safety: Safety::new(last, strict),
            inner: Mutex::new(RecorderInner { writer, journal: Some(Arc::new(journal)) }),
            ring: Mutex::new(Ring::new(last + 1, MEMORY_BYTES_WITH_JOURNAL, last + 1)),
            grown: Condvar::new(),
        }
    }

    /// Definitions of the place numbers.
    pub(crate) fn names(&self) -> &Names {
        &self.names
    }

    /// Level of keeping for the run.
    pub(crate) fn keeping(&self) -> Keeping {
        self.keeping
    }

    /// Progress of the records that are safe from a power cut.
    pub(crate) fn safety(&self) -> &Safety {
        &self.safety
    }

    /// True if the record has a journal, open or closed.
    pub(crate) fn has_journal(&self) -> bool {
        self.folder.is_some()
    }

    /// The folder of the run, if it contains a journal.
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The journal of the record, until it is closed.
    pub(crate) fn journal(&self) -> Option<Arc<Journal>> {
        self.inner.lock().journal.clone()
    }

    /// Begins a group of records of one moment. They are added when the writer is dropped.
    pub(crate) fn write(&self) -> RecordWriter<'_> {
        RecordWriter { recorder: self, inner: self.inner.lock() }
    }

    /// Adds records of one moment.
    pub(crate) fn push(&self, t_ns: u64, records: impl IntoIterator<Item = Record>) {
        let mut writer = self.write();
        records.into_iter().for_each(|record| writer.note(t_ns, &record));
    }

    fn finish(&self, inner: &mut RecorderInner) {
        self.keep(inner);
        self.change(|ring| ring.blocks.push(inner.writer.encoded()));
        inner.writer.clear();
    }

    /// Appends the batch to the journal. It waits for room if necessary; the committer needs nothing that the writer
    /// holds.
    fn keep(&self, inner: &mut RecorderInner) {
        let Some(journal) = &inner.journal else { return };
        let batch = inner.writer.batch();
        let mut was_refused = false;
        let written = loop {
            let goes_on = match journal.append(batch) {
                Ok(last) => break Some(last),
                Err(Full::Recorder) => self.safety.wait_for_try(),
                Err(Full::Disk(error)) => {
                    was_refused = true;
                    self.safety.refused(&reason(&error))
                }
            };
            if !goes_on {
                break None;
            }
        };
        if was_refused {
            self.safety.taken();
        }
        match written {
            Some(last) => self.safety.wrote(last, batch.bytes()),
            None => inner.journal = None,
        }
    }

    /// Notes that records up to `last` are safe from a power cut.
    pub(crate) fn safe_until(&self, last: u64) {
        self.change(|ring| ring.safe = last + 1);
    }

    /// Closes the record. With a journal, waits for its committer to finish.
    pub(crate) fn close(&self) {
        self.safety.close();
        if self.has_journal() {
            self.wait_closed(None);
        } else {
            self.closed();
        }
    }

    /// Closes the record without waiting for a committer, which may not exist. Written records are in the journal's own
    /// recorder.
    pub(crate) fn abandon(&self) {
        self.safety.close();
        self.closed();
    }

    /// Ends writing to the journal.
    pub(crate) fn leave_journal(&self) {
        self.inner.lock().journal = None;
    }

    /// Marks the record as closed; all its records may be sent.
    pub(crate) fn closed(&self) {
        self.safety.closed();
        let mut ring = self.ring.lock();
        (ring.closed, ring.safe) = (true, u64::MAX);
        self.grown.notify_all();
    }

    /// Applies a change, and wakes waiting threads if records were added.
    fn change(&self, change: impl FnOnce(&mut Ring)) {
        let mut ring = self.ring.lock();
        let before = (ring.tellable(), ring.blocks.next());
        change(&mut ring);
        if ring.sleepers > 0 && (ring.tellable(), ring.blocks.next()) != before {
            self.grown.notify_all();
        }
    }

    /// The number before which all records may be sent.
    pub(crate) fn tellable(&self) -> u64 {
        self.ring.lock().tellable()
    }

    /// The number of the last record.
    pub(crate) fn last(&self) -> u64 {
        self.ring.lock().blocks.next() - 1
    }

    /// Copies consecutive records from number `from` on to `into`, or only the rare ones.
    pub(crate) fn read(&self, from: u64, rare: bool, into: &mut Chunk) -> Read {
        let ring = self.ring.lock();
        // A record that is not safe yet is not missed, even if memory has dropped it: the journal will contain it.
        let begin = from.max(ring.blocks.first().min(ring.tellable()));
        let end = ring.tellable().max(begin);
        let next = ring.blocks.read(begin, end, rare, into).max(begin);
        let closed = ring.closed && next >= end;
        drop(ring);
        into.trim();
        Read { next, missed: begin - from, closed }
    }

    /// Copies records from number `next` on to `into`, including those that are not safe yet, and advances `next`.
    /// False if no record follows.
    pub(crate) fn recent(&self, next: &mut u64, into: &mut Chunk) -> bool {
        let blocks = &self.ring.lock().blocks;
        let begin = (*next).max(blocks.first());
        *next = blocks.read(begin, blocks.next(), false, into).max(begin);
        *next > begin
    }

    /// Waits until the record with number `from` may be sent, a record after number `last` exists, the record is
    /// closed, or `deadline` has passed.
    pub(crate) fn wait(&self, from: u64, last: u64, deadline: Option<Instant>) {
        let mut ring = self.ring.lock();
        ring.sleepers += 1;
        while !ring.closed
            && ring.tellable() <= from
            && ring.blocks.next() <= last + 1
            && self.sleep(&mut ring, deadline)
        {}
        ring.sleepers -= 1;
    }

    /// Waits until the record is closed or `deadline` has passed. New records do not wake it.
    pub(crate) fn wait_closed(&self, deadline: Option<Instant>) {
        let mut ring = self.ring.lock();
        while !ring.closed && self.sleep(&mut ring, deadline) {}
    }

    /// Waits for a change; false once the deadline has passed.
    fn sleep(&self, ring: &mut MutexGuard<'_, Ring>, deadline: Option<Instant>) -> bool {
        if let Some(deadline) = deadline {
            return !self.grown.wait_until(ring, deadline).timed_out();
        }
        self.grown.wait(ring);
        true
    }
}

/// The exclusive writer of a group of records.
#[derive(Debug)]
pub(crate) struct RecordWriter<'r> {
    recorder: &'r Recorder,
    inner: MutexGuard<'r, RecorderInner>,
}

impl RecordWriter<'_> {
    /// True if the run keeps values.
    pub(crate) fn keeps_values(&self) -> bool {
        self.recorder.keeping == Keeping::Full
    }

    /// Notes that the run is asked to end, so that a failing disk does not prevent its end.
    pub(crate) fn run_ends(&self) {
        self.recorder.safety.end();
    }

    /// Definitions of the place numbers.
    pub(crate) fn names(&self) -> &Names {
        &self.recorder.names
    }

    /// Defines a place from the next record on.
    pub(crate) fn define(&mut self, number: PlaceNumber, place: Arc<Place>) {
        self.inner.writer.define(number, &place);
        self.recorder.names.define(self.inner.writer.next(), number, place);
    }
}

impl Deref for RecordWriter<'_> {
    type Target = RecordEncoder;

    fn deref(&self) -> &RecordEncoder {
        &self.inner.writer
    }
}

impl DerefMut for RecordWriter<'_> {
    fn deref_mut(&mut self) -> &mut RecordEncoder {
        &mut self.inner.writer
    }
}

impl Drop for RecordWriter<'_> {
    fn drop(&mut self) {
        self.recorder.finish(&mut self.inner);
    }
}
