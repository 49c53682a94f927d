//! An ordinary journal that is written from items.

use super::EventItems;
use crate::journal::record::{Batch, Broken, Stored};
use crate::journal::stream::{EventBlock, StreamItem};
use crate::journal::{
    About, Committed, Definition, Full, Hash, Journal, JournalError, Options, Pack, ResumePoint,
};
use std::path::Path;

/// The journal of a run that happens elsewhere. It has the events without gaps from the first one on.
#[derive(Debug)]
pub struct Replica {
    journal: Journal,
    next: u64,
    t_ns: u64,
}

/// Why items were not kept. What was kept before stays.
#[derive(Debug, thiserror::Error)]
pub enum ReplicaError {
    /// They are not items of a journal.
    #[error(
        "the items of a run are broken, and are not kept: both sides need the same version of rafcon"
    )]
    Broken(#[from] Broken),
    /// They are not as many as they are said to be.
    #[error(
        "{said} events were sent, and {found} came: both sides need the same version of rafcon"
    )]
    Count {
        /// What was said.
        said: u64,
        /// What was found.
        found: u64,
    },
    /// They follow on another event than the last one here.
    #[error(
        "event {next} at the robot does not follow on event {} here: one of the two has another history", next - 1
    )]
    Diverged {
        /// The number of the event that comes next.
        next: u64,
    },
    /// The disk refuses them.
    #[error(transparent)]
    Full(#[from] Full),
    /// The journal refuses them.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

impl Replica {
    /// Begins the replica of a run in `folder`, or goes on with the one there.
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

    /// The number of the event that comes next.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Takes the events that are new, if they continue what is here; answers whether any were.
    pub fn append(&mut self, items: &EventItems) -> Result<bool, ReplicaError> {
        let EventItems { first, count, t_before, bytes } = items;
        if *first > self.next || first + count <= self.next {
            return Ok(false);
        }
        let mut batch = Batch::new(self.t_ns);
        let (mut found, mut t_before_next) = (0, (*first == self.next).then_some(*t_before));
        let block = EventBlock { first: *first, t_before: *t_before, items: bytes };
        for item in block.items() {
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
        if found != *count {
            return Err(ReplicaError::Count { said: *count, found });
        }
        if t_before_next != Some(self.t_ns) {
            return Err(ReplicaError::Diverged { next: self.next });
        }
        if let Err(Full::Recorder) = self.journal.append(&batch) {
            self.journal.commit()?;
            self.journal.append(&batch)?;
        }
        (self.next, self.t_ns) = (first + count, batch.t_last());
        Ok(true)
    }

    /// Keeps a machine of the run, safe from a power cut.
    pub fn keep_root(&self, pack: &Pack) -> Result<Hash, JournalError> {
        self.journal.keep_root(pack)
    }

    /// Makes everything so far safe from a power cut; answers up to which event it is.
    pub fn commit(&self) -> Result<Committed, JournalError> {
        self.journal.commit()
    }

    /// Nothing more is expected of the run.
    pub fn close(self) -> Result<Committed, JournalError> {
        self.journal.close_for_long()
    }
}
