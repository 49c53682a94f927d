//! Records as the protocol tells them: with paths, names and values. Knows both vocabularies.

use super::{Entry, Reader};
use crate::journal::error::JournalError;
use crate::journal::record::{Kept, Place, PlaceNumber, Record};
use rafcon_protocol::{Event, Outcome, Values};
use serde_json::{Value, json};
use smol_str::SmolStr;
use std::num::NonZeroU64;
use std::sync::Arc;

impl Reader {
    /// An event as it is told. Without `values`, inputs, outputs and errors are left out.
    pub fn event(&self, entry: &Entry, values: bool) -> Result<Event, JournalError> {
        Ok(match &entry.record {
            Record::Entered { place, inputs, undoes } => {
                let (path, place) = self.place(*place);
                let inputs =
                    self.values_of(values, place.as_deref().map(|p| &p.inputs[..]), inputs)?;
                Event::Entered { path, inputs, undoes: undoes.map(NonZeroU64::get) }
            }
            Record::Left { place, outcome, outputs, error, undoes } => {
                let (path, place) = self.place(*place);
                let ports = place.as_deref().map(|place| &place.outputs[..]);
                let error = error.as_ref().filter(|_| values);
                Event::Left {
                    path,
                    outcome: outcome_of(place.as_deref(), *outcome),
                    outputs: self.values_of(values, ports, outputs)?,
                    error: error.map(|error| self.view(error)).transpose()?,
                    undoes: undoes.map(NonZeroU64::get),
                }
            }
            Record::Scoped { place, port, value } => {
                let (path, place) = self.place(*place);
                let name = name_of(place.as_deref().map(|place| &place.scoped[..]), *port);
                Event::Scoped { path, name, value: self.view(value)? }
            }
            Record::Global { name, value } => Event::Global {
                name: name.to_string(),
                value: value.as_ref().map(|value| self.view(value)).transpose()?,
            },
            Record::Persistent { place, value } => {
                Event::Persistent { path: self.place(*place).0, value: self.view(value)? }
            }
            Record::Log { place, level, stream, message } => Event::Log {
                path: place.map(|place| self.place(place).0).unwrap_or_default(),
                level: *level,
                stream: *stream,
                message: message.clone(),
            },
            Record::WentBack { sequence, .. } => Event::WentBack { sequence: *sequence },
            Record::Told(event) => (**event).clone(),
        })
    }

    /// A value as a reader sees it.
    pub fn view(&self, kept: &Kept) -> Result<Value, JournalError> {
        Ok(match kept {
            Kept::Absent | Kept::None => Value::Null,
            Kept::Bool(value) => (*value).into(),
            Kept::Int(value) => (*value).into(),
            Kept::Float(value) => float(*value),
            Kept::Text(text) => text.as_str().into(),
            Kept::Value(number) => match self.value(*number)? {
                Some(stored) => stored.view,
                None => json!({ "__repr__": "<no longer kept>", "__class__": "" }),
            },
        })
    }

    /// Values by the names of their ports, without those that are absent.
    pub(super) fn named(
        &self,
        ports: &[(u64, SmolStr)],
        values: &[Kept],
    ) -> Result<Values, JournalError> {
        let there = ports.iter().zip(values).filter(|(_, value)| **value != Kept::Absent);
        there.map(|((_, name), value)| Ok((name.to_string(), self.view(value)?))).collect()
    }

    fn values_of(
        &self,
        wanted: bool,
        ports: Option<&[(u64, SmolStr)]>,
        values: &[Kept],
    ) -> Result<Option<Values>, JournalError> {
        match ports.filter(|ports| wanted && ports.len() == values.len()) {
            Some(ports) => self.named(ports, values).map(Some),
            None => Ok(None),
        }
    }

    fn place(&self, number: PlaceNumber) -> (String, Option<Arc<Place>>) {
        let place = self.places.get(number).cloned();
        (place.as_ref().map(|place| place.path.clone()).unwrap_or_default(), place)
    }
}

/// A float as `docs/protocol.md` encodes it.
fn float(value: f64) -> Value {
    let repr = || match value {
        _ if value.is_nan() => "nan",
        _ if value > 0.0 => "inf",
        _ => "-inf",
    };
    let number = serde_json::Number::from_f64(value).map(Value::Number);
    number.unwrap_or_else(|| json!({ "__repr__": repr(), "__class__": "float" }))
}

/// An outcome with its name, as far as the place knows it.
pub(in crate::journal) fn outcome_of(place: Option<&Place>, id: i64) -> Outcome {
    let outcomes = place.map_or(&[][..], |place| &place.outcomes);
    let known = outcomes.iter().find(|(known, _)| *known == id).map(|(_, name)| name.to_string());
    let name = known.unwrap_or_else(|| match id {
        -1 => "aborted".to_owned(),
        -2 => "preempted".to_owned(),
        _ => id.to_string(),
    });
    Outcome { id, name }
}

pub(super) fn name_of(ports: Option<&[(u64, SmolStr)]>, port: u64) -> String {
    let named = ports.unwrap_or_default().iter().find(|(known, _)| *known == port);
    named.map_or_else(|| port.to_string(), |(_, name)| name.to_string())
}
