//! Events of an open journal as the protocol tells them. Knows the reader; the words are those of `telling.rs`.

use super::{Entry, Reader};
use crate::journal::error::JournalError;
use crate::journal::filter::place_of;
use crate::journal::record::{Kept, Place, PlaceNumber, Record, Stored, ValueNumber};
use crate::journal::telling::{Glossary, tell, view};
pub(in crate::journal) use crate::journal::telling::{name_of, outcome_of};
use rafcon_protocol::Event;
use serde_json::Value;
use smol_str::SmolStr;
use std::sync::Arc;

impl Glossary for Reader {
    fn place(&self, number: PlaceNumber) -> Option<Arc<Place>> {
        self.places.get(number).cloned()
    }

    fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError> {
        Self::value(self, number)
    }
}

fn named(name: &str, value: &Kept) -> Option<(String, ValueNumber)> {
    match value {
        Kept::Value(number) => Some((name.to_owned(), *number)),
        _ => None,
    }
}

impl Reader {
    /// An event as it is told. Without `values`, inputs and outputs are left out, and errors are short.
    pub fn event(&self, entry: &Entry, values: bool) -> Result<Event, JournalError> {
        tell(entry.record.clone(), self, values)
    }

    /// The values that an event names by number, each by its port or variable; an error has the name `error`.
    pub fn named_values(&self, entry: &Entry) -> Vec<(String, ValueNumber)> {
        let place = place_of(&entry.record).and_then(|place| self.places.get(place));
        let ports = |ports: fn(&Place) -> &[(u64, SmolStr)], values: &[Kept]| {
            let ports = place.map_or(&[][..], |place| ports(place));
            ports.iter().zip(values).filter_map(|((_, name), value)| named(name, value)).collect()
        };
        match &entry.record {
            Record::Entered { inputs, .. } => ports(|place| &place.inputs, inputs),
            Record::Left { outputs, error, .. } => {
                let mut values: Vec<_> = ports(|place| &place.outputs, outputs);
                values.extend(error.as_ref().and_then(|error| named("error", error)));
                values
            }
            Record::Scoped { port, value, .. } => {
                let name = name_of(place.map(|place| &place.scoped[..]), *port);
                named(&name, value).into_iter().collect()
            }
            Record::Global { name, value: Some(value) } => named(name, value).into_iter().collect(),
            Record::Persistent { value, .. } => named("", value).into_iter().collect(),
            _ => Vec::new(),
        }
    }

    /// A value as a reader sees it.
    pub fn view(&self, kept: &Kept) -> Result<Value, JournalError> {
        view(kept, self)
    }
}
