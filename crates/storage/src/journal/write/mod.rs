//! Journal of an active run, for its only writer. Callers append events under their own lock, and another thread commits them
//! later. Defines the order of the steps; has no thread and no clock.

mod blank;
mod committer;
mod retention;
mod thin;

pub use blank::has_begun;
pub use retention::{Pruned, Retention, remove};

use crate::journal::folder::{
    About, Doing, Full, JournalError, RECORDER_FILE, RunLock, SPILL_FOLDER, make_folder,
};
use crate::journal::pack::{Hash, Pack, Roots};
use crate::journal::record::{Batch, Place, PlaceNumber, ValueNumber};
use crate::journal::store::Database;
use crate::journal::store::leftovers::Leftovers;
use crate::journal::store::recorder::Recorder;
use blank::{discard, is_blank};
use committer::Committer;
use parking_lot::Mutex;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Default size above which old detail is deleted.
pub const SIZE_MAX: u64 = 2 << 30;
/// Default size of the recorder.
pub const RECORDER_BYTES: usize = 16 << 20;

/// Options for writing a journal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Size in bytes above which old detail is deleted.
    pub size_max: u64,
    /// Size of the recorder in bytes. It holds the events between two commits.
    pub recorder_bytes: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { size_max: SIZE_MAX, recorder_bytes: RECORDER_BYTES }
    }
}

/// Journal of an active run.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    recorder: Mutex<Recorder>,
    committer: Mutex<Committer>,
    roots: Mutex<Roots>,
    disk_safe: AtomicU64,
    /// Declared last, so that it is released last.
    _lock: RunLock,
}

/// Result of a commit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Committed {
    /// Number of the last event that survives a power cut.
    pub sequence: u64,
    /// First event with full detail, if this commit deleted older detail. Report it as [`rafcon_protocol::Event::Thinned`].
    pub thinned: Option<u64>,
}

/// State of a run that is resumed.
#[derive(Debug, Clone, PartialEq)]
pub struct ResumePoint {
    /// Description of the run.
    pub about: About,
    /// Number of its last event.
    pub sequence: u64,
    /// Time of its last event.
    pub t_ns: u64,
    /// Number of the next value.
    pub next_value: ValueNumber,
    /// All defined places, by their latest definitions.
    pub places: Vec<(PlaceNumber, Place)>,
    /// Number of runners, including this one.
    pub life: u32,
    /// Message about unreadable events of the previous runner.
    pub lost: Option<String>,
}

impl Journal {
    /// Creates the journal of a new run in `folder`, and the folder if necessary. Replaces a journal without events, whose runner
    /// died before the first one.
    pub fn create(folder: &Path, about: &About, options: &Options) -> Result<Self, JournalError> {
        make_folder(folder)?;
        let lock = RunLock::take(folder)?;
        if !is_blank(folder)? {
            return Err(JournalError::Exists { folder: folder.to_owned() });
        }
        discard(folder)?;
        let mut database = Database::create(folder)?;
        let life = database.begin_life(1)?;
        let recorder = Recorder::create(folder, options.recorder_bytes, life, 1)?;
        let committer = Committer::new(folder, database, options.size_max)?;
        // The last step: a folder with this file has all the others.
        about.write(folder)?;
        Ok(Self::new(lock, recorder, committer, folder))
    }

    /// Discards the journal of a run that was refused before its first event. Nothing may be appended after this.
    pub fn discard(&self) -> Result<(), JournalError> {
        discard(&self.folder)
    }

    /// Resumes the run in `folder` after its runner ended, with all events that the runner had appended.
    pub fn resume(folder: &Path, options: &Options) -> Result<(Self, ResumePoint), JournalError> {
        let about = About::read(folder)?;
        let lock = RunLock::take(folder)?;
        let database = Database::open(folder)?;
        let leftovers = Leftovers::read(folder)?;
        let mut committer = Committer::resume(folder, database, options.size_max, &leftovers)?;
        let (sequence, t_ns) = (committer.sequence(), committer.t_last());
        let life = committer.database.begin_life(sequence + 1)?;
        let (next_value, (_, places)) = (committer.next_value(), committer.database.places()?);
        let recorder = Recorder::create(folder, options.recorder_bytes, life, sequence + 1)?;
        let lost = leftovers.lost(sequence).map(|lost| lost.to_string());
        let resume_point = ResumePoint { about, sequence, t_ns, next_value, places, life, lost };
        Ok((Self::new(lock, recorder, committer, folder), resume_point))
    }

    fn new(lock: RunLock, recorder: Recorder, committer: Committer, folder: &Path) -> Self {
        let disk_safe = AtomicU64::new(committer.sequence());
        let (recorder, committer) = (Mutex::new(recorder), Mutex::new(committer));
        let roots = Mutex::default();
        Self { folder: folder.to_owned(), recorder, committer, roots, disk_safe, _lock: lock }
    }

    /// Returns the folder of the run.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the number of the last appended event. It survives the end of this process.
    pub fn sequence(&self) -> u64 {
        self.recorder.lock().sequence()
    }

    /// Returns the number of the last event that survives a power cut.
    pub fn disk_safe(&self) -> u64 {
        self.disk_safe.load(Ordering::Acquire)
    }

    /// Appends a batch completely or not at all, and returns the number of its last event. Writes to memory only, unless the batch
    /// is larger than a part of the recorder.
    pub fn append(&self, batch: &Batch) -> Result<u64, Full> {
        self.recorder.lock().append(batch)
    }

    /// Moves all appended events into the database and returns when they are safe from a power cut. After a failure, the
    /// events stay in the recorder for the next attempt.
    pub fn commit(&self) -> Result<Committed, JournalError> {
        let mut committer = self.committer.lock();
        committer.buffer.clear();
        let recorder = self.recorder.lock();
        let (mark, life) = (recorder.pending(&mut committer.buffer), recorder.life());
        drop(recorder);
        if committer.buffer.is_empty() {
            return Ok(Committed { sequence: committer.sequence(), thinned: None });
        }
        committer.put_buffer(life)?;
        self.recorder.lock().release(mark, committer.sequence());
        self.disk_safe.store(committer.sequence(), Ordering::Release);
        Ok(Committed { sequence: committer.sequence(), thinned: committer.thin()? })
    }

    /// Stores a machine and returns when it is safe from a power cut; commits continue meanwhile. After a failure, store the
    /// same pack again: the packer assumes that its files are stored.
    pub fn keep_root(&self, pack: &Pack) -> Result<Hash, JournalError> {
        self.roots.lock().keep(pack, &self.committer, |committer| &mut committer.database)
    }

    /// Commits the remaining events and removes the files that only an active run needs. The journal can still be read and resumed.
    pub fn close(self) -> Result<Committed, JournalError> {
        self.close_with(|_| ())
    }

    /// Closes a run that is unlikely to be resumed. Its folder does not grow, even when it is read.
    pub fn close_for_long(self) -> Result<Committed, JournalError> {
        // The database is not changed while it has readers.
        self.close_with(|database| drop(database.leave_log()))
    }

    fn close_with(self, finish: impl FnOnce(&mut Database)) -> Result<Committed, JournalError> {
        let committed = self.commit()?;
        let mut committer = self.committer.lock();
        committer.database.put_end(committed.sequence)?;
        committer.database.checkpoint()?;
        finish(&mut committer.database);
        drop(committer);
        // Empty, unless a commit failed.
        drop(fs::remove_dir(self.folder.join(SPILL_FOLDER)));
        let path = self.folder.join(RECORDER_FILE);
        fs::remove_file(&path).map_err(|source| JournalError::io(&path, Doing::Write, source))?;
        Ok(committed)
    }
}
