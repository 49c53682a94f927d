//! Encodes a batch as bytes with a checksum. Handles one frame, not its storage.

use super::batch::Batch;
use super::binary::{BinaryReader, Broken};
use super::{Definition, Item};

/// Number of bytes before the body.
pub(in crate::journal) const HEAD: usize = 64;
/// Alignment of frames, in bytes.
const ALIGN: usize = 8;
/// Flag of a frame whose body is in a separate file.
const SPILLED: u32 = 1;

/// Header of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::journal) struct FrameHeader {
    /// Number of the frame in its recorder, counted from 1.
    pub(in crate::journal) number: u64,
    /// Number of its first record.
    pub(in crate::journal) first: u64,
    /// Number of its records.
    pub(in crate::journal) count: u32,
    /// Time of the record before it.
    pub(in crate::journal) t_before: u64,
    /// Time of its last record.
    pub(in crate::journal) t_last: u64,
    /// True if the body is in a separate file.
    pub(in crate::journal) spilled: bool,
}

impl FrameHeader {
    /// Returns the number of the record that follows the frame.
    pub(in crate::journal) fn next(&self) -> u64 {
        self.first + u64::from(self.count)
    }
}

/// A frame, split into header and body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::journal) struct Frame<'b> {
    pub(in crate::journal) head: FrameHeader,
    /// Definitions, each with the number of records of this frame before it.
    pub(in crate::journal) definitions: &'b [u8],
    /// Records of the frame, encoded.
    pub(in crate::journal) records: &'b [u8],
}

impl Frame<'_> {
    /// Returns true if this frame contains the body of `short`, whose body is in a separate file.
    pub(in crate::journal) fn stands_for(&self, short: &Frame<'_>) -> bool {
        self.head == FrameHeader { spilled: false, ..short.head }
    }
}

/// Returns the length of the frame of a batch, including the padding.
pub(in crate::journal) fn length(batch: &Batch) -> usize {
    padded(HEAD + batch.definitions.len() + batch.records.len())
}

/// Length of a frame whose body is in a separate file.
pub(in crate::journal) const SPILLED_LENGTH: usize = HEAD;

fn padded(length: usize) -> usize {
    length.next_multiple_of(ALIGN)
}

/// Writes the frame of a batch to the start of `into`, which has the length from [`length`]. Writes the checksum last.
pub(in crate::journal) fn write(into: &mut [u8], life: u32, head: FrameHeader, batch: &Batch) {
    let (definitions, records) = (&batch.definitions[..], &batch.records[..]);
    let body = &mut into[HEAD..HEAD + definitions.len() + records.len()];
    body[..definitions.len()].copy_from_slice(definitions);
    body[definitions.len()..].copy_from_slice(records);
    write_head(into, life, head, [definitions.len(), records.len()]);
}

/// Writes a frame whose body is in a separate file.
pub(in crate::journal) fn write_spilled(into: &mut [u8], life: u32, head: FrameHeader) {
    write_head(into, life, FrameHeader { spilled: true, ..head }, [0, 0]);
}

fn write_head(into: &mut [u8], life: u32, head: FrameHeader, lengths: [usize; 2]) {
    into[4..8].copy_from_slice(&head.count.to_le_bytes());
    into[8..16].copy_from_slice(&u64::from(u32::from(head.spilled) * SPILLED).to_le_bytes());
    let numbers = [head.number, head.first, head.t_before, head.t_last];
    let lengths_u64 = lengths.map(|length| length as u64);
    for (at, number) in numbers.into_iter().chain(lengths_u64).enumerate() {
        into[16 + at * 8..24 + at * 8].copy_from_slice(&number.to_le_bytes());
    }
    let end = HEAD + lengths[0] + lengths[1];
    let sum = checksum(life, &into[4..end]);
    into[..4].copy_from_slice(&sum.to_le_bytes());
}

/// Decodes the frame at the start of `bytes`, and returns it with its length. `None` if there is no complete frame of this life.
pub(in crate::journal) fn read(bytes: &[u8], life: u32) -> Option<(Frame<'_>, usize)> {
    let head = bytes.get(..HEAD)?;
    let number = |at: usize| u64_at(head, 16 + at * 8);
    let length = |at: usize| usize::try_from(number(at)).ok();
    let (definitions, records) = (length(4)?, length(5)?);
    let length = HEAD.checked_add(definitions)?.checked_add(records)?;
    let whole = bytes.get(4..length)?;
    let (sum, count) = (u64_at(head, 0) & 0xffff_ffff, u64_at(head, 0) >> 32);
    if number(0) == 0 || u64::from(checksum(life, whole)) != sum {
        return None;
    }
    let head = FrameHeader {
        number: number(0),
        first: number(1),
        count: u32::try_from(count).ok()?,
        t_before: number(2),
        t_last: number(3),
        spilled: u64_at(head, 8) == u64::from(SPILLED),
    };
    head.first.checked_add(count)?;
    let (definitions, records) = bytes[HEAD..length].split_at(definitions);
    Some((Frame { head, definitions, records }, padded(length)))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut eight = [0; 8];
    eight.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(eight)
}

fn checksum(life: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(life);
    hasher.update(bytes);
    hasher.finalize()
}

/// Returns the definitions in a frame, each with the number of the first event that it applies to.
pub(in crate::journal) fn definitions<'b>(frame: &Frame<'b>) -> Definitions<'b> {
    Definitions { reader: BinaryReader::new(frame.definitions), first: frame.head.first }
}

/// Reads definitions up to the end or the first broken one.
#[derive(Debug)]
pub(in crate::journal) struct Definitions<'b> {
    reader: BinaryReader<'b>,
    first: u64,
}

impl Definitions<'_> {
    fn read(&mut self) -> Result<(u64, Definition), Broken> {
        let before = self.reader.number()?;
        match self.reader.item(0)? {
            Item::Definition(definition) => Ok((self.first.saturating_add(before), definition)),
            Item::Record(..) => Err(self.reader.broken("a record among definitions")),
        }
    }
}

impl Iterator for Definitions<'_> {
    type Item = Result<(u64, Definition), Broken>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.reader.is_at_end() {
            return None;
        }
        let read = self.read();
        if read.is_err() {
            self.reader = BinaryReader::new(&[]);
        }
        Some(read)
    }
}
