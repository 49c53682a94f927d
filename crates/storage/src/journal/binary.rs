//! Items as bytes: a tag, then numbers as LEB128 (signed ones in zigzag), texts with their length before them.

use super::record::{
    Content, Definition, Item, Kept, Place, PlaceNumber, Record, Stored, ValueNumber,
};
use rafcon_protocol::{LogLevel, Stream};
use serde::Serialize;
use serde::de::DeserializeOwned;
use smol_str::SmolStr;
use std::num::NonZeroU64;

const ENTERED: u8 = 1;
const LEFT: u8 = 2;
const SCOPED: u8 = 3;
const GLOBAL: u8 = 4;
const PERSISTENT: u8 = 5;
const LOG: u8 = 6;
const TOLD: u8 = 7;
const PLACE: u8 = 8;
const VALUE: u8 = 9;

const LEVELS: [LogLevel; 5] =
    [LogLevel::Verbose, LogLevel::Debug, LogLevel::Info, LogLevel::Warning, LogLevel::Error];
const STREAMS: [Stream; 4] = [Stream::Stdout, Stream::Stderr, Stream::Logger, Stream::Engine];

/// Bytes that are no item.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not an item of a journal, {rest} bytes before the end: {what}")]
pub struct Broken {
    what: &'static str,
    rest: usize,
}

pub(super) struct Writer<'o> {
    out: &'o mut Vec<u8>,
}

impl<'o> Writer<'o> {
    pub(super) fn new(out: &'o mut Vec<u8>) -> Self {
        Self { out }
    }

    pub(super) fn record(&mut self, delta: u64, record: &Record) {
        match record {
            Record::Entered { place, inputs, undoes } => {
                self.head(ENTERED, delta, *place);
                self.list(inputs, Writer::kept);
                self.number(undoes.map_or(0, NonZeroU64::get));
            }
            Record::Left { place, outcome, outputs, error, undoes } => {
                self.head(LEFT, delta, *place);
                self.signed(*outcome);
                self.list(outputs, Writer::kept);
                self.maybe(error.as_ref(), Writer::kept);
                self.number(undoes.map_or(0, NonZeroU64::get));
            }
            Record::Scoped { place, port, value } => {
                self.head(SCOPED, delta, *place);
                self.number(*port);
                self.kept(value);
            }
            Record::Global { name, value } => {
                self.tag(GLOBAL, delta);
                self.text(name);
                self.maybe(value.as_ref(), Writer::kept);
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
            Record::Told(event) => {
                self.tag(TOLD, delta);
                self.json(event);
            }
        }
    }

    pub(super) fn definition(&mut self, definition: &Definition) {
        match definition {
            Definition::Place(number, place) => {
                self.out.push(PLACE);
                self.number(u64::from(number.0));
                self.place(place);
            }
            Definition::Value(number, stored) => {
                self.out.push(VALUE);
                self.number(number.0);
                self.stored(stored);
            }
        }
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

    fn stored(&mut self, stored: &Stored) {
        self.json(&stored.view);
        self.text(&stored.type_name);
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

    fn list<T>(&mut self, items: &[T], mut one: impl FnMut(&mut Self, &T)) {
        self.number(items.len() as u64);
        for item in items {
            one(self, item);
        }
    }

    fn maybe<T>(&mut self, item: Option<&T>, one: impl FnOnce(&mut Self, &T)) {
        self.out.push(u8::from(item.is_some()));
        if let Some(item) = item {
            one(self, item);
        }
    }

    /// A value of the protocol, which can always be written as JSON: its keys are strings.
    fn json(&mut self, value: &impl Serialize) {
        self.bytes(&serde_json::to_vec(value).unwrap_or_default());
    }

    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u64);
        self.out.extend_from_slice(bytes);
    }

    fn signed(&mut self, value: i64) {
        self.number(((value << 1) ^ (value >> 63)).cast_unsigned());
    }

    #[expect(clippy::cast_possible_truncation, reason = "the low seven bits are what is meant")]
    fn number(&mut self, mut value: u64) {
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

#[derive(Debug)]
pub(super) struct Reader<'b> {
    bytes: &'b [u8],
}

impl<'b> Reader<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Self { bytes }
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The next item; `t_ns` is the time of the record before it.
    pub(super) fn item(&mut self, t_ns: u64) -> Result<Item, Broken> {
        let tag = self.byte()?;
        match tag {
            PLACE => {
                let number = self.place_number()?;
                return Ok(Item::Definition(Definition::Place(number, self.place()?)));
            }
            VALUE => {
                let number = ValueNumber(self.number()?);
                return Ok(Item::Definition(Definition::Value(number, self.stored()?)));
            }
            _ => {}
        }
        let t_ns = t_ns.saturating_add(self.number()?);
        Ok(Item::Record(t_ns, self.record(tag)?))
    }

    fn record(&mut self, tag: u8) -> Result<Record, Broken> {
        Ok(match tag {
            ENTERED => Record::Entered {
                place: self.place_number()?,
                inputs: self.list(Self::kept)?,
                undoes: NonZeroU64::new(self.number()?),
            },
            LEFT => Record::Left {
                place: self.place_number()?,
                outcome: self.signed()?,
                outputs: self.list(Self::kept)?,
                error: self.maybe(Self::kept)?,
                undoes: NonZeroU64::new(self.number()?),
            },
            SCOPED => Record::Scoped {
                place: self.place_number()?,
                port: self.number()?,
                value: self.kept()?,
            },
            GLOBAL => Record::Global { name: self.text()?.into(), value: self.maybe(Self::kept)? },
            PERSISTENT => Record::Persistent { place: self.place_number()?, value: self.kept()? },
            LOG => self.log()?,
            TOLD => Record::Told(Box::new(self.json()?)),
            _ => return Err(self.broken("an unknown tag")),
        })
    }

    fn log(&mut self) -> Result<Record, Broken> {
        let place = self.number()?;
        let place =
            u32::try_from(place).map_err(|_short| self.broken("a place that is too large"))?;
        let (level, stream) = (self.one_of(&LEVELS)?, self.one_of(&STREAMS)?);
        let place = place.checked_sub(1).map(PlaceNumber);
        Ok(Record::Log { place, level, stream, message: self.text()?.to_owned() })
    }

    fn place(&mut self) -> Result<Place, Broken> {
        let (path, names) = (self.text()?.to_owned(), self.text()?.to_owned());
        let flags = self.byte()?;
        let port = |r: &mut Self| Ok((r.number()?, SmolStr::from(r.text()?)));
        Ok(Place {
            path,
            names,
            is_library: flags & 1 != 0,
            is_script: flags & 2 != 0,
            inputs: self.list(port)?,
            outputs: self.list(port)?,
            scoped: self.list(port)?,
            outcomes: self.list(|r| Ok((r.signed()?, SmolStr::from(r.text()?))))?,
        })
    }

    fn stored(&mut self) -> Result<Stored, Broken> {
        let (view, type_name) = (self.json()?, SmolStr::from(self.text()?));
        let content = match self.byte()? {
            0 => Content::View,
            1 => Content::Pickle(self.bytes()?.to_vec()),
            2 => Content::File { hash: self.text()?.to_owned(), size: self.number()? },
            3 => Content::Nothing(self.text()?.to_owned()),
            _ => return Err(self.broken("an unknown kind of content")),
        };
        Ok(Stored { view, type_name, content })
    }

    fn kept(&mut self) -> Result<Kept, Broken> {
        Ok(match self.byte()? {
            0 => Kept::Absent,
            1 => Kept::None,
            2 => Kept::Bool(false),
            3 => Kept::Bool(true),
            4 => Kept::Int(self.signed()?),
            5 => {
                let bytes =
                    self.take(8)?.try_into().map_err(|_short| self.broken("a short float"))?;
                Kept::Float(f64::from_bits(u64::from_le_bytes(bytes)))
            }
            6 => Kept::Text(self.text()?.into()),
            7 => Kept::Value(ValueNumber(self.number()?)),
            _ => return Err(self.broken("an unknown kind of value")),
        })
    }

    fn list<T>(
        &mut self,
        mut one: impl FnMut(&mut Self) -> Result<T, Broken>,
    ) -> Result<Vec<T>, Broken> {
        let count = self.number()?;
        // Each takes a byte at least, so a broken count cannot ask for more than there is.
        if count > self.bytes.len() as u64 {
            return Err(self.broken("a list longer than its bytes"));
        }
        (0..count).map(|_| one(self)).collect()
    }

    fn maybe<T>(
        &mut self,
        one: impl FnOnce(&mut Self) -> Result<T, Broken>,
    ) -> Result<Option<T>, Broken> {
        match self.byte()? {
            0 => Ok(None),
            1 => one(self).map(Some),
            _ => Err(self.broken("neither there nor missing")),
        }
    }

    fn place_number(&mut self) -> Result<PlaceNumber, Broken> {
        let number = self.number()?;
        let number =
            u32::try_from(number).map_err(|_short| self.broken("a place that is too large"))?;
        Ok(PlaceNumber(number))
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> Result<T, Broken> {
        let index = usize::from(self.byte()?);
        all.get(index).copied().ok_or_else(|| self.broken("an unknown choice"))
    }

    fn json<T: DeserializeOwned>(&mut self) -> Result<T, Broken> {
        let bytes = self.bytes()?;
        serde_json::from_slice(bytes).map_err(|_short| self.broken("JSON of another kind"))
    }

    fn text(&mut self) -> Result<&'b str, Broken> {
        let bytes = self.bytes()?;
        std::str::from_utf8(bytes).map_err(|_short| self.broken("a text that is not UTF-8"))
    }

    fn bytes(&mut self) -> Result<&'b [u8], Broken> {
        let count = self.number()?;
        let count = usize::try_from(count).map_err(|_short| self.broken("too many bytes"))?;
        self.take(count)
    }

    fn take(&mut self, count: usize) -> Result<&'b [u8], Broken> {
        let (taken, rest) =
            self.bytes.split_at_checked(count).ok_or_else(|| self.broken("cut off"))?;
        self.bytes = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, Broken> {
        Ok(self.take(1)?[0])
    }

    fn signed(&mut self) -> Result<i64, Broken> {
        let value = self.number()?;
        Ok((value >> 1).cast_signed() ^ -(value & 1).cast_signed())
    }

    fn number(&mut self) -> Result<u64, Broken> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(self.broken("a number that is too long"))
    }

    fn broken(&self, what: &'static str) -> Broken {
        Broken { what, rest: self.bytes.len() }
    }
}

#[cfg(test)]
mod tests {
    use crate::journal::record::{
        Content, Definition, Item, Items, Kept, Place, PlaceNumber, Record, Stored, ValueNumber,
    };
    use proptest::prelude::*;
    use rafcon_protocol::{Event, LogLevel, Stream};
    use serde_json::json;

    fn kept() -> impl Strategy<Value = Kept> {
        prop_oneof![
            Just(Kept::Absent),
            Just(Kept::None),
            any::<bool>().prop_map(Kept::Bool),
            any::<i64>().prop_map(Kept::Int),
            (-1e300..1e300).prop_map(Kept::Float),
            ".{0,16}".prop_map(|text| Kept::Text(text.into())),
            any::<u64>().prop_map(|number| Kept::Value(ValueNumber(number))),
        ]
    }

    fn record() -> impl Strategy<Value = Record> {
        let place = || any::<u32>().prop_map(PlaceNumber);
        let list = || prop::collection::vec(kept(), 0..4);
        prop_oneof![
            (place(), list(), any::<u64>()).prop_map(|(place, inputs, undoes)| Record::Entered {
                place,
                inputs,
                undoes: undoes.try_into().ok()
            }),
            (place(), any::<i64>(), list(), prop::option::of(kept())).prop_map(
                |(place, outcome, outputs, error)| Record::Left {
                    place,
                    outcome,
                    outputs,
                    error,
                    undoes: None
                }
            ),
            (place(), any::<u64>(), kept()).prop_map(|(place, port, value)| Record::Scoped {
                place,
                port,
                value
            }),
            (".*", prop::option::of(kept()))
                .prop_map(|(name, value)| Record::Global { name: name.into(), value }),
            (place(), kept()).prop_map(|(place, value)| Record::Persistent { place, value }),
            ".*".prop_map(|message| Record::Log {
                place: None,
                level: LogLevel::Warning,
                stream: Stream::Stderr,
                message
            }),
            Just(Record::Told(Box::new(Event::Stopping))),
        ]
    }

    fn items() -> impl Strategy<Value = Item> {
        let place = Place {
            path: "A/B".to_owned(),
            names: "root/scan".to_owned(),
            is_library: false,
            is_script: true,
            inputs: vec![(0, "in".into())],
            outputs: vec![(7, "out".into())],
            scoped: vec![],
            outcomes: vec![(-1, "aborted".into()), (0, "done".into())],
        };
        let contents = [
            Content::View,
            Content::Pickle(vec![0, 255]),
            Content::File { hash: "ab".to_owned(), size: 300 },
            Content::Nothing("a lock".to_owned()),
        ];
        let stored = prop::sample::select(contents.to_vec()).prop_map(|content| {
            let stored =
                Stored { view: json!({"__repr__": "x"}), type_name: "Lock".into(), content };
            Item::Definition(Definition::Value(ValueNumber(300), stored))
        });
        prop_oneof![
            4 => (0..u64::MAX / 2, record()).prop_map(|(t_ns, record)| Item::Record(t_ns, record)),
            1 => Just(Item::Definition(Definition::Place(PlaceNumber(9), place))),
            1 => stored,
        ]
    }

    proptest! {
        #[test]
        fn items_are_read_as_they_were_written(items in prop::collection::vec(items(), 0..8)) {
            let (mut bytes, mut before, mut latest) = (Vec::new(), 5, 5);
            let mut expected = Vec::new();
            for item in items {
                item.write(&mut before, &mut bytes);
                expected.push(match item {
                    Item::Record(t_ns, record) => {
                        latest = latest.max(t_ns);
                        Item::Record(latest, record)
                    }
                    definition @ Item::Definition(_) => definition,
                });
            }
            let read: Vec<Item> = Items::new(&bytes, 5).map(Result::unwrap).collect();
            prop_assert_eq!(read, expected);
        }

        #[test]
        fn any_bytes_are_read_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
            prop_assert!(Items::new(&bytes, 0).count() <= bytes.len());
        }
    }
}
