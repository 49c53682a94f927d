//! Events of an open journal as the protocol tells them. Knows the reader; the words are those of `telling.rs`.

use super::{Entry, Reader};
use crate::journal::error::JournalError;
use crate::journal::record::{Kept, Place, PlaceNumber, Stored, ValueNumber};
use crate::journal::telling::{Glossary, tell, view};
pub(in crate::journal) use crate::journal::telling::{name_of, outcome_of};
use rafcon_protocol::Event;
use serde_json::Value;
use std::sync::Arc;

impl Glossary for Reader {
    fn place(&self, number: PlaceNumber) -> Option<Arc<Place>> {
        self.places.get(number).cloned()
    }

    fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        Self::value(self, number)
    }
}

impl Reader {
    /// An event as it is told. Without `values`, inputs, outputs and errors are left out.
    pub fn event(&self, entry: &Entry, values: bool) -> Result<Event, JournalError> {
        tell(entry.record.clone(), self, values)
    }

    /// A value as a reader sees it.
    pub fn view(&self, kept: &Kept) -> Result<Value, JournalError> {
        view(kept, self)
    }
}
