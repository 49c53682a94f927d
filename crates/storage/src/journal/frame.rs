//! A group of events as bytes that vouch for themselves. Knows one frame; must never know where it lies.

use super::batch::Batch;

/// Bytes before the body.
pub(super) const HEAD: usize = 64;
/// Frames begin at multiples of this.
const ALIGN: usize = 8;
/// The body lies in a file of its own.
const SPILLED: u32 = 1;

/// What a frame says about its body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FrameHeader {
    /// Counts the frames of one recorder, from 1.
    pub(super) number: u64,
    /// Number of its first record.
    pub(super) first: u64,
    /// How many records it has.
    pub(super) count: u32,
    /// Time of the record before it.
    pub(super) t_before: u64,
    /// Time of its last record.
    pub(super) t_last: u64,
    /// Whether the body lies in a file of its own.
    pub(super) spilled: bool,
}

impl FrameHeader {
    /// The number of the record that follows it.
    pub(super) fn next(&self) -> u64 {
        self.first + u64::from(self.count)
    }
}

/// A frame that was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Frame<'b> {
    pub(super) head: FrameHeader,
    /// What numbers stand for, each with the count of records of this frame that stand before it.
    pub(super) definitions: &'b [u8],
    /// The records.
    pub(super) records: &'b [u8],
}

impl Frame<'_> {
    /// Whether this is the body of a frame that says that it lies elsewhere.
    pub(super) fn stands_for(&self, short: &Frame<'_>) -> bool {
        self.head == FrameHeader { spilled: false, ..short.head }
    }
}

/// How long the frame of a batch is, with what fills it up to the next one.
pub(super) fn length(batch: &Batch) -> usize {
    padded(HEAD + batch.definitions.len() + batch.records.len())
}

/// How long a frame is whose body lies elsewhere.
pub(super) const SPILLED_LENGTH: usize = HEAD;

fn padded(length: usize) -> usize {
    length.next_multiple_of(ALIGN)
}

/// Writes the frame of a batch to the beginning of `into`, which is as long as [`length`] says. The checksum comes last.
pub(super) fn write(into: &mut [u8], life: u32, head: FrameHeader, batch: &Batch) {
    let (definitions, records) = (&batch.definitions[..], &batch.records[..]);
    let body = &mut into[HEAD..HEAD + definitions.len() + records.len()];
    body[..definitions.len()].copy_from_slice(definitions);
    body[definitions.len()..].copy_from_slice(records);
    write_head(into, life, head, [definitions.len(), records.len()]);
}

/// Writes a frame whose body lies elsewhere.
pub(super) fn write_spilled(into: &mut [u8], life: u32, head: FrameHeader) {
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

/// The frame at the beginning of `bytes` and how many bytes it takes; `None` if there is no whole one of this life.
pub(super) fn read(bytes: &[u8], life: u32) -> Option<(Frame<'_>, usize)> {
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
