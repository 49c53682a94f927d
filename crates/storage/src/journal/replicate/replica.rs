//! An ordinary journal that is written from received items.

use crate::journal::record::{Batch, Broken, Stored};
use crate::journal::stream::{StreamBlock, StreamItem};
use crate::journal::{
    About, Committed, Definition, Full, Hash, Journal, JournalError, Options, Pack, ResumePoint,
};
use rafcon_events::EventBlock;
use std::path::Path;

/// Journal of a run on another computer. It has all events without gaps, from the first one on.
#[derive(Debug)]
pub struct Replica {
    journal: Journal,
    next: u64,
    t_ns: u64,
}

/// Reason why items were not stored. Items stored before remain.
#[derive(Debug, thiserror::Error)]
pub enum ReplicaError {
    /// The bytes are not items of a journal.
    #[error(
        "the items of a run are broken, and are not kept: use one version of rafcon on both sides"
    )]
    Broken(#[from] Broken),
    /// The number of items differs from the announced number.
    #[error(
        "{said} events were announced, but {found} arrived: use one version of rafcon on both sides"
    )]
    Count {
        /// Announced number of events.
        said: u64,
        /// Actual number of events.
        found: u64,
    },
    /// The items continue another event than the last one in the replica.
    #[error(
        "event {next} at the robot does not follow on event {} here: one of the two has another history", next - 1
    )]
    Diverged {
        /// Number of the next event.
        next: u64,
    },
    /// The recorder or its disk refused the items.
    #[error(transparent)]
    Full(#[from] Full),
    /// The journal failed to store the items.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

impl Replica {
    /// Creates the replica of a run in `folder`, or continues the existing one.
    pub fn open(folder: &Path, about: &About, options: &Options) -> Result<Self, JournalError> {
        match Journal::create(folder, about, options) {
            Ok(journal) => Ok(Self { journal, next: 1, t_ns: 0 }),
            Err(JournalError::Exists { .. }) => {
                let (journal, ResumePoint { sequence, t_ns, .. }) =
                    Journal::resume(folder, options)?;
                Ok(Self { journal, next: sequence + 1, t_ns })
            }
            Err(error) => Err(error),
        }
    }

    /// Returns the number of the next event.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Appends the new events, if they continue the replica. Returns true if there were new events.
    pub fn append(&mut self, block: &EventBlock) -> Result<bool, ReplicaError> {
        let EventBlock { first_sequence: first, count, time_before, .. } = *block;
        if first > self.next || block.last_sequence() < self.next {
            return Ok(false);
        }
        let mut batch = Batch::new(self.t_ns);
        let (mut found, mut t_before_next) = (0, (first == self.next).then_some(time_before));
        let items = StreamBlock { first, t_before: time_before, items: &block.bytes };
        for item in items.items() {
            match item? {
                StreamItem::Place { from, number, place } if from >= self.next => {
                    batch.define(&Definition::Place(number, place));
                }
                StreamItem::Value { from, number, stored } if from >= self.next => {
                    batch.define(&Definition::Value(number, Stored::from_bytes(stored)?));
                }
                StreamItem::Event { sequence, t_ns, record, .. } => {
                    found += 1;
                    if sequence + 1 == self.next {
                        t_before_next = Some(t_ns);
                    }
                    if sequence >= self.next {
                        batch.record(t_ns, &record);
                    }
                }
                StreamItem::Place { .. } | StreamItem::Value { .. } => {}
            }
        }
        if found != count {
            return Err(ReplicaError::Count { said: count, found });
        }
        if t_before_next != Some(self.t_ns) {
            return Err(ReplicaError::Diverged { next: self.next });
        }
        if let Err(Full::Recorder) = self.journal.append(&batch) {
            self.journal.commit()?;
            self.journal.append(&batch)?;
        }
        (self.next, self.t_ns) = (block.last_sequence() + 1, batch.t_last());
        Ok(true)
    }

    /// Stores a machine of the run. Returns when it survives a power cut.
    pub fn keep_root(&self, pack: &Pack) -> Result<Hash, JournalError> {
        self.journal.keep_root(pack)
    }

    /// Makes all appended events safe from a power cut. Returns the number of the last safe event.
    pub fn commit(&self) -> Result<Committed, JournalError> {
        self.journal.commit()
    }

    /// Closes the replica. No more events are expected.
    pub fn close(self) -> Result<Committed, JournalError> {
        self.journal.close_for_long()
    }
}
