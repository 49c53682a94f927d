//! Moves frames into the database, group by group. Knows where the database stands; must never know who appends.

use super::database::Database;
use super::error::JournalError;
use super::folder::{RECORDER_FILE, SPILL_FOLDER};
use super::frame::{self, Frame};
use super::group::{Block, Group};
use super::recorder::spill_file;
use super::values;
use std::fs;
use std::path::{Path, PathBuf};

/// The database's side of a journal.
#[derive(Debug)]
pub(super) struct Committer {
    folder: PathBuf,
    pub(super) database: Database,
    /// The last row.
    last: Option<Block>,
    /// Bytes from the recorder; kept for its room.
    pub(super) buffer: Vec<u8>,
}

impl Committer {
    /// Goes on where `database` stands.
    pub(super) fn new(folder: &Path, mut database: Database) -> Result<Self, JournalError> {
        let last = database.last_block()?;
        Ok(Self { folder: folder.to_owned(), database, last, buffer: Vec::new() })
    }

    /// Number of the last event in the database.
    pub(super) fn sequence(&self) -> u64 {
        self.last.as_ref().map_or(0, |last| last.next() - 1)
    }

    /// Time of the last event in the database.
    pub(super) fn t_last(&self) -> u64 {
        self.last.as_ref().map_or(0, |last| last.t_last)
    }

    /// Puts the frames in the buffer into the database.
    pub(super) fn put_buffer(&mut self, life: u32) -> Result<(), JournalError> {
        let buffer = std::mem::take(&mut self.buffer);
        let put = self.put_bytes(&buffer, life);
        self.buffer = buffer;
        put
    }

    fn put_bytes(&mut self, mut bytes: &[u8], life: u32) -> Result<(), JournalError> {
        let mut group = Group::after(self.last.as_ref());
        let mut spilled = Vec::new();
        while !bytes.is_empty() {
            let (frame, length) =
                frame::read(bytes, life).ok_or_else(|| self.damaged("a frame is broken"))?;
            if frame.head.spilled {
                let path = spill_file(&self.folder, life, frame.head.number);
                let bytes = fs::read(&path).unwrap_or_default();
                let whole = frame::read(&bytes, life);
                let (whole, _) = whole.ok_or_else(|| self.damaged("a large group is missing"))?;
                self.add(&mut group, &whole)?;
                spilled.push(path);
            } else {
                self.add(&mut group, &frame)?;
            }
            bytes = &bytes[length..];
        }
        self.put(group)?;
        for path in spilled {
            // What is left over of a file that cannot be removed goes with the next life.
            drop(fs::remove_file(path));
        }
        Ok(())
    }

    /// Puts frames into the database.
    pub(super) fn put_frames(&mut self, frames: &[Frame<'_>]) -> Result<(), JournalError> {
        let mut group = Group::after(self.last.as_ref());
        for frame in frames {
            self.add(&mut group, frame)?;
        }
        self.put(group)
    }

    fn add(&self, group: &mut Group, frame: &Frame<'_>) -> Result<(), JournalError> {
        group.add(frame).map_err(|broken| self.damaged(&broken.to_string()))
    }

    fn put(&mut self, mut group: Group) -> Result<(), JournalError> {
        values::settle(&self.folder, &mut group.values)?;
        self.database.put(&group, self.sequence())?;
        if let Some(last) = group.into_last() {
            self.last = Some(last);
        }
        Ok(())
    }

    /// Removes what an earlier life left in files of large groups.
    pub(super) fn remove_spilled(&self) {
        drop(fs::remove_dir_all(self.folder.join(SPILL_FOLDER)));
    }

    fn damaged(&self, what: &str) -> JournalError {
        JournalError::Damaged { path: self.folder.join(RECORDER_FILE), what: what.to_owned() }
    }
}
