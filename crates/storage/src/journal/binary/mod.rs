//! Items as bytes: a tag, then numbers as LEB128 (signed ones in zigzag), texts with their length before them.

mod reader;
#[cfg(test)]
mod tests;
mod writer;

pub(super) use reader::{BinaryReader, Sent};
pub(super) use writer::BinaryWriter;

use rafcon_protocol::{LogLevel, Stream};

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
