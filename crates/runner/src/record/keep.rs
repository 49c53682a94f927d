//! The journal's form of values. This module knows how the journal names a value, but not where the value comes from.

use rafcon_storage::journal::{Kept, Stored, ValueNumber};
use std::sync::atomic::{AtomicU64, Ordering};

/// The form in which a value is kept.
#[derive(Debug)]
pub enum Keep<'v> {
    /// Inside the event itself.
    Plain(Kept),
    /// Kept once, and named by number.
    Stored(&'v KeptValue),
}

/// A value that is kept once for all events that name it. It belongs to the handle of the value and is created with it,
/// before the engine is locked, because that may run code of the user.
#[derive(Debug)]
pub struct KeptValue {
    stored: Stored,
    /// Its number, and the record before which the number was assigned; 0 while no event has named it.
    number: AtomicU64,
    defined: AtomicU64,
}

impl KeptValue {
    /// A value that no event has named.
    pub fn new(stored: Stored) -> Self {
        Self { stored, number: AtomicU64::new(0), defined: AtomicU64::new(0) }
    }

    /// The content that is kept.
    pub fn stored(&self) -> &Stored {
        &self.stored
    }

    /// Its number, if that was assigned for record `since` or later. Called only by the writer of the record.
    pub(crate) fn number(&self, since: u64) -> Option<ValueNumber> {
        let number = self.number.load(Ordering::Relaxed);
        let is_new = self.defined.load(Ordering::Relaxed) >= since;
        (number != 0 && is_new).then_some(ValueNumber(number))
    }

    /// Assigns its number, from record `defined` on.
    pub(crate) fn set_number(&self, number: ValueNumber, defined: u64) {
        self.number.store(number.0, Ordering::Relaxed);
        self.defined.store(defined, Ordering::Relaxed);
    }
}
