//! Frames of requests besides events: the newest values of data ports, and large values by their hash.

use super::{StreamId, read_part, read_ranges, write_ranges};
use crate::bytes::{BrokenFrame, FrameReader, write_bytes, write_number};
use crate::range_set::RangeSet;

/// By what both sides name a large value: the first bytes of the BLAKE3 hash of its bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ValueId(pub [u8; 16]);

/// Location of a large value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ValueName {
    /// Its run.
    pub stream: StreamId,
    /// Its number in the journal of the run.
    pub number: u64,
    /// By what it is known to be that value.
    pub id: ValueId,
}

/// Reason why a large value, or the rest of it, is not sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoValue {
    /// The robot does not have it, or does not any more.
    Gone,
    /// It costs more than the station allowed.
    OverBudget,
}

/// A station requests a large value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fetch {
    pub(crate) value: ValueName,
    /// Number of bytes that may be in flight.
    pub(crate) budget: u64,
    /// Which bytes of it the station has; the first one is 1.
    pub(crate) here: RangeSet,
}

/// A part of a large value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ValuePart<'b> {
    pub(crate) id: ValueId,
    pub(crate) offset: u64,
    pub(crate) bytes: &'b [u8],
}

/// Part of a station's list of watched values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct WatchPart<'b> {
    pub(crate) stream: StreamId,
    /// Number of the list. It grows with each list.
    pub(crate) number: u64,
    pub(crate) length: u32,
    pub(crate) offset: u32,
    pub(crate) bytes: &'b [u8],
}

/// The newest watched values, with the list in force.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Watched<'b> {
    pub(crate) stream: StreamId,
    /// Number of the list in force.
    pub(crate) number: u64,
    /// Values, each with its length before it.
    pub(crate) values: &'b [u8],
}

/// A request or its answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ValueFrame<'b> {
    ValuePart(ValuePart<'b>),
    /// A large value does not come.
    NoValue(ValueId, NoValue),
    Watched(Watched<'b>),
    Fetch(Fetch),
    Watch(WatchPart<'b>),
}

const VALUE_PART: u8 = 13;
const NO_VALUE: u8 = 14;
const WATCHED: u8 = 15;
const FETCH: u8 = 19;
const WATCH: u8 = 20;

impl<'b> ValueFrame<'b> {
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let mut head = |kind: u8, id: Option<ValueId>, numbers: &[u64]| {
            out.push(kind);
            out.extend(id.into_iter().flat_map(|id| id.0));
            for number in numbers {
                write_number(*number, out);
            }
        };
        match self {
            Self::ValuePart(ValuePart { id, offset, bytes }) => {
                head(VALUE_PART, Some(*id), &[*offset]);
                write_bytes(bytes, out);
            }
            Self::NoValue(id, why) => head(NO_VALUE, Some(*id), &[*why as u64]),
            Self::Watched(Watched { stream, number, values }) => {
                head(WATCHED, None, &[u64::from(stream.0), *number]);
                write_bytes(values, out);
            }
            Self::Fetch(Fetch { value: ValueName { stream, number, id }, budget, here }) => {
                head(FETCH, Some(*id), &[u64::from(stream.0), *number, *budget]);
                write_ranges(here, out);
            }
            Self::Watch(WatchPart { stream, number, length, offset, bytes }) => {
                let [length, offset] = [*length, *offset].map(u64::from);
                head(WATCH, None, &[u64::from(stream.0), *number, length, offset]);
                write_bytes(bytes, out);
            }
        }
    }

    pub(super) fn read(kind: u8, reader: &mut FrameReader<'b>) -> Result<Self, BrokenFrame> {
        Ok(match kind {
            VALUE_PART => {
                let id = ValueId(reader.fixed()?);
                let (offset, bytes) = (reader.number()?, reader.bytes()?);
                if offset.checked_add(bytes.len() as u64).is_none() {
                    return Err(BrokenFrame("a number is too large"));
                }
                Self::ValuePart(ValuePart { id, offset, bytes })
            }
            NO_VALUE => {
                let id = ValueId(reader.fixed()?);
                let why = match reader.number()? {
                    0 => NoValue::Gone,
                    1 => NoValue::OverBudget,
                    _ => return Err(BrokenFrame("an unknown reason why a value does not come")),
                };
                Self::NoValue(id, why)
            }
            WATCHED => {
                let (stream, number) = (StreamId(reader.small()?), reader.number()?);
                Self::Watched(Watched { stream, number, values: reader.bytes()? })
            }
            FETCH => {
                let id = ValueId(reader.fixed()?);
                let (stream, number) = (StreamId(reader.small()?), reader.number()?);
                let value = ValueName { stream, number, id };
                Self::Fetch(Fetch { value, budget: reader.number()?, here: read_ranges(reader)? })
            }
            WATCH => {
                let (stream, number) = (StreamId(reader.small()?), reader.number()?);
                let (length, offset, bytes) = read_part(reader)?;
                Self::Watch(WatchPart { stream, number, length, offset, bytes })
            }
            _ => return Err(BrokenFrame("an unknown kind")),
        })
    }

    /// Its kind, as people call it.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::ValuePart(_) | Self::NoValue(..) => "large values",
            Self::Watched(_) => "watched values",
            Self::Fetch(_) | Self::Watch(_) => "wishes",
        }
    }
}

impl ValuePart<'_> {
    /// Overhead of a part in bytes.
    pub(crate) const HEAD_MAX: usize = 1 + 16 + 10 + 3;
}

impl Watched<'_> {
    /// Parses the values. `None` if they are damaged.
    pub(crate) fn values(&self) -> Option<Vec<Vec<u8>>> {
        let (mut reader, mut values) = (FrameReader::new(self.values), Vec::new());
        while reader.left() > 0 {
            values.push(reader.bytes().ok()?.to_vec());
        }
        Some(values)
    }
}
