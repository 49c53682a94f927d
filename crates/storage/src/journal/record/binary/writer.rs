//! Encodes items. Handles the encoding of each part, not the destination of the bytes.

use super::{
    ENTERED, GLOBAL, LEFT, LEVELS, LOG, PERSISTENT, PLACE, SCOPED, STREAMS, TOLD, VALUE, WENT_BACK,
};
use crate::journal::record::{
    Content, Definition, Kept, Left, Place, PlaceNumber, Record, Stored, ValueNumber,
};
use serde::Serialize;
use std::borrow::Borrow;
use std::num::NonZeroU64;

pub(in crate::journal) struct BinaryWriter<'o> {
    out: &'o mut Vec<u8>,
}

impl<'o> BinaryWriter<'o> {
    pub(in crate::journal) fn new(out: &'o mut Vec<u8>) -> Self {
        Self { out }
    }

    pub(in crate::journal) fn record(&mut self, delta: u64, record: &Record) {
        match record {
            Record::Entered { place, inputs, undoes } => {
                self.entered(delta, *place, inputs, *undoes);
            }
            Record::Left { place, outcome, outputs, error, undoes } => {
                let (place, outcome, error, undoes) = (*place, *outcome, error.as_ref(), *undoes);
                self.left(delta, Left { place, outcome, outputs, error, undoes });
            }
            Record::Scoped { place, port, value } => self.scoped(delta, *place, *port, value),
            Record::Global { name, value } => {
                self.tag(GLOBAL, delta);
                self.text(name);
                self.maybe(value.as_ref(), BinaryWriter::kept);
            }
            Record::Persistent { place, value } => {
                self.head(PERSISTENT, delta, *place);
                self.kept(value);
            }
            Record::Log { place, level, stream, message } => {
                self.tag(LOG, delta);
                self.number(place.map_or(0, |place| u64::from(place.0) + 1));
                self.number(position(&LEVELS, level));
                self.number(position(&STREAMS, stream));
                self.text(message);
            }
            Record::WentBack { sequence, moment } => {
                self.tag(WENT_BACK, delta);
                self.number(*sequence);
                self.bytes(moment);
            }
            Record::Told(event) => {
                self.tag(TOLD, delta);
                self.json(event);
            }
        }
    }

    pub(in crate::journal) fn entered(
        &mut self,
        delta: u64,
        place: PlaceNumber,
        inputs: impl IntoIterator<Item = impl Borrow<Kept>>,
        undoes: Option<NonZeroU64>,
    ) {
        self.head(ENTERED, delta, place);
        self.values(inputs);
        self.number(undoes.map_or(0, NonZeroU64::get));
    }

    pub(in crate::journal) fn left(
        &mut self,
        delta: u64,
        left: Left<'_, impl IntoIterator<Item = impl Borrow<Kept>>>,
    ) {
        self.head(LEFT, delta, left.place);
        self.signed(left.outcome);
        self.values(left.outputs);
        self.maybe(left.error, BinaryWriter::kept);
        self.number(left.undoes.map_or(0, NonZeroU64::get));
    }

    pub(in crate::journal) fn scoped(
        &mut self,
        delta: u64,
        place: PlaceNumber,
        port: u64,
        value: &Kept,
    ) {
        self.head(SCOPED, delta, place);
        self.number(port);
        self.kept(value);
    }

    pub(in crate::journal) fn definition(&mut self, definition: &Definition) {
        match definition {
            Definition::Place(number, place) => self.place_definition(*number, place),
            Definition::Value(number, stored) => {
                self.value_definition(*number, stored);
            }
        }
    }

    pub(in crate::journal) fn place_definition(&mut self, number: PlaceNumber, place: &Place) {
        self.out.push(PLACE);
        self.number(u64::from(number.0));
        self.place(place);
    }

    /// Returns the offset of the content.
    pub(in crate::journal) fn value_definition(
        &mut self,
        number: ValueNumber,
        stored: &Stored,
    ) -> usize {
        self.out.push(VALUE);
        self.number(number.0);
        self.stored(stored)
    }

    fn tag(&mut self, tag: u8, delta: u64) {
        self.out.push(tag);
        self.number(delta);
    }

    fn head(&mut self, tag: u8, delta: u64, place: PlaceNumber) {
        self.tag(tag, delta);
        self.number(u64::from(place.0));
    }

    fn place(&mut self, place: &Place) {
        self.text(&place.path);
        self.text(&place.names);
        self.out.push(u8::from(place.is_library) | u8::from(place.is_script) << 1);
        for ports in [&place.inputs, &place.outputs, &place.scoped] {
            self.list(ports, |w, (id, name)| {
                w.number(*id);
                w.text(name);
            });
        }
        self.list(&place.outcomes, |w, (id, name)| {
            w.signed(*id);
            w.text(name);
        });
    }

    /// Returns the offset of the content.
    pub(in crate::journal) fn stored(&mut self, stored: &Stored) -> usize {
        self.json(&stored.view);
        self.text(&stored.type_name);
        let content = self.out.len();
        match &stored.content {
            Content::View => self.out.push(0),
            Content::Pickle(bytes) => {
                self.out.push(1);
                self.bytes(bytes);
            }
            Content::File { hash, size } => {
                self.out.push(2);
                self.text(hash);
                self.number(*size);
            }
            Content::Nothing(why) => {
                self.out.push(3);
                self.text(why);
            }
        }
        content
    }

    fn kept(&mut self, value: &Kept) {
        match value {
            Kept::Absent => self.out.push(0),
            Kept::None => self.out.push(1),
            Kept::Bool(value) => self.out.push(2 + u8::from(*value)),
            Kept::Int(value) => {
                self.out.push(4);
                self.signed(*value);
            }
            Kept::Float(value) => {
                self.out.push(5);
                self.out.extend_from_slice(&value.to_bits().to_le_bytes());
            }
            Kept::Text(text) => {
                self.out.push(6);
                self.text(text);
            }
            Kept::Value(number) => {
                self.out.push(7);
                self.number(number.0);
            }
        }
    }

    pub(in crate::journal) fn list<T>(&mut self, items: &[T], mut one: impl FnMut(&mut Self, &T)) {
        self.number(items.len() as u64);
        for item in items {
            one(self, item);
        }
    }

    /// Writes a list whose length is known only at its end.
    fn values(&mut self, values: impl IntoIterator<Item = impl Borrow<Kept>>) {
        let at = self.out.len();
        self.out.push(0);
        let mut count = 0_u64;
        for value in values {
            self.kept(value.borrow());
            count += 1;
        }
        match u8::try_from(count) {
            Ok(count) if count < 0x80 => self.out[at] = count,
            _ => self.correct_length(at, count),
        }
    }

    /// Replaces the byte at `at` by a longer length.
    fn correct_length(&mut self, at: usize, count: u64) {
        let mut length = Vec::new();
        BinaryWriter::new(&mut length).number(count);
        self.out.splice(at..=at, length);
    }

    fn maybe<T>(&mut self, item: Option<&T>, one: impl FnOnce(&mut Self, &T)) {
        self.out.push(u8::from(item.is_some()));
        if let Some(item) = item {
            one(self, item);
        }
    }

    /// Writes a value of the protocol as JSON. This cannot fail, because its keys are strings.
    fn json(&mut self, value: &impl Serialize) {
        self.bytes(&serde_json::to_vec(value).unwrap_or_default());
    }

    pub(in crate::journal) fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    pub(in crate::journal) fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u64);
        self.out.extend_from_slice(bytes);
    }

    fn signed(&mut self, value: i64) {
        self.number(((value << 1) ^ (value >> 63)).cast_unsigned());
    }

    #[expect(clippy::cast_possible_truncation, reason = "the low seven bits are what is meant")]
    pub(in crate::journal) fn number(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.out.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.out.push(value as u8);
    }
}

fn position<T: PartialEq>(all: &[T], one: &T) -> u64 {
    all.iter().position(|other| other == one).unwrap_or_default() as u64
}
