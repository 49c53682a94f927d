//! The newest events in a mapped file: what is in it outlives this process the moment it is written. The file is a ring of
//! segments; each is filled with frames from its beginning and used again only once all that was in it is in the database.
//!
//! Knows frames and bytes; must never know what they mean or where they are moved.

use super::batch::Batch;
use super::error::{Doing, Full, JournalError};
use super::folder::{RECORDER_FILE, SPILL_FOLDER, create_file, fresh_name, sync_folder};
use super::frame::{self, FrameHeader};
use memmap2::MmapMut;
use rustix::fs::{FallocateFlags, fallocate};
use rustix::io::Errno;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Bytes before the first segment.
pub(super) const HEADER: usize = 4096;
/// Tells that a file is a recorder, and of which version.
pub(super) const MAGIC: [u8; 8] = *b"RAFREC\0\x02";
/// That of the version without marks.
pub(super) const UNMARKED: [u8; 8] = *b"RAFREC\0\x01";
/// Where the checksum of the header lies, and where what it is of ends.
pub(super) const HEADER_SUM: usize = 32;
/// Where it is marked up to which record everything was appended, and up to which everything is in the database.
pub(super) const APPENDED: usize = 40;
pub(super) const COMMITTED: usize = 48;
/// How many segments there are.
pub(super) const SEGMENTS: usize = 8;
/// No segment is shorter.
const SEGMENT_MIN: usize = 4096;

/// The mapped file, and how far it is filled.
#[derive(Debug)]
pub(super) struct Recorder {
    folder: PathBuf,
    map: MmapMut,
    life: u32,
    segment_bytes: usize,
    /// How far each segment is filled.
    used: [usize; SEGMENTS],
    current: usize,
    next_frame: u64,
    next_record: u64,
    /// Up to where everything is in the database.
    committed: Mark,
}

/// A point between two frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Mark {
    segment: usize,
    offset: usize,
    /// Number of the frame before it.
    frame: u64,
}

impl Recorder {
    /// Makes a new recorder in place of an older one; `life` is one that no recorder of this run had.
    pub(super) fn create(
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

    /// The life that its frames carry.
    pub(super) fn life(&self) -> u32 {
        self.life
    }

    /// Number of the last record.
    pub(super) fn sequence(&self) -> u64 {
        self.next_record - 1
    }

    /// Takes a batch, as a whole or not at all; answers with the number of its last record.
    pub(super) fn append(&mut self, batch: &Batch) -> Result<u64, Full> {
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

    /// The next free bytes.
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

    /// Writes a batch that is too large into a file of its own, which a short frame stands for.
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

    /// Copies all frames that are not committed to the end of `into`; answers up to where.
    pub(super) fn pending(&self, into: &mut Vec<u8>) -> Mark {
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

    /// All frames before `mark` are in the database, up to record number `sequence`: their room is free.
    pub(super) fn release(&mut self, mark: Mark, sequence: u64) {
        self.committed = mark;
        self.mark(COMMITTED, sequence);
    }

    fn start(&self, segment: usize) -> usize {
        HEADER + segment * self.segment_bytes
    }
}

/// The file of a frame that is too large.
pub(super) fn spill_file(folder: &Path, life: u32, number: u64) -> PathBuf {
    folder.join(SPILL_FOLDER).join(format!("{life}-{number}"))
}

/// The first page of a recorder.
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

/// A number of a record with a checksum in its upper 16 bits: it is written by one store, so a death leaves the old one or the
/// new one.
fn marked(sequence: u64) -> u64 {
    let low = sequence & MARK_MAX;
    low | (mark_sum(low) << 48)
}

/// The number that was marked so; nothing if it is not as it was written.
pub(super) fn unmarked(mark: u64) -> Option<u64> {
    let low = mark & MARK_MAX;
    (mark >> 48 == mark_sum(low)).then_some(low)
}

/// No record has a higher number.
const MARK_MAX: u64 = (1 << 48) - 1;

fn mark_sum(low: u64) -> u64 {
    // Short enough for every append: the upper bits of a product depend on all bits of the number.
    (low.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48) ^ 0x5a5a
}

/// Makes a file that has all its space on disk already: a full disk must not strike when memory is written.
fn make(path: &Path, bytes: usize) -> io::Result<File> {
    let file = create_file(path)?;
    match fallocate(&file, FallocateFlags::empty(), 0, bytes as u64) {
        Ok(()) => Ok(file),
        Err(Errno::OPNOTSUPP | Errno::NOSYS) => fill(file, bytes),
        Err(error) => Err(error.into()),
    }
}

/// The same where the file system cannot promise space.
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
    // nobody shortens it; readers only read.
    unsafe { MmapMut::map_mut(file) }
}
