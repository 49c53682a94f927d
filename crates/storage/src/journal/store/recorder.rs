//! The newest events in a mapped file, where they outlive this process as soon as they are written. The file is a ring of segments.
//! Each segment is filled with frames from its start, and reused only when all its frames are in the database.
//!
//! Handles frames and bytes, not their meaning or destination.

use crate::journal::folder::{
    Doing, Full, JournalError, RECORDER_FILE, SPILL_FOLDER, create_file, fresh_name, sync_folder,
};
use crate::journal::record::Batch;
use crate::journal::record::frame::{self, FrameHeader};
use memmap2::MmapMut;
use rustix::fs::{FallocateFlags, fallocate};
use rustix::io::Errno;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Number of bytes before the first segment.
pub(in crate::journal) const HEADER: usize = 4096;
/// Identifies a recorder and its version.
pub(in crate::journal) const MAGIC: [u8; 8] = *b"RAFREC\0\x02";
/// Identifies the version without marks.
pub(in crate::journal) const UNMARKED: [u8; 8] = *b"RAFREC\0\x01";
/// Offset of the header's checksum, and end of the bytes that it covers.
pub(in crate::journal) const HEADER_SUM: usize = 32;
/// Offsets of the marks: last appended record, and last record in the database.
pub(in crate::journal) const APPENDED: usize = 40;
pub(in crate::journal) const COMMITTED: usize = 48;
/// Number of segments, which are filled in turn.
pub(in crate::journal) const SEGMENTS: usize = 8;
/// Minimum length of a segment.
const SEGMENT_MIN: usize = 4096;

/// Mapped file and its fill level.
#[derive(Debug)]
pub(in crate::journal) struct Recorder {
    folder: PathBuf,
    map: MmapMut,
    life: u32,
    segment_bytes: usize,
    /// Fill level of each segment.
    used: [usize; SEGMENTS],
    current: usize,
    next_frame: u64,
    next_record: u64,
    /// End of the frames that are in the database.
    committed: Mark,
}

/// A point between two frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::journal) struct Mark {
    segment: usize,
    offset: usize,
    /// Number of the frame before it.
    frame: u64,
}

impl Recorder {
    /// Creates a recorder that replaces an older one. `life` is unique among the recorders of this run.
    pub(in crate::journal) fn create(
        folder: &Path,
        bytes: usize,
        life: u32,
        next_record: u64,
    ) -> Result<Self, JournalError> {
        let path = folder.join(RECORDER_FILE);
        let segment_bytes = (bytes / SEGMENTS).max(SEGMENT_MIN).next_multiple_of(4096);
        let failed = |source| JournalError::io(&path, Doing::Write, source);
        let fresh = fresh_name(&path);
        let file = make(&fresh, HEADER + SEGMENTS * segment_bytes).map_err(failed)?;
        let mut map = map(&file).map_err(failed)?;
        map[..HEADER].copy_from_slice(&header(life, segment_bytes, next_record - 1));
        file.sync_all().map_err(failed)?;
        fs::rename(&fresh, &path).map_err(failed)?;
        sync_folder(folder)?;
        Ok(Self {
            folder: folder.to_owned(),
            map,
            life,
            segment_bytes,
            used: [0; SEGMENTS],
            current: 0,
            next_frame: 1,
            next_record,
            committed: Mark::default(),
        })
    }

    /// Returns the life in its frames.
    pub(in crate::journal) fn life(&self) -> u32 {
        self.life
    }

    /// Returns the number of the last record.
    pub(in crate::journal) fn sequence(&self) -> u64 {
        self.next_record - 1
    }

    /// Appends a batch completely or not at all, and returns the number of its last record.
    pub(in crate::journal) fn append(&mut self, batch: &Batch) -> Result<u64, Full> {
        if batch.is_empty() {
            return Ok(self.sequence());
        }
        let head = FrameHeader {
            number: self.next_frame,
            first: self.next_record,
            count: batch.count,
            t_before: batch.t_before,
            t_last: batch.t_last,
            spilled: false,
        };
        let length = frame::length(batch);
        if length <= self.segment_bytes / 2 {
            let life = self.life;
            frame::write(self.room(length).ok_or(Full::Recorder)?, life, head, batch);
            self.taken(length, head);
        } else {
            self.spill(head, batch, length)?;
        }
        Ok(self.sequence())
    }

    /// Returns the next free bytes.
    fn room(&mut self, length: usize) -> Option<&mut [u8]> {
        if self.used[self.current] + length > self.segment_bytes {
            let next = (self.current + 1) % SEGMENTS;
            if next == self.committed.segment {
                return None;
            }
            self.current = next;
            self.used[next] = 0;
        }
        let start = self.start(self.current) + self.used[self.current];
        self.map.get_mut(start..start + length)
    }

    fn taken(&mut self, length: usize, head: FrameHeader) {
        self.used[self.current] += length;
        self.next_frame = head.number + 1;
        self.next_record = head.next();
        self.mark(APPENDED, self.sequence());
    }

    fn mark(&mut self, at: usize, sequence: u64) {
        self.map[at..at + 8].copy_from_slice(&marked(sequence).to_le_bytes());
    }

    /// Writes a batch that is too large into a separate file, with a short frame in its place.
    fn spill(&mut self, head: FrameHeader, batch: &Batch, length: usize) -> Result<(), Full> {
        let short = frame::SPILLED_LENGTH;
        let life = self.life;
        self.room(short).ok_or(Full::Recorder)?;
        let mut bytes = vec![0; length];
        frame::write(&mut bytes, life, head, batch);
        let path = spill_file(&self.folder, life, head.number);
        let write = || {
            fs::create_dir_all(self.folder.join(SPILL_FOLDER))?;
            create_file(&path)?.write_all(&bytes)
        };
        write().map_err(|source| Full::Disk(JournalError::io(&path, Doing::Write, source)))?;
        frame::write_spilled(self.room(short).ok_or(Full::Recorder)?, life, head);
        self.taken(short, head);
        Ok(())
    }

    /// Appends all uncommitted frames to `into`, and returns their end.
    pub(in crate::journal) fn pending(&self, into: &mut Vec<u8>) -> Mark {
        let Mark { mut segment, mut offset, .. } = self.committed;
        loop {
            let start = self.start(segment);
            into.extend_from_slice(&self.map[start + offset..start + self.used[segment]]);
            if segment == self.current {
                break;
            }
            (segment, offset) = ((segment + 1) % SEGMENTS, 0);
        }
        Mark { segment, offset: self.used[segment], frame: self.next_frame - 1 }
    }

    /// Releases the space of all frames before `mark`: they are in the database, up to record number `sequence`.
    pub(in crate::journal) fn release(&mut self, mark: Mark, sequence: u64) {
        self.committed = mark;
        self.mark(COMMITTED, sequence);
    }

    fn start(&self, segment: usize) -> usize {
        HEADER + segment * self.segment_bytes
    }
}

/// Returns the path for a frame that is too large.
pub(in crate::journal) fn spill_file(folder: &Path, life: u32, number: u64) -> PathBuf {
    folder.join(SPILL_FOLDER).join(format!("{life}-{number}"))
}

/// Returns the first page of a recorder.
fn header(life: u32, segment_bytes: usize, sequence: u64) -> Vec<u8> {
    let mut header = MAGIC.to_vec();
    header.extend_from_slice(&life.to_le_bytes());
    header.extend_from_slice(&0_u32.to_le_bytes());
    header.extend_from_slice(&(segment_bytes as u64).to_le_bytes());
    header.extend_from_slice(&(SEGMENTS as u64).to_le_bytes());
    let sum = u64::from(crc32fast::hash(&header));
    for number in [sum, marked(sequence), marked(sequence)] {
        header.extend_from_slice(&number.to_le_bytes());
    }
    header.resize(HEADER, 0);
    header
}

/// Encodes a record number with a checksum in its upper 16 bits. A single store writes it, so a crash leaves the old or the new
/// number.
fn marked(sequence: u64) -> u64 {
    let low = sequence & MARK_MAX;
    low | (mark_sum(low) << 48)
}

/// Decodes a marked number. `None` if it is damaged.
pub(in crate::journal) fn unmarked(mark: u64) -> Option<u64> {
    let low = mark & MARK_MAX;
    (mark >> 48 == mark_sum(low)).then_some(low)
}

/// Maximum number of a record.
const MARK_MAX: u64 = (1 << 48) - 1;

fn mark_sum(low: u64) -> u64 {
    // Fast enough for every append: the upper bits of a product depend on all bits of the number.
    (low.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48) ^ 0x5a5a
}

/// Creates a file with all its space allocated: a full disk must not cause a fault when memory is written.
fn make(path: &Path, bytes: usize) -> io::Result<File> {
    let file = create_file(path)?;
    match fallocate(&file, FallocateFlags::empty(), 0, bytes as u64) {
        Ok(()) => Ok(file),
        Err(Errno::OPNOTSUPP | Errno::NOSYS) => fill(file, bytes),
        Err(error) => Err(error.into()),
    }
}

/// Allocates the space by writing zeros, for file systems that cannot reserve it.
fn fill(mut file: File, bytes: usize) -> io::Result<File> {
    let zeros = vec![0; 1 << 16];
    for start in (0..bytes).step_by(zeros.len()) {
        file.write_all(&zeros[..zeros.len().min(bytes - start)])?;
    }
    Ok(file)
}

#[expect(unsafe_code, reason = "memory that is also a file has no safe door")]
fn map(file: &File) -> io::Result<MmapMut> {
    // SAFETY: the file was just made by the process that has the run's lock, in a folder that only its owner may write to, and
    // no process truncates it; readers only read.
    unsafe { MmapMut::map_mut(file) }
}
