//! What happened in a run, numbered, for any number of readers. Knows what is written and what may be told, but not who
//! reads, and never waits for a reader.

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

/// Encoded records in memory at most, in bytes, if they are nowhere else.
const MEMORY_BYTES: usize = 64 << 20;
/// The same with a journal, in which readers find what is older. Tests have little, to see how that is.
const MEMORY_BYTES_WITH_JOURNAL: usize = if cfg!(test) { 1 << 20 } else { 16 << 20 };

/// What a reader gets.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Read {
    /// The number to continue with.
    pub(crate) next: u64,
    /// How many records before that are not in memory any more.
    pub(crate) missed: u64,
    /// Whether nothing more will ever come.
    pub(crate) closed: bool,
}

/// The record of a run.
#[derive(Debug)]
pub(crate) struct Recorder {
    names: Names,
    keeping: Keeping,
    /// Where the journal lies, if there is one.
    folder: Option<PathBuf>,
    safety: Safety,
    ink: Mutex<RecorderInner>,
    ring: Mutex<Ring>,
    grown: Condvar,
}

/// What one writer has at a time.
#[derive(Debug)]
struct RecorderInner {
    writer: RecordEncoder,
    /// None if the run is not kept, or not any more.
    journal: Option<Arc<Journal>>,
}

/// What readers see.
#[derive(Debug)]
struct Ring {
    blocks: Blocks,
    /// The number before which everything is safe; without a journal, everything is.
    safe: u64,
    sleepers: usize,
    closed: bool,
}

impl Ring {
    fn new(next: u64, limit: usize, safe: u64) -> Self {
        Self { blocks: Blocks::new(next, limit), safe, sleepers: 0, closed: false }
    }

    /// The number before which everything may be told.
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
            ink: Mutex::new(RecorderInner { writer: RecordEncoder::after(0, 0, 0), journal: None }),
            ring: Mutex::new(Ring::new(1, limit, u64::MAX)),
            grown: Condvar::new(),
        }
    }

    /// A record with a journal behind it, which may be that of a run resumed.
    pub(crate) fn with_journal(
        journal: Journal,
        resume_point: Option<&ResumePoint>,
        (keeping, strict): (Keeping, bool),
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
            ink: Mutex::new(RecorderInner { writer, journal: Some(Arc::new(journal)) }),
            ring: Mutex::new(Ring::new(last + 1, MEMORY_BYTES_WITH_JOURNAL, last + 1)),
            grown: Condvar::new(),
        }
    }

    /// What the numbers of places stand for.
    pub(crate) fn names(&self) -> &Names {
        &self.names
    }

    /// How much is kept.
    pub(crate) fn keeping(&self) -> Keeping {
        self.keeping
    }

    /// What is safe from a power cut.
    pub(crate) fn safety(&self) -> &Safety {
        &self.safety
    }

    /// Whether there is a journal behind the record, closed or not.
    pub(crate) fn has_journal(&self) -> bool {
        self.folder.is_some()
    }

    /// The folder of the run, if there is a journal in it.
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The journal behind the record, until it is closed.
    pub(crate) fn journal(&self) -> Option<Arc<Journal>> {
        self.ink.lock().journal.clone()
    }

    /// Begins to write things that happen at once; they are there when the answer is dropped.
    pub(crate) fn write(&self) -> RecordWriter<'_> {
        RecordWriter { recorder: self, ink: self.ink.lock() }
    }

    /// Adds records that happened at the same time.
    pub(crate) fn push(&self, t_ns: u64, records: impl IntoIterator<Item = Record>) {
        let mut writer = self.write();
        records.into_iter().for_each(|record| writer.note(t_ns, &record));
    }

    fn finish(&self, ink: &mut RecorderInner) {
        self.keep(ink);
        self.change(|ring| ring.blocks.push(ink.writer.encoded()));
        ink.writer.clear();
    }

    /// Gives the journal what was written. It waits for room if it must; the committer needs nothing that the writer holds.
    fn keep(&self, ink: &mut RecorderInner) {
        let Some(journal) = &ink.journal else { return };
        let batch = ink.writer.batch();
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
            None => ink.journal = None,
        }
    }

    /// Records up to `last` are safe from a power cut.
    pub(crate) fn safe_until(&self, last: u64) {
        self.change(|ring| ring.safe = last + 1);
    }

    /// Nothing more will come. With a journal, its committer says so when it is done.
    pub(crate) fn close(&self) {
        self.safety.close();
        if self.has_journal() {
            self.wait_closed(None);
        } else {
            self.closed();
        }
    }

    /// The same without a committer: perhaps there is none. What was written is in the journal's own recorder.
    pub(crate) fn abandon(&self) {
        self.safety.close();
        self.closed();
    }

    /// Nothing more goes into the journal.
    pub(crate) fn leave_journal(&self) {
        self.ink.lock().journal = None;
    }

    /// Nothing more will come, and all may be told.
    pub(crate) fn closed(&self) {
        self.safety.closed();
        let mut ring = self.ring.lock();
        (ring.closed, ring.safe) = (true, u64::MAX);
        self.grown.notify_all();
    }

    /// Wakes those who wait, if there is more.
    fn change(&self, change: impl FnOnce(&mut Ring)) {
        let mut ring = self.ring.lock();
        let before = (ring.tellable(), ring.blocks.next());
        change(&mut ring);
        if ring.sleepers > 0 && (ring.tellable(), ring.blocks.next()) != before {
            self.grown.notify_all();
        }
    }

    /// The number before which everything may be told.
    pub(crate) fn tellable(&self) -> u64 {
        self.ring.lock().tellable()
    }

    /// The number of the last record.
    pub(crate) fn last(&self) -> u64 {
        self.ring.lock().blocks.next() - 1
    }

    /// Copies records from number `from` on to `into`, as many as lie together; only `rare` ones if so wanted.
    pub(crate) fn read(&self, from: u64, rare: bool, into: &mut Chunk) -> Read {
        let ring = self.ring.lock();
        // What is not safe yet is not missed, even if memory gave it up already: the journal will have it.
        let begin = from.max(ring.blocks.first().min(ring.tellable()));
        let end = ring.tellable().max(begin);
        let next = ring.blocks.read(begin, end, rare, into).max(begin);
        let closed = ring.closed && next >= end;
        drop(ring);
        into.trim();
        Read { next, missed: begin - from, closed }
    }

    /// Copies records from number `next` on to `into`, also those that are not safe yet, and puts `next` behind them; false if
    /// there are none.
    pub(crate) fn recent(&self, next: &mut u64, into: &mut Chunk) -> bool {
        let blocks = &self.ring.lock().blocks;
        let begin = (*next).max(blocks.first());
        *next = blocks.read(begin, blocks.next(), false, into).max(begin);
        *next > begin
    }

    /// Waits until a record with number `from` may be told, there is one after number `last`, nothing more will come, or
    /// `deadline` has passed.
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

    /// Waits until nothing more will come or `deadline` has passed; records do not wake it.
    pub(crate) fn wait_closed(&self, deadline: Option<Instant>) {
        let mut ring = self.ring.lock();
        while !ring.closed && self.sleep(&mut ring, deadline) {}
    }

    /// False once the deadline has passed.
    fn sleep(&self, ring: &mut MutexGuard<'_, Ring>, deadline: Option<Instant>) -> bool {
        if let Some(deadline) = deadline {
            return !self.grown.wait_until(ring, deadline).timed_out();
        }
        self.grown.wait(ring);
        true
    }
}

/// A writer that no one else has.
#[derive(Debug)]
pub(crate) struct RecordWriter<'r> {
    recorder: &'r Recorder,
    ink: MutexGuard<'r, RecorderInner>,
}

impl RecordWriter<'_> {
    /// Whether values are kept.
    pub(crate) fn keeps_values(&self) -> bool {
        self.recorder.keeping == Keeping::Full
    }

    /// The run is asked to end: a disk that refuses must not keep it from that.
    pub(crate) fn run_ends(&self) {
        self.recorder.safety.end();
    }

    /// What the numbers of places stand for.
    pub(crate) fn names(&self) -> &Names {
        &self.recorder.names
    }

    /// The place stands for this from the next record on.
    pub(crate) fn define(&mut self, number: PlaceNumber, place: Arc<Place>) {
        self.ink.writer.define(number, &place);
        self.recorder.names.define(self.ink.writer.next(), number, place);
    }
}

impl Deref for RecordWriter<'_> {
    type Target = RecordEncoder;

    fn deref(&self) -> &RecordEncoder {
        &self.ink.writer
    }
}

impl DerefMut for RecordWriter<'_> {
    fn deref_mut(&mut self) -> &mut RecordEncoder {
        &mut self.ink.writer
    }
}

impl Drop for RecordWriter<'_> {
    fn drop(&mut self) {
        self.recorder.finish(&mut self.ink);
    }
}
