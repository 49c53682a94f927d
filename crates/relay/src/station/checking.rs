//! Compares the hash of a replica's events with the robot's: their journals can part when a disk is put back or changed.

use super::kept_runs::KeepError;
use rafcon_link::EventHash;
use rafcon_storage::journal::{Chain, Reader};
use std::path::PathBuf;

/// Bytes of events hashed in one step.
const BYTES_AT_ONCE: usize = 1 << 20;

/// Pending comparison of one run.
#[derive(Debug, Default)]
pub(super) struct Checking {
    wanted: Option<EventHash>,
    reader: Option<Reader>,
    chain: Chain,
    /// There is more to be hashed.
    goes_on: bool,
}

impl Checking {
    /// The robot's events have this hash.
    pub(super) fn set(&mut self, wanted: EventHash) {
        self.wanted = Some(wanted);
        if wanted.last < self.chain.last() {
            self.chain = Chain::default();
        }
        self.goes_on = true;
    }

    /// True if hashing is incomplete.
    pub(super) fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// Closes the journal, which is opened again when there is more to be hashed.
    pub(super) fn rest(&mut self) {
        self.reader = None;
    }

    /// Goes on with the events in this folder that are safe.
    pub(super) fn check(&mut self, folder: Option<PathBuf>) -> Option<KeepError> {
        let EventHash { last, hash } = self.wanted?;
        let reader = match &mut self.reader {
            Some(reader) => reader,
            none => none.insert(Reader::open(&folder?).ok()?),
        };
        if self.chain.advance(reader, last, BYTES_AT_ONCE).is_err() {
            // Dropped or damaged events cannot be compared.
            *self = Self::default();
            return None;
        }
        self.goes_on =
            self.chain.last() < last && reader.last_sequence().is_ok_and(|there| there >= last);
        if self.chain.last() != last {
            return None;
        }
        self.rest();
        self.wanted = None;
        (self.chain.hash() != hash).then(|| {
            let why = format!("the robot has other events than this replica, up to event {last}");
            KeepError::Diverged(why)
        })
    }
}
