//! Records in the words of the protocol. Knows both; must never know who listens.

use crate::names::Names;
use rafcon_protocol::{Event, LogLevel, Outcome, Stream, Values};
use rafcon_storage::journal::{Kept, Place, PlaceNumber, Record, ValueNumber};
use serde_json::{Value, json};
use smol_str::SmolStr;
use std::num::NonZeroU64;
use std::sync::Arc;

/// Where the views of numbered values are looked up.
pub(crate) type Views<'v> = dyn FnMut(ValueNumber) -> Option<Value> + 'v;

/// Puts records into words for one viewer.
pub(crate) struct Wording<'w, 'v> {
    names: &'w Names,
    /// None if the viewer wants no values.
    views: Option<&'w mut Views<'v>>,
    /// The record that is put into words.
    sequence: u64,
}

impl<'w, 'v> Wording<'w, 'v> {
    /// With names of places, and with values if the viewer wants them.
    pub(crate) fn new(names: &'w Names, views: Option<&'w mut Views<'v>>) -> Self {
        Self { names, views, sequence: 0 }
    }

    /// The record as an event; nothing if it is only about values and the viewer wants none.
    pub(crate) fn event(&mut self, sequence: u64, record: Record) -> Option<Event> {
        self.sequence = sequence;
        Some(match record {
            Record::Entered { place, inputs, undoes } => self.entered(place, &inputs, undoes),
            Record::Left { place, outcome, outputs, error, undoes } => {
                let (values, error) = (self.outputs(place, &outputs), self.error(error.as_ref()));
                Event::Left {
                    path: self.path(place),
                    outcome: self.outcome(place, outcome),
                    outputs: values,
                    error,
                    undoes: undoes.map(NonZeroU64::get),
                }
            }
            Record::Scoped { place, port, value } => {
                let name = self.variable(place, port);
                Event::Scoped { path: self.path(place), name, value: self.value(&value)? }
            }
            Record::Global { name, value } => {
                self.views.as_ref()?;
                let value = value.and_then(|value| self.value(&value));
                Event::Global { name: name.to_string(), value }
            }
            Record::Persistent { place, value } => {
                Event::Persistent { path: self.path(place), value: self.value(&value)? }
            }
            Record::Log { place, level, stream, message } => {
                self.log(place, (level, stream), message)
            }
            Record::WentBack { sequence, .. } => Event::WentBack { sequence },
            Record::Told(event) => *event,
        })
    }

    fn entered(
        &mut self,
        place: PlaceNumber,
        inputs: &[Kept],
        undoes: Option<NonZeroU64>,
    ) -> Event {
        let known = self.place(place);
        let ports = known.as_deref().map_or(&[][..], |place| &place.inputs);
        let inputs = self.values(ports, inputs);
        Event::Entered { path: self.path(place), inputs, undoes: undoes.map(NonZeroU64::get) }
    }

    fn outputs(&mut self, place: PlaceNumber, outputs: &[Kept]) -> Option<Values> {
        let known = self.place(place);
        let ports = known.as_deref().map_or(&[][..], |place| &place.outputs);
        self.values(ports, outputs)
    }

    fn log(
        &self,
        place: Option<PlaceNumber>,
        (level, stream): (LogLevel, Stream),
        message: String,
    ) -> Event {
        let path = place.map(|place| self.path(place)).unwrap_or_default();
        Event::Log { path, level, stream, message }
    }

    fn place(&self, number: PlaceNumber) -> Option<Arc<Place>> {
        self.names.at(number, self.sequence)
    }

    fn path(&self, number: PlaceNumber) -> String {
        self.place(number).map(|place| place.path.clone()).unwrap_or_default()
    }

    fn outcome(&self, number: PlaceNumber, id: i64) -> Outcome {
        let place = self.place(number);
        let outcomes = place.as_deref().map_or(&[][..], |place| &place.outcomes);
        let name = outcomes.iter().find(|(known, _)| *known == id);
        Outcome { id, name: name.map(|(_, name)| name.to_string()).unwrap_or_default() }
    }

    fn variable(&self, number: PlaceNumber, port: u64) -> String {
        let place = self.place(number);
        let scoped = place.as_deref().map_or(&[][..], |place| &place.scoped);
        let name = scoped.iter().find(|(known, _)| *known == port);
        name.map(|(_, name)| name.to_string()).unwrap_or_default()
    }

    fn error(&mut self, error: Option<&Kept>) -> Option<Value> {
        error.and_then(|error| self.value(error))
    }

    /// Values by the names of their ports, if they are wanted and were kept.
    fn values(&mut self, ports: &[(u64, SmolStr)], kept: &[Kept]) -> Option<Values> {
        self.views.as_ref()?;
        let whole = ports.len() == kept.len();
        let named = ports
            .iter()
            .zip(kept)
            .filter_map(|((_, name), kept)| Some((name.to_string(), self.value(kept)?)));
        whole.then(|| named.collect())
    }

    fn value(&mut self, kept: &Kept) -> Option<Value> {
        let views = self.views.as_mut()?;
        Some(match kept {
            Kept::Absent => return None,
            Kept::None => Value::Null,
            Kept::Bool(value) => (*value).into(),
            Kept::Int(value) => (*value).into(),
            Kept::Float(value) => float(*value),
            Kept::Text(text) => text.as_str().into(),
            Kept::Value(number) => views(*number)?,
        })
    }
}

/// JSON has neither infinities nor what is no number.
fn float(value: f64) -> Value {
    serde_json::Number::from_f64(value)
        .map_or_else(|| json!({ "__repr__": repr(value), "__class__": "float" }), Value::Number)
}

fn repr(value: f64) -> &'static str {
    if value.is_nan() {
        "nan"
    } else if value > 0.0 {
        "inf"
    } else {
        "-inf"
    }
}
