//! Hash of all events of a journal up to one of them. Two journals with equal hashes have equal events, whatever their source.

use crate::journal::read::{Reader, damaged};
use crate::journal::record::Item;
use crate::journal::{Entry, JournalError};
use std::ops::ControlFlow;

/// A hash that each event extends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Chain {
    last: u64,
    t_ns: u64,
    hash: [u8; 32],
}

impl Chain {
    /// Returns the last event that the hash includes.
    pub fn last(&self) -> u64 {
        self.last
    }

    /// Returns the first 64 bits of the hash, which both sides compare.
    pub fn hash(&self) -> u64 {
        self.hash.first_chunk().map_or(0, |first| u64::from_be_bytes(*first))
    }

    /// Extends the hash up to event `to`, or by approximately the given number of bytes. Returns the number of bytes. Fails if the
    /// journal is damaged or has dropped detail.
    pub fn advance(
        &mut self,
        reader: &mut Reader,
        to: u64,
        bytes_max: usize,
    ) -> Result<usize, JournalError> {
        if self.last >= to {
            return Ok(0);
        }
        if reader.thinned_before()?.is_some_and(|before| self.last + 1 < before) {
            return Err(reader.given_up());
        }
        let (mut bytes, mut read, mut lost) = (Vec::new(), 0, None);
        reader.each(self.last + 1, |_, entry| {
            lost = damaged(&entry.record);
            if entry.sequence > to || read > bytes_max || lost.is_some() {
                return ControlFlow::Break(());
            }
            bytes.clear();
            self.add(entry, &mut bytes);
            read += bytes.len();
            ControlFlow::Continue(())
        })?;
        lost.map_or(Ok(read), |(first, last)| Err(reader.lost_events(first, last)))
    }

    fn add(&mut self, entry: Entry, bytes: &mut Vec<u8>) {
        self.last = entry.sequence;
        bytes.extend_from_slice(&self.hash);
        Item::Record(entry.t_ns, entry.record).write(&mut self.t_ns, bytes);
        self.hash = *blake3::hash(bytes).as_bytes();
    }
}
