//! Commands as they travel: whole in one frame, or a head and the parts of a long body.

use super::{RangeSet, read_ranges, write_ranges};
use crate::bytes::{BrokenFrame, FrameReader, number_length, write_bytes, write_number};
use crate::seal::Generation;

/// The id of a command, which its author chose at random.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommandId(pub [u8; 16]);

/// The bytes of a short id.
pub type BriefId = [u8; 6];

impl CommandId {
    /// A short id, which takes six bytes in a datagram. `None` for zeros, which number no command.
    pub fn from_brief(brief: BriefId) -> Option<Self> {
        let mut id = [0; 16];
        id[..brief.len()].copy_from_slice(&brief);
        (brief != BriefId::default()).then_some(Self(id))
    }

    /// The bytes of a short id. `None` if the id is longer.
    pub fn brief(self) -> Option<BriefId> {
        let (brief, rest) = self.0.split_first_chunk()?;
        (*brief != BriefId::default() && rest.iter().all(|byte| *byte == 0)).then_some(*brief)
    }
}

/// Maximum length of the body of a command in bytes.
pub const COMMAND_LENGTH_MAX: u32 = 64 << 10;

pub(super) const PARTS_HERE: u8 = 8;
pub(super) const COMMAND: u8 = 16;
pub(super) const HEAD: u8 = 21;
pub(super) const PART: u8 = 22;
/// A whole command with a short id that is carried out at once.
pub(super) const BRIEF: u8 = 23;

/// A command as it travels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Command<'b> {
    /// Its id.
    pub(crate) id: CommandId,
    /// When it may be carried out, and by whose order.
    pub(crate) terms: Terms,
    /// The command, as both servers understand it.
    pub(crate) body: Body<'b>,
}

/// The body of a command, or its length if it comes in parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Body<'b> {
    Whole(&'b [u8]),
    Parts(u32),
}

/// When a command may be carried out, and under which epoch of authority.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Terms {
    /// The start of the robot whose clock counts.
    pub(crate) robot_start: Generation,
    /// The last moment at which it may be carried out, in ms of that clock.
    pub(crate) not_after_ms: u64,
    /// The first moment at which it may be carried out; 0 for at once.
    pub(crate) not_before_ms: u64,
    /// The epoch of authority under which it was given.
    pub(crate) epoch: u64,
}

/// A part of the body of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct CommandPart<'b> {
    /// The command.
    pub(crate) id: CommandId,
    /// Length of the body in bytes.
    pub(crate) length: u32,
    /// Offset of this part.
    pub(crate) offset: u32,
    /// The part.
    pub(crate) bytes: &'b [u8],
}

/// The parts of a command that the robot has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PartsHere {
    /// The command.
    pub(crate) id: CommandId,
    /// True if the head has arrived: missing parts that were sent before it are lost.
    pub(crate) has_head: bool,
    /// The bytes, numbered from 1.
    pub(crate) bytes: RangeSet,
}

impl<'b> Command<'b> {
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let Self { id, terms, body } = self;
        let Terms { robot_start, not_after_ms, not_before_ms, epoch } = terms;
        if let (Some(brief), 0, Body::Whole(bytes)) = (id.brief(), not_before_ms, body) {
            out.push(BRIEF);
            out.extend_from_slice(&brief);
            for number in [u64::from(robot_start.0), *not_after_ms, *epoch] {
                write_number(number, out);
            }
            return write_bytes(bytes, out);
        }
        out.push(if matches!(body, Body::Whole(_)) { COMMAND } else { HEAD });
        out.extend_from_slice(&id.0);
        for number in [u64::from(robot_start.0), *not_after_ms, *not_before_ms, *epoch] {
            write_number(number, out);
        }
        match body {
            Body::Whole(bytes) => write_bytes(bytes, out),
            Body::Parts(length) => write_number(u64::from(*length), out),
        }
    }

    pub(super) fn read_brief(reader: &mut FrameReader<'b>) -> Result<Self, BrokenFrame> {
        let id = CommandId::from_brief(reader.fixed()?);
        let id = id.ok_or(BrokenFrame("an impossible id of a command"))?;
        let terms = Terms {
            robot_start: Generation(reader.small()?),
            not_after_ms: reader.number()?,
            not_before_ms: 0,
            epoch: reader.number()?,
        };
        Ok(Self { id, terms, body: Body::Whole(reader.bytes()?) })
    }

    pub(super) fn read(kind: u8, reader: &mut FrameReader<'b>) -> Result<Self, BrokenFrame> {
        let id = CommandId(reader.fixed()?);
        let terms = Terms {
            robot_start: Generation(reader.small()?),
            not_after_ms: reader.number()?,
            not_before_ms: reader.number()?,
            epoch: reader.number()?,
        };
        let body = if kind == COMMAND {
            Body::Whole(reader.bytes()?)
        } else {
            Body::Parts(read_length(reader)?)
        };
        Ok(Self { id, terms, body })
    }
}

impl<'b> CommandPart<'b> {
    /// The longest bytes of a part that fit into `room`.
    pub(crate) fn bytes_max(room: usize) -> usize {
        let most = u64::from(COMMAND_LENGTH_MAX);
        room.saturating_sub(1 + size_of::<CommandId>() + 3 * number_length(most))
    }

    pub(super) fn write(&self, out: &mut Vec<u8>) {
        out.push(PART);
        out.extend_from_slice(&self.id.0);
        write_number(u64::from(self.length), out);
        write_number(u64::from(self.offset), out);
        write_bytes(self.bytes, out);
    }

    pub(super) fn read(reader: &mut FrameReader<'b>) -> Result<Self, BrokenFrame> {
        let id = CommandId(reader.fixed()?);
        let (length, offset, bytes) = (read_length(reader)?, reader.small()?, reader.bytes()?);
        let end = (offset as usize).checked_add(bytes.len());
        if bytes.is_empty() || end.is_none_or(|end| end > length as usize) {
            return Err(BrokenFrame("a part outside of its command"));
        }
        Ok(Self { id, length, offset, bytes })
    }
}

impl PartsHere {
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        out.push(PARTS_HERE);
        out.extend_from_slice(&self.id.0);
        out.push(u8::from(self.has_head));
        write_ranges(&self.bytes, out);
    }

    pub(super) fn read(reader: &mut FrameReader<'_>) -> Result<Self, BrokenFrame> {
        let id = CommandId(reader.fixed()?);
        let has_head = super::read_flag(reader)?;
        Ok(Self { id, has_head, bytes: read_ranges(reader)? })
    }
}

fn read_length(reader: &mut FrameReader<'_>) -> Result<u32, BrokenFrame> {
    let length = reader.small()?;
    if length == 0 || length > COMMAND_LENGTH_MAX {
        return Err(BrokenFrame("an impossible length of a command"));
    }
    Ok(length)
}
