//! Frames that a dead run left in its recorder after the last commit. Reads the file as bytes, which may be damaged.

use super::recorder::{
    APPENDED, COMMITTED, HEADER, HEADER_SUM, MAGIC, SEGMENTS, UNMARKED, spill_file, unmarked,
};
use super::sums::Damage;
use crate::journal::folder::{Doing, JournalError, RECORDER_FILE};
use crate::journal::record::frame::{self, Frame};
use std::fs;
use std::io;
use std::path::Path;

/// Bytes of a recorder.
#[derive(Debug, Default)]
pub(in crate::journal) struct Leftovers {
    bytes: Vec<u8>,
    life: u32,
    segment_bytes: usize,
    spilled: Vec<(u64, Vec<u8>)>,
    marks: Marks,
}

/// Marks in the header of a recorder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::journal) enum Marks {
    /// There is no recorder.
    #[default]
    None,
    /// The version of the recorder has no marks.
    Unmarked,
    /// The marks cannot be read.
    Damaged,
    /// Last record that was appended, and last record in the database.
    Read { appended: u64, committed: u64 },
}

impl Leftovers {
    /// Reads the recorder of the run in `folder`. A missing file, or one that is not a recorder, has no frames.
    pub(in crate::journal) fn read(folder: &Path) -> Result<Self, JournalError> {
        let path = folder.join(RECORDER_FILE);
        let mut leftovers = match fs::read(&path) {
            Ok(bytes) => Self::new(bytes),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Self::default(),
            Err(source) => return Err(JournalError::io(&path, Doing::Read, source)),
        };
        leftovers.read_spilled(folder);
        Ok(leftovers)
    }

    /// Reads the bytes of the file.
    pub(in crate::journal) fn new(bytes: Vec<u8>) -> Self {
        let damaged = || Self { marks: Marks::Damaged, ..Self::default() };
        let Some(header) = bytes.get(..HEADER) else { return damaged() };
        let long = |at: usize| {
            let mut eight = [0; 8];
            eight.copy_from_slice(&header[at..at + 8]);
            u64::from_le_bytes(eight)
        };
        let is_whole = || long(HEADER_SUM) == u64::from(crc32fast::hash(&header[..HEADER_SUM]));
        let marks = match &header[..8] {
            magic if *magic == UNMARKED => Marks::Unmarked,
            magic if *magic == MAGIC && is_whole() => {
                match (unmarked(long(APPENDED)), unmarked(long(COMMITTED))) {
                    (Some(appended), Some(committed)) => Marks::Read { appended, committed },
                    _ => Marks::Damaged,
                }
            }
            _ => return damaged(),
        };
        let (Ok(life), Ok(segment_bytes)) = (u32::try_from(long(8)), usize::try_from(long(16)))
        else {
            return damaged();
        };
        Self { bytes, life, segment_bytes, spilled: Vec::new(), marks }
    }

    /// Returns the marks of the recorder.
    pub(in crate::journal) fn marks(&self) -> Marks {
        self.marks
    }

    /// Returns the damage, if records after number `sequence`, the last one found, were appended.
    pub(in crate::journal) fn lost(&self, sequence: u64) -> Option<Damage> {
        match self.marks {
            Marks::Read { appended, .. } if appended > sequence => {
                Some(Damage::Events(sequence + 1, appended))
            }
            Marks::Damaged => Some(Damage::Recorder(sequence + 1)),
            _ => None,
        }
    }

    /// Returns the last record that was in the database, if the database now ends earlier, at record number `sequence`, and the
    /// frames do not continue from there.
    pub(in crate::journal) fn lacks(&self, sequence: u64) -> Option<u64> {
        match self.marks {
            Marks::Read { committed, .. } if committed > sequence => {
                let last =
                    self.frames(sequence).last().map_or(sequence, |last| last.head.next() - 1);
                (last < committed).then_some(committed)
            }
            _ => None,
        }
    }

    /// Reads the files of large frames. The first missing or torn one ends the leftovers.
    fn read_spilled(&mut self, folder: &Path) {
        let spilled = self.all().into_iter().filter(|frame| frame.head.spilled);
        let numbers: Vec<u64> = spilled.map(|frame| frame.head.number).collect();
        let read = |number| Some((number, fs::read(spill_file(folder, self.life, number)).ok()?));
        self.spilled = numbers.into_iter().filter_map(read).collect();
    }

    /// Returns the frames after record number `committed`, in order and without a gap, up to the first torn one.
    pub(in crate::journal) fn frames(&self, committed: u64) -> Vec<Frame<'_>> {
        let mut found: Vec<Frame<'_>> = Vec::new();
        let mut next = committed + 1;
        for frame in self.all() {
            if found.is_empty() && frame.head.first < next {
                continue;
            }
            let follows = found.last().is_none_or(|last| last.head.number + 1 == frame.head.number);
            let Some(frame) = self.whole(frame).filter(|_| follows && frame.head.first == next)
            else {
                break;
            };
            next = frame.head.next();
            found.push(frame);
        }
        found
    }

    /// Returns the frame with its body.
    fn whole<'s>(&'s self, short: Frame<'s>) -> Option<Frame<'s>> {
        if !short.head.spilled {
            return Some(short);
        }
        let index = self.spilled.binary_search_by_key(&short.head.number, |(number, _)| *number);
        let (frame, _) = frame::read(&self.spilled[index.ok()?].1, self.life)?;
        frame.stands_for(&short).then_some(frame)
    }

    /// Returns all frames sorted by number.
    fn all(&self) -> Vec<Frame<'_>> {
        let start = |index: usize| HEADER.checked_add(index.checked_mul(self.segment_bytes)?);
        let end = |index: usize| Some(start(index + 1)?.min(self.bytes.len()));
        let segment = |index: usize| self.bytes.get(start(index)?..end(index)?);
        let mut runs: Vec<Vec<Frame<'_>>> =
            (0..SEGMENTS).filter_map(segment).map(|bytes| run(bytes, self.life)).collect();
        runs.sort_by_key(|run| run.first().map(|frame| frame.head.number));
        runs.into_iter().flatten().collect()
    }
}

/// Returns the frames at the start of a segment. Older bytes may follow.
fn run(mut bytes: &[u8], life: u32) -> Vec<Frame<'_>> {
    let mut frames: Vec<Frame<'_>> = Vec::new();
    while let Some((frame, length)) = frame::read(bytes, life) {
        if frames.last().is_some_and(|last| last.head.number + 1 != frame.head.number) {
            break;
        }
        frames.push(frame);
        bytes = bytes.get(length..).unwrap_or_default();
    }
    frames
}

#[cfg(test)]
mod tests {
    use super::Leftovers;
    use crate::journal::record::Batch;
    use crate::journal::record::frame::{self, FrameHeader};
    use crate::journal::store::recorder::{HEADER, SEGMENTS, UNMARKED};
    use proptest::prelude::*;

    const SEGMENT: usize = 4096;

    /// Returns a recorder of life 3 whose segments hold these frames, each by number, first event and count.
    fn recorder(segments: &[Vec<(u64, u64, u32)>]) -> Vec<u8> {
        let mut bytes = UNMARKED.to_vec();
        for number in [3, SEGMENT as u64, SEGMENTS as u64] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.resize(HEADER + SEGMENTS * SEGMENT, 0);
        for (frames, segment) in segments.iter().zip(bytes[HEADER..].chunks_mut(SEGMENT)) {
            let length = frame::length(&Batch::new(0));
            for ((number, first, count), into) in frames.iter().zip(segment.chunks_mut(length)) {
                let (number, first, count) = (*number, *first, *count);
                let head =
                    FrameHeader { number, first, count, t_before: 0, t_last: 0, spilled: false };
                frame::write(into, 3, head, &Batch::new(0));
            }
        }
        bytes
    }

    proptest! {
        #[test]
        fn whatever_lies_there_the_frames_follow_on_one_another(
            segments in prop::collection::vec(
                prop::collection::vec((1_u64..12, 0_u64..12, 0_u32..3), 0..5), SEGMENTS),
            committed in 0_u64..6,
            cut in 0..HEADER + SEGMENTS * SEGMENT,
        ) {
            let mut bytes = recorder(&segments);
            bytes.truncate(bytes.len() - cut);
            let leftovers = Leftovers::new(bytes);
            let mut next = committed + 1;
            let mut last = None;
            for frame in leftovers.frames(committed) {
                prop_assert_eq!(frame.head.first, next);
                prop_assert!(last.is_none_or(|last| frame.head.number == last + 1));
                (next, last) = (frame.head.next(), Some(frame.head.number));
            }
        }
    }
}
