//! Converts records of an open journal to events of the protocol, by means of `protocol.rs`.

use super::filter::place_of;
use super::{Entry, Reader};
use crate::journal::folder::JournalError;
use crate::journal::record::protocol::{Glossary, tell, view};
pub(in crate::journal) use crate::journal::record::protocol::{name_of, outcome_of};
use crate::journal::record::{Kept, Place, PlaceNumber, Record, Stored, ValueNumber};
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
    /// Converts an entry to an event of the protocol. Without `values`, the event has no inputs and outputs, and a short error.
    pub fn event(&self, entry: &Entry, values: bool) -> Result<Event, JournalError> {
        tell(entry.record.clone(), self, values)
    }

    /// Returns the numbers of the values in an event, each with the name of its port or variable. The name of an error is `error`.
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

    /// Returns a value in the form that readers receive.
    pub fn view(&self, kept: &Kept) -> Result<Value, JournalError> {
        view(kept, self)
    }
}
