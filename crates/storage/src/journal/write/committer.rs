//! Moves frames into the database in groups, and regularly stores a keyframe. Handles events that have been appended, not their
//! source.

use super::thin::DetailPruner;
use crate::journal::folder::{
    About, Doing, JournalError, RECORDER_FILE, SPILL_FOLDER, VALUES_FOLDER, sync_folder,
};
use crate::journal::moment::{Keyframe, Moment, Tracker};
use crate::journal::read::Reader;
use crate::journal::record::frame::{self, Frame};
use crate::journal::record::{Content, Kept, Stored, ValueNumber};
use crate::journal::store::Database;
use crate::journal::store::group::{Block, Group};
use crate::journal::store::leftovers::Leftovers;
use crate::journal::store::recorder::spill_file;
use crate::journal::store::sums::Damage;
use std::fs::{self, File};
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Database side of a journal.
#[derive(Debug)]
pub(in crate::journal) struct Committer {
    folder: PathBuf,
    pub(in crate::journal) database: Database,
    /// The last row of the database.
    last: Option<Block>,
    /// Number of definitions of places.
    places: u64,
    tracker: Tracker,
    thinner: DetailPruner,
    /// Keyframe for the next group.
    keyframe: Option<Keyframe>,
    /// Reused buffer for bytes of the recorder.
    pub(in crate::journal) buffer: Vec<u8>,
}

impl Committer {
    /// Starts with an empty database.
    pub(in crate::journal) fn new(
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

    /// Continues after the last event in `database`, with the `leftovers` that follow it.
    pub(in crate::journal) fn resume(
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

    /// Returns the number of the last event in the database.
    pub(in crate::journal) fn sequence(&self) -> u64 {
        self.last.as_ref().map_or(0, |last| last.next() - 1)
    }

    /// Returns the time of the last event in the database.
    pub(in crate::journal) fn t_last(&self) -> u64 {
        self.last.as_ref().map_or(0, |last| last.t_last)
    }

    /// Returns the number of the next value.
    pub(in crate::journal) fn next_value(&self) -> ValueNumber {
        self.tracker.next_value
    }

    /// Deletes some old detail if the journal is too large; see [`DetailPruner::thin`].
    pub(in crate::journal) fn thin(&mut self) -> Result<Option<u64>, JournalError> {
        self.thinner.thin(&mut self.database, &self.folder)
    }

    /// Writes the frames in the buffer to the database.
    pub(in crate::journal) fn put_buffer(&mut self, life: u32) -> Result<(), JournalError> {
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
            // The next runner removes a file that cannot be removed now.
            drop(fs::remove_file(path));
        }
        Ok(())
    }

    /// Writes frames to the database and then processes their events.
    fn put_frames(&mut self, frames: &[Frame<'_>]) -> Result<(), JournalError> {
        let mut group = Group::after(self.last.as_ref());
        group.keyframe.clone_from(&self.keyframe);
        for frame in frames {
            group.add(frame).map_err(|broken| self.damaged(&broken.to_string()))?;
        }
        settle_values(&self.folder, &mut group.values)?;
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

    /// Restores the tracker for the last event in the database.
    fn catch_up(&mut self, size_max: u64) -> Result<Tracker, JournalError> {
        let (start, floor) = self.database.last_keyframe()?;
        let mut reader = Reader::open(&self.folder)?;
        let moment = reader.moment(self.sequence())?;
        let mut tracker = Tracker::new(moment, floor, size_max);
        tracker.next_value = self.database.next_value()?.max(floor);
        reader.each(start + 1, |_, entry| {
            tracker.note(entry.sequence, &entry.record);
            // A number must not be assigned twice, even if its first value can no longer be read.
            entry.record.values(&mut |value| {
                if let Kept::Value(number) = value {
                    tracker.next_value = tracker.next_value.max(ValueNumber(number.0 + 1));
                }
            });
            ControlFlow::Continue(())
        })?;
        Ok(tracker)
    }

    /// Removes the files of large groups that an earlier runner left.
    fn remove_spilled(&self) {
        drop(fs::remove_dir_all(self.folder.join(SPILL_FOLDER)));
    }

    fn damaged(&self, what: &str) -> JournalError {
        JournalError::Damaged { path: self.folder.join(RECORDER_FILE), what: what.to_owned() }
    }
}

/// Syncs the files of `values` to disk. A value without its file loses its content, except in a replica, where the file may arrive
/// later.
fn settle_values(run: &Path, values: &mut [(ValueNumber, Stored)]) -> Result<(), JournalError> {
    let folder = run.join(VALUES_FOLDER);
    let mut any = false;
    for (_, stored) in values {
        let Content::File { hash, .. } = &stored.content else { continue };
        let path = folder.join(hash);
        match File::open(&path).and_then(|file| file.sync_all()) {
            Ok(()) => any = true,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                if !is_replica(run) {
                    stored.content = Content::Nothing("its file is missing".to_owned());
                }
            }
            Err(source) => return Err(JournalError::io(&path, Doing::Sync, source)),
        }
    }
    if any { sync_folder(&folder) } else { Ok(()) }
}

fn is_replica(run: &Path) -> bool {
    About::read(run).is_ok_and(|about| about.robot.is_some())
}
