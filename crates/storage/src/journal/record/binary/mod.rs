//! Items as bytes: a tag, then numbers as LEB128 (signed ones in zigzag), texts with their length before them.

#[cfg(test)]
mod tests;
mod writer;

pub(in crate::journal) use writer::BinaryWriter;

use crate::journal::record::{
    Content, Definition, Item, Kept, Place, PlaceNumber, Record, Stored, ValueNumber,
};
use rafcon_protocol::{LogLevel, Stream};
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
const WENT_BACK: u8 = 10;

/// Maximum number of list items for which memory is reserved in advance, because a length can be wrong.
const LIST_RESERVED: usize = 64;

const LEVELS: [LogLevel; 5] =
    [LogLevel::Verbose, LogLevel::Debug, LogLevel::Info, LogLevel::Warning, LogLevel::Error];
const STREAMS: [Stream; 4] = [Stream::Stdout, Stream::Stderr, Stream::Logger, Stream::Engine];

/// The bytes are not an item.
///
/// The error is one pointer, so that numeric results stay in registers and journals are read faster.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not an item of a journal, {} bytes before the end: {}", .0.rest, .0.what)]
pub struct Broken(Box<Wrong>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Wrong {
    what: &'static str,
    rest: usize,
}

/// An item of a stream.
#[derive(Debug)]
pub(in crate::journal) enum Sent<'b> {
    Place(PlaceNumber, Place),
    /// An encoded value from [`Stored::to_bytes`].
    Value(ValueNumber, &'b [u8]),
    Record(u64, Record),
}

#[derive(Debug)]
pub(in crate::journal) struct BinaryReader<'b> {
    bytes: &'b [u8],
    skips_values: bool,
}

impl<'b> BinaryReader<'b> {
    pub(in crate::journal) fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, skips_values: false }
    }

    /// Creates a reader that skips the values of ports and variables. Errors of states are read.
    pub(in crate::journal) fn without_values(bytes: &'b [u8]) -> Self {
        Self { bytes, skips_values: true }
    }

    pub(in crate::journal) fn is_at_end(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Reads the next item. `t_ns` is the time of the record before it.
    pub(in crate::journal) fn item(&mut self, t_ns: u64) -> Result<Item, Broken> {
        let tag = self.byte()?;
        Ok(match tag {
            PLACE => {
                let number = self.place_number()?;
                Item::Definition(Definition::Place(number, self.place()?))
            }
            VALUE => {
                let number = ValueNumber(self.number()?);
                Item::Definition(Definition::Value(number, self.stored()?))
            }
            _ => {
                let (t_ns, record) = self.timed_record(tag, t_ns)?;
                Item::Record(t_ns, record)
            }
        })
    }

    /// Reads the next record with its time, where no definitions occur. Most of a journal consists of records, which are smaller
    /// than items.
    pub(in crate::journal) fn next_record(&mut self, t_ns: u64) -> Result<(u64, Record), Broken> {
        let tag = self.byte()?;
        self.timed_record(tag, t_ns)
    }

    fn timed_record(&mut self, tag: u8, t_ns: u64) -> Result<(u64, Record), Broken> {
        let t_ns = t_ns.saturating_add(self.number()?);
        Ok((t_ns, self.record(tag)?))
    }

    /// Reads the next item of a stream. `t_ns` is the time of the record before it. Values remain encoded.
    pub(in crate::journal) fn sent(&mut self, t_ns: u64) -> Result<Sent<'b>, Broken> {
        if self.bytes.first() == Some(&VALUE) {
            self.byte()?;
            return Ok(Sent::Value(ValueNumber(self.number()?), self.stored_bytes()?));
        }
        Ok(match self.item(t_ns)? {
            Item::Definition(Definition::Place(number, place)) => Sent::Place(number, place),
            Item::Definition(Definition::Value(..)) => return Err(self.broken("a value")),
            Item::Record(t_ns, record) => Sent::Record(t_ns, record),
        })
    }

    fn stored_bytes(&mut self) -> Result<&'b [u8], Broken> {
        let from = self.bytes;
        self.bytes()?;
        self.text()?;
        self.content()?;
        Ok(&from[..from.len() - self.bytes.len()])
    }

    /// Returns the bytes that have not been read yet.
    pub(in crate::journal) fn rest(&self) -> &'b [u8] {
        self.bytes
    }

    fn record(&mut self, tag: u8) -> Result<Record, Broken> {
        Ok(match tag {
            ENTERED => Record::Entered {
                place: self.place_number()?,
                inputs: self.values()?,
                undoes: NonZeroU64::new(self.number()?),
            },
            LEFT => Record::Left {
                place: self.place_number()?,
                outcome: self.signed()?,
                outputs: self.values()?,
                error: self.maybe(Self::kept)?,
                undoes: NonZeroU64::new(self.number()?),
            },
            SCOPED => Record::Scoped {
                place: self.place_number()?,
                port: self.number()?,
                value: self.value()?,
            },
            GLOBAL => Record::Global { name: self.text()?.into(), value: self.maybe(Self::value)? },
            PERSISTENT => Record::Persistent { place: self.place_number()?, value: self.value()? },
            LOG => self.log()?,
            WENT_BACK => {
                Record::WentBack { sequence: self.number()?, moment: self.bytes()?.to_vec() }
            }
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

    pub(in crate::journal) fn stored(&mut self) -> Result<Stored, Broken> {
        let (view, type_name) = (self.json()?, SmolStr::from(self.text()?));
        Ok(Stored { view, type_name, content: self.content()? })
    }

    fn content(&mut self) -> Result<Content, Broken> {
        Ok(match self.byte()? {
            0 => Content::View,
            1 => Content::Pickle(self.bytes()?.to_vec()),
            2 => Content::File { hash: self.text()?.to_owned(), size: self.number()? },
            3 => Content::Nothing(self.text()?.to_owned()),
            _ => return Err(self.broken("an unknown kind of content")),
        })
    }

    fn values(&mut self) -> Result<Vec<Kept>, Broken> {
        if !self.skips_values {
            return self.list(Self::kept);
        }
        for _ in 0..self.count()? {
            self.skip_value()?;
        }
        Ok(Vec::new())
    }

    fn value(&mut self) -> Result<Kept, Broken> {
        if self.skips_values { self.skip_value().map(|()| Kept::Absent) } else { self.kept() }
    }

    fn skip_value(&mut self) -> Result<(), Broken> {
        match self.byte()? {
            0..=3 => {}
            4 | 7 => drop(self.number()?),
            5 => drop(self.take(8)?),
            6 => drop(self.bytes()?),
            _ => return Err(self.broken("an unknown kind of value")),
        }
        Ok(())
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

    pub(in crate::journal) fn list<T>(
        &mut self,
        mut one: impl FnMut(&mut Self) -> Result<T, Broken>,
    ) -> Result<Vec<T>, Broken> {
        let count = self.count()?;
        let mut list = Vec::with_capacity(count.min(LIST_RESERVED));
        for _ in 0..count {
            list.push(one(self)?);
        }
        Ok(list)
    }

    /// Reads the length of a list. Each item has at least one byte, so an invalid length cannot exceed the input.
    fn count(&mut self) -> Result<usize, Broken> {
        let count = self.number()?;
        let fitting = usize::try_from(count).ok().filter(|count| *count <= self.bytes.len());
        fitting.ok_or_else(|| self.broken("a list longer than its bytes"))
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

    pub(in crate::journal) fn text(&mut self) -> Result<&'b str, Broken> {
        let bytes = self.bytes()?;
        std::str::from_utf8(bytes).map_err(|_short| self.broken("a text that is not UTF-8"))
    }

    pub(in crate::journal) fn bytes(&mut self) -> Result<&'b [u8], Broken> {
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

    #[inline]
    fn byte(&mut self) -> Result<u8, Broken> {
        let (byte, rest) = self.bytes.split_first().ok_or_else(|| self.broken("cut off"))?;
        self.bytes = rest;
        Ok(*byte)
    }

    fn signed(&mut self) -> Result<i64, Broken> {
        let value = self.number()?;
        Ok((value >> 1).cast_signed() ^ -(value & 1).cast_signed())
    }

    #[inline]
    pub(in crate::journal) fn number(&mut self) -> Result<u64, Broken> {
        // Most numbers have one byte.
        let first = self.byte()?;
        if first < 0x80 { Ok(u64::from(first)) } else { self.longer_number(first) }
    }

    fn longer_number(&mut self, first: u8) -> Result<u64, Broken> {
        let mut value = u64::from(first & 0x7f);
        for shift in (7..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(self.broken("a number that is too long"))
    }

    pub(in crate::journal) fn broken(&self, what: &'static str) -> Broken {
        Broken(Box::new(Wrong { what, rest: self.bytes.len() }))
    }
}
