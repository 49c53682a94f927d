//! Content of an opened datagram: the time of its sender, then frames. `docs/link.md` defines the format.

mod command;
mod received;
mod values;

pub(crate) use command::{Body, Command, CommandPart, PartsHere, Terms};
pub use command::{BriefId, COMMAND_LENGTH_MAX, CommandId};
pub(crate) use received::{PartialEvent, Received};
use received::{RECEIVED, read_ranges, read_received, write_ranges, write_received};
pub(crate) use values::{Fetch, ValueFrame, ValuePart, WatchPart, Watched};
pub use values::{NoValue, ValueId, ValueName};

use crate::bytes::{BrokenFrame, FrameReader, number_length, write_bytes, write_number};
use crate::coding::ContextId;
use crate::range_set::RangeSet;
use crate::seal::{Generation, KeyId, PairingKey};
use rafcon_events::EventBlockRef;

/// Number of a robot's run, fixed as long as the robot keeps the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StreamId(pub u32);

impl StreamId {
    /// The stream of files with this hash: no run has such a number.
    pub fn of_files(hash: u32) -> Self {
        Self(hash & !3 | 2)
    }

    /// True if the stream holds files instead of events.
    pub fn is_files(self) -> bool {
        self.0 % 4 == 2
    }
}

/// The longest bytes of a block that fit into a frame of `room` bytes.
pub(crate) fn block_bytes_max(room: usize, first_sequence: u64, time_before: u64) -> usize {
    let most = [u64::from(u32::MAX), first_sequence, 9_999, time_before, 9_999, 9_999];
    let numbers: usize = most.into_iter().map(number_length).sum();
    room.saturating_sub(1 + size_of::<ContextId>() + numbers)
}

/// The hash of all events of a run up to one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EventHash {
    /// The number of that event, from 1.
    pub last: u64,
    /// The hash.
    pub hash: u64,
}

/// Fate of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum CommandState {
    /// The robot has it.
    Received,
    /// The run carries it out.
    Started,
    /// It was carried out.
    Done,
    /// The robot refused it.
    Refused,
    /// It came after its time, and was not carried out.
    Expired,
}

impl CommandState {
    const ALL: [Self; 5] =
        [Self::Received, Self::Started, Self::Done, Self::Refused, Self::Expired];
}

/// Packing of the items of an event that is sent in parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Packing {
    #[default]
    Plain,
    Deflated,
    /// By the model coder.
    Coded {
        /// Context that decodes the items.
        context: ContextId,
        /// Length of the items in bytes.
        length: u32,
    },
}

/// A part of a datagram.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Frame<'b> {
    /// Events, new or again.
    Events {
        /// The run.
        stream: StreamId,
        /// The events.
        block: EventBlockRef<'b>,
    },
    /// Events whose items are coded.
    Coded {
        /// Context that decodes them.
        context: ContextId,
        /// Length of the items in bytes.
        length: u32,
        /// The run.
        stream: StreamId,
        /// The events, with coded bytes.
        block: EventBlockRef<'b>,
    },
    /// Progress of a run.
    Status {
        /// The run.
        stream: StreamId,
        /// The number of its last event.
        head: u64,
        /// True if the run has ended, so that no event follows.
        is_over: bool,
        /// Snapshot in the encoding of the servers.
        state: &'b [u8],
        /// The hash of all events up to one of them.
        chain: Option<EventHash>,
    },
    /// A part of the state of a run after one of its events.
    Snapshot {
        /// The run.
        stream: StreamId,
        /// The number of the event.
        sequence: u64,
        /// The length of the whole snapshot, in bytes.
        length: u32,
        /// Offset of this part in bytes.
        offset: u32,
        /// The part.
        bytes: &'b [u8],
    },
    /// The state of a run after one of its events, coded.
    CodedSnapshot {
        /// The snapshot from which a coder has to learn to decode it.
        context: ContextId,
        /// The run.
        stream: StreamId,
        /// The number of the event.
        sequence: u64,
        /// Length of the whole in bytes.
        length: u32,
        /// The coded bytes.
        bytes: &'b [u8],
    },
    /// A part of an event that does not fit into one datagram.
    Large {
        /// The run.
        stream: StreamId,
        /// The number of the event.
        first: u64,
        /// The time of the event before it, in ns.
        time_before: u64,
        /// Packing of the items.
        packing: Packing,
        /// The length of all its packed items, in bytes.
        length: u32,
        /// Offset of this part in bytes.
        offset: u32,
        /// The part.
        bytes: &'b [u8],
    },
    /// Fate of a command.
    CommandState {
        /// Its id.
        id: CommandId,
        /// Fate of the command.
        state: CommandState,
        /// Reason of a refusal, in the encoding of the servers.
        reason: &'b [u8],
    },
    /// The robot's calendar.
    Calendar {
        /// Start of the robot's session by its present calendar: ms since 1970, UTC.
        began_ms: u64,
    },
    /// The key that is to be used from now on.
    NewKey {
        /// Its number.
        id: KeyId,
        /// The key.
        key: PairingKey,
    },
    /// A command, or the head of one that comes in parts.
    Command(Command<'b>),
    /// A part of a command.
    CommandPart(CommandPart<'b>),
    /// The parts of a command that the robot has.
    PartsHere(PartsHere),
    /// Last datagram received from the other side.
    Heard {
        /// Start of the other side that sent it.
        start: Generation,
        /// The newest packet number in that start.
        number: u64,
        /// The newest time in its datagrams, in ms.
        newest_ms: u64,
        /// Age of that datagram in ms.
        held_ms: u64,
        /// Delay of reordered datagrams, in ms.
        late_ms: u64,
    },
    /// Received datagrams of the start that the report in this datagram names.
    Arrived {
        /// Their bytes, with the headers of the carrier.
        bytes: u64,
        /// The longest of them in the last 10 to 20 s, in bytes.
        longest: u64,
    },
    /// Events of a run at the station.
    Received(Received),
    /// A request of a station for values, or the reply.
    Value(ValueFrame<'b>),
}

const EVENTS: u8 = 1;
const STATUS: u8 = 2;
const SNAPSHOT: u8 = 3;
const LARGE: u8 = 4;
const COMMAND_STATE: u8 = 5;
const CALENDAR: u8 = 6;
const CODED_SNAPSHOT: u8 = 7;
const NEW_KEY: u8 = 11;
const CODED: u8 = 12;
const HEARD: u8 = 17;
const ARRIVED: u8 = 24;
/// Capacity of a report, in ranges.
pub(crate) const RANGES_MAX: usize = 16;

impl<'b> Frame<'b> {
    /// Appends the frame.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        let mut numbers = |tag: u8, numbers: &[u64]| {
            out.push(tag);
            for number in numbers {
                write_number(*number, out);
            }
        };
        match self {
            Self::Events { stream, block } => {
                numbers(EVENTS, &block_numbers(*stream, block));
                write_bytes(block.bytes, out);
            }
            Self::Coded { context, length, stream, block } => {
                let [run, first, count, time] = block_numbers(*stream, block);
                let of = [run, first, count, time, u64::from(*length)];
                write_coded(CODED, *context, &of, block.bytes, out);
            }
            Self::Status { stream, head, is_over, state, chain } => {
                numbers(STATUS, &[u64::from(stream.0), *head, u64::from(*is_over)]);
                write_bytes(state, out);
                write_number(chain.map_or(0, |chain| chain.last), out);
                if let Some(EventHash { hash, .. }) = chain {
                    out.extend_from_slice(&hash.to_be_bytes());
                }
            }
            Self::Snapshot { stream, sequence, length, offset, bytes } => {
                let place = [*length, *offset].map(u64::from);
                numbers(SNAPSHOT, &[u64::from(stream.0), *sequence, place[0], place[1]]);
                write_bytes(bytes, out);
            }
            Self::CodedSnapshot { context, stream, sequence, length, bytes } => {
                let of = [u64::from(stream.0), *sequence, u64::from(*length)];
                write_coded(CODED_SNAPSHOT, *context, &of, bytes, out);
            }
            Self::Large { stream, first, time_before, packing, length, offset, bytes } => {
                let place = [*length, *offset].map(u64::from);
                numbers(LARGE, &[u64::from(stream.0), *first, *time_before, place[0], place[1]]);
                packing.write(out);
                write_bytes(bytes, out);
            }
            Self::CommandState { id, state, reason } => {
                out.push(COMMAND_STATE);
                out.extend_from_slice(&id.0);
                out.push(*state as u8);
                write_bytes(reason, out);
            }
            Self::Calendar { began_ms } => numbers(CALENDAR, &[*began_ms]),
            Self::NewKey { id, key } => {
                out.extend_from_slice(&[NEW_KEY, id.0]);
                out.extend_from_slice(key.bytes());
            }
            Self::Command(command) => command.write(out),
            Self::CommandPart(part) => part.write(out),
            Self::PartsHere(here) => here.write(out),
            Self::Heard { start, number, newest_ms, held_ms, late_ms } => {
                numbers(HEARD, &[u64::from(start.0), *number, *newest_ms, *held_ms, *late_ms]);
            }
            Self::Arrived { bytes, longest } => numbers(ARRIVED, &[*bytes, *longest]),
            Self::Received(received) => write_received(received, out),
            Self::Value(frame) => frame.write(out),
        }
    }

    /// Reads the next frame.
    fn read(reader: &mut FrameReader<'b>) -> Result<Self, BrokenFrame> {
        Ok(match reader.byte()? {
            EVENTS => {
                let (stream, block) = read_block_head(reader)?;
                let block = EventBlockRef { bytes: reader.bytes()?, ..block };
                Self::Events { stream, block }
            }
            CODED => read_coded(reader)?,
            STATUS => {
                let (stream, head) = (StreamId(reader.small()?), reader.number()?);
                let is_over = read_flag(reader)?;
                let (state, last) = (reader.bytes()?, reader.number()?);
                let hash =
                    (last > 0).then(|| reader.fixed().map(u64::from_be_bytes)).transpose()?;
                let chain = hash.map(|hash| EventHash { last, hash });
                Self::Status { stream, head, is_over, state, chain }
            }
            SNAPSHOT => {
                let (stream, sequence) = (StreamId(reader.small()?), reader.number()?);
                let (length, offset, bytes) = read_part(reader)?;
                Self::Snapshot { stream, sequence, length, offset, bytes }
            }
            CODED_SNAPSHOT => Self::CodedSnapshot {
                context: ContextId(reader.fixed()?),
                stream: StreamId(reader.small()?),
                sequence: reader.number()?,
                length: reader.small()?,
                bytes: reader.bytes()?,
            },
            LARGE => {
                let (stream, first) = (StreamId(reader.small()?), reader.number()?);
                check_numbers(first, 1)?;
                let time_before = reader.number()?;
                let (length, offset) = (reader.small()?, reader.small()?);
                let packing = Packing::read(reader)?;
                let bytes = read_part_bytes(reader, length, offset)?;
                Self::Large { stream, first, time_before, packing, length, offset, bytes }
            }
            COMMAND_STATE => {
                let id = CommandId(reader.fixed()?);
                let state = CommandState::ALL.get(usize::from(reader.byte()?));
                let state = *state.ok_or(BrokenFrame("an unknown state of a command"))?;
                Self::CommandState { id, state, reason: reader.bytes()? }
            }
            CALENDAR => Self::Calendar { began_ms: reader.number()? },
            NEW_KEY => {
                let id = KeyId(reader.byte()?);
                Self::NewKey { id, key: PairingKey::from_bytes(reader.fixed()?) }
            }
            kind @ (command::COMMAND | command::HEAD) => {
                Self::Command(Command::read(kind, reader)?)
            }
            command::BRIEF => Self::Command(Command::read_brief(reader)?),
            command::PART => Self::CommandPart(CommandPart::read(reader)?),
            command::PARTS_HERE => Self::PartsHere(PartsHere::read(reader)?),
            HEARD => Self::Heard {
                start: Generation(reader.small()?),
                number: reader.number()?,
                newest_ms: reader.number()?,
                held_ms: reader.number()?,
                late_ms: reader.number()?,
            },
            ARRIVED => Self::Arrived { bytes: reader.number()?, longest: reader.number()? },
            RECEIVED => Self::Received(read_received(reader)?),
            kind => Self::Value(ValueFrame::read(kind, reader)?),
        })
    }
}

fn write_coded(kind: u8, context: ContextId, numbers: &[u64], coded: &[u8], out: &mut Vec<u8>) {
    out.push(kind);
    out.extend_from_slice(&context.0);
    for number in numbers {
        write_number(*number, out);
    }
    write_bytes(coded, out);
}

fn read_flag(reader: &mut FrameReader<'_>) -> Result<bool, BrokenFrame> {
    match reader.number()? {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(BrokenFrame("neither yes nor no")),
    }
}

fn read_coded<'b>(reader: &mut FrameReader<'b>) -> Result<Frame<'b>, BrokenFrame> {
    let context = ContextId(reader.fixed()?);
    let (stream, block) = read_block_head(reader)?;
    let length = reader.small()?;
    let block = EventBlockRef { bytes: reader.bytes()?, ..block };
    Ok(Frame::Coded { context, length, stream, block })
}

/// Events have numbers from 1.
fn check_numbers(first: u64, count: u64) -> Result<(), BrokenFrame> {
    let is_possible = first > 0 && count > 0 && first.checked_add(count).is_some();
    is_possible.then_some(()).ok_or(BrokenFrame("impossible numbers of events"))
}

/// The numbers before the bytes of a block.
fn block_numbers(stream: StreamId, block: &EventBlockRef<'_>) -> [u64; 4] {
    [u64::from(stream.0), block.first_sequence, block.count, block.time_before]
}

/// A block without its bytes.
fn read_block_head<'b>(
    reader: &mut FrameReader<'b>,
) -> Result<(StreamId, EventBlockRef<'b>), BrokenFrame> {
    let stream = StreamId(reader.small()?);
    let (first_sequence, count) = (reader.number()?, reader.number()?);
    check_numbers(first_sequence, count)?;
    let time_before = reader.number()?;
    Ok((stream, EventBlockRef { first_sequence, count, time_before, bytes: &[] }))
}

/// Length of the whole, offset and bytes of a part.
fn read_part<'b>(reader: &mut FrameReader<'b>) -> Result<(u32, u32, &'b [u8]), BrokenFrame> {
    let (length, offset) = (reader.small()?, reader.small()?);
    Ok((length, offset, read_part_bytes(reader, length, offset)?))
}

fn read_part_bytes<'b>(
    reader: &mut FrameReader<'b>,
    length: u32,
    offset: u32,
) -> Result<&'b [u8], BrokenFrame> {
    let bytes = reader.bytes()?;
    let end = u64::from(offset) + bytes.len() as u64;
    if end > u64::from(length) {
        return Err(BrokenFrame("a part reaches beyond its whole"));
    }
    Ok(bytes)
}

impl Packing {
    fn write(self, out: &mut Vec<u8>) {
        match self {
            Self::Plain => out.push(0),
            Self::Deflated => out.push(1),
            Self::Coded { context, length } => {
                out.push(2);
                out.extend_from_slice(&context.0);
                write_number(u64::from(length), out);
            }
        }
    }

    fn read(reader: &mut FrameReader<'_>) -> Result<Self, BrokenFrame> {
        match reader.byte()? {
            0 => Ok(Self::Plain),
            1 => Ok(Self::Deflated),
            2 => Ok(Self::Coded { context: ContextId(reader.fixed()?), length: reader.small()? }),
            _ => Err(BrokenFrame("an unknown packing of an event")),
        }
    }
}

/// A frame with its length in bytes.
type SizedFrame<'b> = Result<(Frame<'b>, usize), BrokenFrame>;

/// The time of the sender in ms, and the frames of a payload up to the first broken one.
pub(crate) fn read_payload(
    payload: &[u8],
) -> Result<(u64, impl Iterator<Item = SizedFrame<'_>>), BrokenFrame> {
    let mut reader = FrameReader::new(payload);
    let at_ms = reader.number()?;
    let frames = std::iter::from_fn(move || {
        let before = reader.left();
        let frame = (before > 0).then(|| Frame::read(&mut reader))?;
        let length = before - reader.left();
        if frame.is_err() {
            reader = FrameReader::new(&[]);
        }
        Some(frame.map(|frame| (frame, length)))
    });
    Ok((at_ms, frames))
}

#[cfg(test)]
mod tests;
