//! Events as sent by a runner: the encoded items of its journal, each definition before the first event that uses it. Handles bytes
//! and numbers, not senders or readers.
//!
//! Values come without their content. A reader receives their views.

mod definitions;
mod reader;
#[cfg(test)]
mod tests;

pub use definitions::{PlaceHistory, StreamDefinitions};
pub use reader::{BadFrame, StreamReader};

use crate::journal::record::binary::{BinaryReader, BinaryWriter, Broken, Sent};
use crate::journal::record::{Place, PlaceNumber, Record, ValueNumber};

/// An event uses a value at most this many events after its definition; later, the value is defined again. So the journal
/// and a reader of the stream may drop a value together with the events that can use it.
pub const VALUE_LIFE: u64 = 100_000;

/// Content of a value in a stream, which is empty.
pub const NO_CONTENT: [u8; 2] = [3, 0];

/// Consecutive events in a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StreamBlock<'b> {
    /// Number of the first event.
    pub first: u64,
    /// Time of the event before it, in ns.
    pub t_before: u64,
    /// Events and the definitions that they need, as [`crate::journal::Item`]s.
    pub items: &'b [u8],
}

/// One item of a block.
#[derive(Debug)]
pub enum StreamItem<'b> {
    /// Definition of a place from event `from` on.
    Place {
        /// First event that it applies to.
        from: u64,
        /// Number of the place.
        number: PlaceNumber,
        /// Place that the number denotes.
        place: Place,
    },
    /// Definition of a value from event `from` on.
    Value {
        /// First event that it applies to.
        from: u64,
        /// Number of the value.
        number: ValueNumber,
        /// Value in the encoding of [`crate::journal::Stored::from_bytes`].
        stored: &'b [u8],
    },
    /// An event of the run.
    Event {
        /// Number of the event.
        sequence: u64,
        /// Time of the event, in ns since the start of the run.
        t_ns: u64,
        /// Content of the event.
        record: Record,
        /// Encoded record of the event.
        bytes: &'b [u8],
    },
}

impl<'b> StreamBlock<'b> {
    /// Appends the encoded block to `out`.
    pub fn write(&self, out: &mut Vec<u8>) {
        let mut writer = BinaryWriter::new(out);
        writer.number(self.first);
        writer.number(self.t_before);
        writer.bytes(self.items);
    }

    /// Returns all blocks in `bytes`, up to the first invalid one.
    pub fn read_all(bytes: &'b [u8]) -> impl Iterator<Item = Result<Self, Broken>> {
        let mut reader = BinaryReader::new(bytes);
        std::iter::from_fn(move || {
            let block = (!reader.is_at_end()).then(|| Self::read(&mut reader))?;
            if block.is_err() {
                reader = BinaryReader::new(&[]);
            }
            Some(block)
        })
    }

    fn read(reader: &mut BinaryReader<'b>) -> Result<Self, Broken> {
        let (first, t_before) = (reader.number()?, reader.number()?);
        Ok(Self { first, t_before, items: reader.bytes()? })
    }

    /// Returns the items in order, up to the first invalid one.
    pub fn items(&self) -> StreamItems<'b> {
        let reader = BinaryReader::new(self.items);
        StreamItems { reader, sequence: self.first, t_ns: self.t_before }
    }
}

/// Reader for the items of a block.
#[derive(Debug)]
pub struct StreamItems<'b> {
    reader: BinaryReader<'b>,
    sequence: u64,
    t_ns: u64,
}

impl<'b> StreamItems<'b> {
    fn read(&mut self) -> Result<StreamItem<'b>, Broken> {
        let before = self.reader.rest();
        let from = self.sequence;
        Ok(match self.reader.sent(self.t_ns)? {
            Sent::Place(number, place) => StreamItem::Place { from, number, place },
            Sent::Value(number, stored) => StreamItem::Value { from, number, stored },
            Sent::Record(t_ns, record) => {
                self.t_ns = t_ns;
                self.sequence = from
                    .checked_add(1)
                    .ok_or_else(|| self.reader.broken("too large a number of an event"))?;
                let bytes = &before[..before.len() - self.reader.rest().len()];
                StreamItem::Event { sequence: from, t_ns, record, bytes }
            }
        })
    }

    /// Returns the number of the next event, the time of the previous one, and the number of remaining bytes.
    pub fn position(&self) -> (u64, u64, usize) {
        (self.sequence, self.t_ns, self.reader.rest().len())
    }
}

impl<'b> Iterator for StreamItems<'b> {
    type Item = Result<StreamItem<'b>, Broken>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.reader.is_at_end() {
            return None;
        }
        let item = self.read();
        if item.is_err() {
            self.reader = BinaryReader::new(&[]);
        }
        Some(item)
    }
}

/// Appends the definition of a place to the items of a stream.
pub fn write_place(number: PlaceNumber, place: &Place, out: &mut Vec<u8>) {
    BinaryWriter::new(out).place_definition(number, place);
}
