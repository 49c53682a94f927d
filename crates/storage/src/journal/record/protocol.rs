//! Converts records to events of the protocol, with paths, names and values.

use super::{Kept, Place, PlaceNumber, Record, Stored, ValueNumber};
use crate::journal::folder::JournalError;
use rafcon_protocol::{Event, Outcome, Values, short_error};
use serde_json::{Value, json};
use smol_str::SmolStr;
use std::num::NonZeroU64;
use std::sync::Arc;

/// Looks up the numbers in a record.
pub trait Glossary {
    /// Returns a place, as defined when the record was written.
    fn place(&self, number: PlaceNumber) -> Option<Arc<Place>>;

    /// Returns a value. `None` if the journal has deleted it.
    fn value(&self, number: ValueNumber) -> Result<Option<Stored>, JournalError>;
}

/// Converts a record to an event of the protocol. Without `values`, the event has no inputs and outputs, and a short error.
pub fn tell(record: Record, glossary: &impl Glossary, values: bool) -> Result<Event, JournalError> {
    Telling { glossary, values }.event(record)
}

/// Returns a value in the form that readers receive.
pub(in crate::journal) fn view(
    kept: &Kept,
    glossary: &impl Glossary,
) -> Result<Value, JournalError> {
    Ok(match kept {
        Kept::None => Value::Null,
        Kept::Bool(value) => (*value).into(),
        Kept::Int(value) => int(*value),
        Kept::Float(value) => float(*value),
        Kept::Text(text) => text.as_str().into(),
        Kept::Value(number) => match glossary.value(*number) {
            Ok(Some(stored)) => stored.view,
            Ok(None) => gone(),
            Err(JournalError::Damaged { .. }) => damaged(*number),
            Err(error) => return Err(error),
        },
        Kept::Absent => gone(),
    })
}

/// Start of the text that replaces a damaged value.
pub const DAMAGED: &str = "<damaged: ";

fn damaged(number: ValueNumber) -> Value {
    let text = format!("{DAMAGED}value {} of the journal cannot be read>", number.0);
    json!({ "__repr__": text, "__class__": "" })
}

/// Returns the replacement for a value that was deleted to limit the size of the journal.
fn gone() -> Value {
    json!({ "__repr__": "<no longer kept>", "__class__": "" })
}

struct Telling<'g, G> {
    glossary: &'g G,
    values: bool,
}

impl<G: Glossary> Telling<'_, G> {
    fn event(&self, record: Record) -> Result<Event, JournalError> {
        Ok(match record {
            Record::Entered { place, inputs, undoes } => {
                let (path, place) = self.place(place);
                let inputs = self.values(place.as_deref().map(|p| &p.inputs[..]), &inputs)?;
                Event::Entered { path, inputs, undoes: undoes.map(NonZeroU64::get) }
            }
            Record::Left { place, outcome, outputs, error, undoes } => {
                let (path, place) = self.place(place);
                Event::Left {
                    path,
                    outcome: outcome_of(place.as_deref(), outcome),
                    outputs: self.values(place.as_deref().map(|p| &p.outputs[..]), &outputs)?,
                    error: error.map(|error| self.error(&error)).transpose()?,
                    undoes: undoes.map(NonZeroU64::get),
                }
            }
            Record::Scoped { place, port, value } => {
                let (path, place) = self.place(place);
                let name = name_of(place.as_deref().map(|place| &place.scoped[..]), port);
                Event::Scoped { path, name, value: self.view(&value)? }
            }
            Record::Global { name, value } => {
                let value = value.map(|value| self.view(&value)).transpose()?;
                Event::Global { name: name.to_string(), value }
            }
            Record::Persistent { place, value } => {
                Event::Persistent { path: self.place(place).0, value: self.view(&value)? }
            }
            Record::Log { place, level, stream, message } => {
                let path = place.map(|place| self.place(place).0).unwrap_or_default();
                Event::Log { path, level, stream, message }
            }
            Record::WentBack { sequence, .. } => Event::WentBack { sequence },
            Record::Told(event) => *event,
        })
    }

    fn place(&self, number: PlaceNumber) -> (String, Option<Arc<Place>>) {
        let place = self.glossary.place(number);
        (place.as_ref().map(|place| place.path.clone()).unwrap_or_default(), place)
    }

    fn view(&self, kept: &Kept) -> Result<Value, JournalError> {
        view(kept, self.glossary)
    }

    /// Converts an error. Without `values`, an unreadable error does not hide the end of the state.
    fn error(&self, kept: &Kept) -> Result<Value, JournalError> {
        let error = self.view(kept);
        if self.values { error } else { Ok(short_error(error.unwrap_or_else(|_| gone()))) }
    }

    fn values(
        &self,
        ports: Option<&[(u64, SmolStr)]>,
        values: &[Kept],
    ) -> Result<Option<Values>, JournalError> {
        match ports.filter(|ports| self.values && ports.len() == values.len()) {
            Some(ports) => named(ports, values, self.glossary).map(Some),
            None => Ok(None),
        }
    }
}

/// Returns values by the names of their ports, without absent ones.
fn named(
    ports: &[(u64, SmolStr)],
    values: &[Kept],
    glossary: &impl Glossary,
) -> Result<Values, JournalError> {
    let there = ports.iter().zip(values).filter(|(_, value)| **value != Kept::Absent);
    there.map(|((_, name), value)| Ok((name.to_string(), view(value, glossary)?))).collect()
}

/// Largest integer that every JSON reader preserves exactly.
const EXACT_MAX: u64 = (1 << 53) - 1;

/// Encodes an integer as in `docs/protocol.md`.
pub fn int(value: i64) -> Value {
    if value.unsigned_abs() <= EXACT_MAX {
        value.into()
    } else {
        json!({ "__int__": value.to_string() })
    }
}

/// Encodes a float as in `docs/protocol.md`.
pub fn float(value: f64) -> Value {
    if value == 0.0 && value.is_sign_negative() {
        return json!({ "__float__": "-0.0" });
    }
    let repr = || match value {
        _ if value.is_nan() => "nan",
        _ if value > 0.0 => "inf",
        _ => "-inf",
    };
    let number = serde_json::Number::from_f64(value).map(Value::Number);
    number.unwrap_or_else(|| json!({ "__repr__": repr(), "__class__": "float" }))
}

/// Returns an outcome with its name, if the place defines it.
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

pub(in crate::journal) fn name_of(ports: Option<&[(u64, SmolStr)]>, port: u64) -> String {
    let named = ports.unwrap_or_default().iter().find(|(known, _)| *known == port);
    named.map_or_else(|| port.to_string(), |(_, name)| name.to_string())
}

#[cfg(test)]
mod tests {
    use super::{EXACT_MAX, int};
    use serde_json::json;

    #[test]
    fn an_integer_that_json_readers_would_round_is_written_with_its_digits() {
        let most = i64::try_from(EXACT_MAX).unwrap();
        assert_eq!((int(most), int(-most)), (json!(most), json!(-most)));
        assert_eq!(int(most + 1), json!({ "__int__": "9007199254740992" }));
        assert_eq!(int(i64::MIN), json!({ "__int__": "-9223372036854775808" }));
    }
}
