//! Values on their way into the journal. Knows how a value is named there; must never know how it was made.

use rafcon_storage::journal::{Kept, Stored, ValueNumber};
use std::sync::atomic::{AtomicU64, Ordering};

/// How a value is kept.
#[derive(Debug)]
pub enum Keep<'v> {
    /// In the event itself.
    Plain(Kept),
    /// Once, by number.
    Stored(&'v KeptValue),
}

/// A value that is kept once for all events that name it. It belongs to the handle of the value and is made with it, before
/// the engine is locked: making it may run code of the user.
#[derive(Debug)]
pub struct KeptValue {
    stored: Stored,
    /// 0 while no event has named it.
    number: AtomicU64,
}

impl KeptValue {
    /// A value that no event has named.
    pub fn new(stored: Stored) -> Self {
        Self { stored, number: AtomicU64::new(0) }
    }

    /// What is kept.
    pub fn stored(&self) -> &Stored {
        &self.stored
    }

    /// Its number, if an event has named it.
    pub fn number(&self) -> Option<ValueNumber> {
        let number = self.number.load(Ordering::Relaxed);
        (number != 0).then_some(ValueNumber(number))
    }

    /// Gives it its number. Only the holder of the engine does.
    pub fn set_number(&self, number: ValueNumber) {
        self.number.store(number.0, Ordering::Relaxed);
    }
}
