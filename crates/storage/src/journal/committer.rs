//! Moves frames into the database, group by group, and keeps now and then how the run stood. Knows where the database stands;
//! must never know who appends.

use super::database::Database;
use super::error::{Doing, JournalError};
use super::folder::{RECORDER_FILE, SPILL_FOLDER};
use super::frame::{self, Frame};
use super::group::{Block, Group};
use super::leftovers::Leftovers;
use super::moment::Moment;
use super::reader::Reader;
use super::record::{Kept, ValueNumber};
use super::recorder::spill_file;
use super::sums::Damage;
use super::thin::DetailPruner;
use super::tracker::{Keyframe, Tracker};
use super::values;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// The database's side of a journal.
#[derive(Debug)]
pub(super) struct Committer {
    folder: PathBuf,
    pub(super) database: Database,
    /// The last row.
    last: Option<Block>,
    /// How many definitions of places there are.
    places: u64,
    tracker: Tracker,
    thinner: DetailPruner,
    /// Goes with the next group.
    keyframe: Option<Keyframe>,
    /// Bytes from the recorder; kept for their room.
    pub(super) buffer: Vec<u8>,
}

impl Committer {
    /// Begins with an empty database.
    pub(super) fn new(
        folder: &Path,
        mut database: Database,
        size_max: u64,
    ) -> Result<Self, JournalError> {
        Ok(Self {
            thinner: DetailPruner::new(size_max, &mut database)?,
            folder: folder.to_owned(),
            database,
            last: None,
            places: 0,
            tracker: Tracker::new(Moment::default(), ValueNumber(1), size_max),
            keyframe: None,
            buffer: Vec::new(),
        })
    }

    /// Goes on where `database` stands, with `leftovers` behind it.
    pub(super) fn take_up(
        folder: &Path,
        database: Database,
        size_max: u64,
        leftovers: &Leftovers,
    ) -> Result<Self, JournalError> {
        let mut committer = Self::new(folder, database, size_max)?;
        committer.last = committer.database.last_block()?;
        (committer.places, _) = committer.database.places()?;
        leftovers.lacks(committer.sequence()).map_or(Ok(()), |last| {
            let lacking = Damage::Events(committer.sequence() + 1, last);
            Err(committer.database.damaged(&lacking.to_string()))
        })?;
        committer.put_frames(&leftovers.frames(committer.sequence()))?;
        committer.tracker = committer.catch_up(size_max)?;
        committer.remove_spilled();
        Ok(committer)
    }

    /// Number of the last event in the database.
    pub(super) fn sequence(&self) -> u64 {
        self.last.as_ref().map_or(0, |last| last.next() - 1)
    }

    /// Time of the last event in the database.
    pub(super) fn t_last(&self) -> u64 {
        self.last.as_ref().map_or(0, |last| last.t_last)
    }

    /// The number of the next value.
    pub(super) fn next_value(&self) -> ValueNumber {
        self.tracker.next_value
    }

    /// Gives up a little old detail if the journal is too large; see [`DetailPruner::thin`].
    pub(super) fn thin(&mut self) -> Result<Option<u64>, JournalError> {
        self.thinner.thin(&mut self.database, &self.folder)
    }

    /// Puts the frames in the buffer into the database.
    pub(super) fn put_buffer(&mut self, life: u32) -> Result<(), JournalError> {
        let buffer = std::mem::take(&mut self.buffer);
        let put = self.put_bytes(&buffer, life);
        self.buffer = buffer;
        put
    }

    fn put_bytes(&mut self, bytes: &[u8], life: u32) -> Result<(), JournalError> {
        let mut frames = Vec::new();
        let mut rest = bytes;
        while !rest.is_empty() {
            let (frame, length) =
                frame::read(rest, life).ok_or_else(|| self.damaged("a frame is broken"))?;
            frames.push(frame);
            rest = &rest[length..];
        }
        let spilled = frames.iter().filter(|frame| frame.head.spilled);
        let path = |frame: &Frame<'_>| spill_file(&self.folder, life, frame.head.number);
        let paths: Vec<PathBuf> = spilled.map(path).collect();
        let read = |path: &PathBuf| {
            fs::read(path).map_err(|source| JournalError::io(path, Doing::Read, source))
        };
        let bodies = paths.iter().map(read).collect::<Result<Vec<Vec<u8>>, _>>()?;
        let spilled = frames.iter_mut().filter(|frame| frame.head.spilled);
        for (frame, body) in spilled.zip(&bodies) {
            let whole = frame::read(body, life).filter(|(whole, _)| whole.stands_for(frame));
            (*frame, _) = whole.ok_or_else(|| self.damaged("a large group is torn"))?;
        }
        self.put_frames(&frames)?;
        for path in paths {
            // What is left over of a file that cannot be removed goes with the next life.
            drop(fs::remove_file(path));
        }
        Ok(())
    }

    /// Puts frames into the database, and follows them once they are there.
    fn put_frames(&mut self, frames: &[Frame<'_>]) -> Result<(), JournalError> {
        let mut group = Group::after(self.last.as_ref());
        group.keyframe.clone_from(&self.keyframe);
        for frame in frames {
            group.add(frame).map_err(|broken| self.damaged(&broken.to_string()))?;
        }
        values::settle(&self.folder, &mut group.values)?;
        self.database.put(&group, self.sequence(), self.places)?;
        self.keyframe = None;
        self.places += group.places.len() as u64;
        if let Some(last) = group.into_last() {
            self.last = Some(last);
        }
        for frame in frames {
            self.tracker.follow(frame).map_err(|broken| self.damaged(&broken.to_string()))?;
        }
        self.keyframe = self.tracker.keyframe();
        Ok(())
    }

    /// What is known after the last event in the database.
    fn catch_up(&mut self, size_max: u64) -> Result<Tracker, JournalError> {
        let (start, floor) = self.database.last_keyframe()?;
        let mut reader = Reader::open(&self.folder)?;
        let moment = reader.moment(self.sequence())?;
        let mut tracker = Tracker::new(moment, floor, size_max);
        tracker.next_value = self.database.next_value()?.max(floor);
        reader.each(start + 1, |_, entry| {
            tracker.note(entry.sequence, &entry.record);
            // A number that was given must not be given again, also if its value cannot be read any more.
            entry.record.values(&mut |value| {
                if let Kept::Value(number) = value {
                    tracker.next_value = tracker.next_value.max(ValueNumber(number.0 + 1));
                }
            });
            ControlFlow::Continue(())
        })?;
        Ok(tracker)
    }

    /// Removes what an earlier life left in files of large groups.
    fn remove_spilled(&self) {
        drop(fs::remove_dir_all(self.folder.join(SPILL_FOLDER)));
    }

    fn damaged(&self, what: &str) -> JournalError {
        JournalError::Damaged { path: self.folder.join(RECORDER_FILE), what: what.to_owned() }
    }
}
