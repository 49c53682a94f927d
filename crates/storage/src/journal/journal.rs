//! The journal of a run that is going on: its one writer. Events are appended under the lock of whoever makes them, and
//! committed by one thread behind. Knows the order of things; has no thread and no clock.

use super::about::About;
use super::batch::Batch;
use super::blank::{discard, is_blank};
use super::committer::Committer;
use super::database::Database;
use super::error::{Doing, Full, JournalError};
use super::folder::{RECORDER_FILE, SPILL_FOLDER, make_folder};
use super::leftovers::Leftovers;
use super::lock::RunLock;
use super::pack::{Hash, Pack, Roots};
use super::record::{Place, PlaceNumber, ValueNumber};
use super::recorder::Recorder;
use parking_lot::Mutex;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// The usual size beyond which old detail is given up.
pub const SIZE_MAX: u64 = 2 << 30;
/// The usual size of the recorder.
pub const RECORDER_BYTES: usize = 16 << 20;

/// How a journal is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// The size, in bytes, beyond which old detail is given up.
    pub size_max: u64,
    /// The size of the recorder: what can happen between two commits.
    pub recorder_bytes: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { size_max: SIZE_MAX, recorder_bytes: RECORDER_BYTES }
    }
}

/// The journal of a run that is going on.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    recorder: Mutex<Recorder>,
    committer: Mutex<Committer>,
    roots: Mutex<Roots>,
    disk_safe: AtomicU64,
    /// Ends last.
    _lock: RunLock,
}

/// What a commit did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Committed {
    /// Number of the last event that survives a power cut.
    pub sequence: u64,
    /// Detail before this event was given up just now: to be told as [`rafcon_protocol::Event::Thinned`].
    pub thinned: Option<u64>,
}

/// Where a run stands that is taken up again.
#[derive(Debug, Clone, PartialEq)]
pub struct TakenUp {
    /// What the run is.
    pub about: About,
    /// Number of its last event.
    pub sequence: u64,
    /// Time of its last event.
    pub t_ns: u64,
    /// The next value's number.
    pub next_value: ValueNumber,
    /// All places that were named, as they were defined last.
    pub places: Vec<(PlaceNumber, Place)>,
    /// How many runners there were, this one included.
    pub life: u32,
    /// What the runner before had appended and cannot be read, for people.
    pub lost: Option<String>,
}

impl Journal {
    /// Begins the journal of a new run in `folder`, which is made if it is not there. A journal without an event is replaced:
    /// its runner died before anything happened.
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
        // The last step: what has this file has all the others.
        about.write(folder)?;
        Ok(Self::new(lock, recorder, committer, folder))
    }

    /// Gives the journal up: the run was refused before anything happened. Nothing is to be appended after this.
    pub fn discard(&self) -> Result<(), JournalError> {
        discard(&self.folder)
    }

    /// Takes up the run in `folder` after its runner ended, with all that this had appended.
    pub fn take_up(folder: &Path, options: &Options) -> Result<(Self, TakenUp), JournalError> {
        let about = About::read(folder)?;
        let lock = RunLock::take(folder)?;
        let database = Database::open(folder)?;
        let leftovers = Leftovers::read(folder)?;
        let mut committer = Committer::take_up(folder, database, options.size_max, &leftovers)?;
        let (sequence, t_ns) = (committer.sequence(), committer.t_last());
        let life = committer.database.begin_life(sequence + 1)?;
        let (next_value, (_, places)) = (committer.next_value(), committer.database.places()?);
        let recorder = Recorder::create(folder, options.recorder_bytes, life, sequence + 1)?;
        let lost = leftovers.lost(sequence).map(|lost| lost.to_string());
        let taken_up = TakenUp { about, sequence, t_ns, next_value, places, life, lost };
        Ok((Self::new(lock, recorder, committer, folder), taken_up))
    }

    fn new(lock: RunLock, recorder: Recorder, committer: Committer, folder: &Path) -> Self {
        let disk_safe = AtomicU64::new(committer.sequence());
        let (recorder, committer) = (Mutex::new(recorder), Mutex::new(committer));
        let roots = Mutex::default();
        Self { folder: folder.to_owned(), recorder, committer, roots, disk_safe, _lock: lock }
    }

    /// The run's folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Number of the last event that was appended: it survives the end of this process.
    pub fn sequence(&self) -> u64 {
        self.recorder.lock().sequence()
    }

    /// Number of the last event that survives a power cut.
    pub fn disk_safe(&self) -> u64 {
        self.disk_safe.load(Ordering::Acquire)
    }

    /// Appends a batch, as a whole or not at all, and answers with the number of its last event. Touches memory only, unless the
    /// batch is larger than a part of the recorder.
    pub fn append(&self, batch: &Batch) -> Result<u64, Full> {
        self.recorder.lock().append(batch)
    }

    /// Moves everything that was appended into the database and returns when it is safe from a power cut. What an attempt that
    /// failed could not move stays where it was, for the next.
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

    /// Keeps a machine, and returns when it is safe from a power cut; commits go on meanwhile. If it fails, keep the same pack
    /// again: the packer believes that its files are there.
    pub fn keep_root(&self, pack: &Pack) -> Result<Hash, JournalError> {
        self.roots.lock().keep(pack, &self.committer, |committer| &mut committer.database)
    }

    /// Commits what is left and gives up the files that only a run needs that is going on. The journal can still be read, and
    /// taken up again.
    pub fn close(self) -> Result<Committed, JournalError> {
        let committed = self.commit()?;
        let mut committer = self.committer.lock();
        committer.database.put_end(committed.sequence)?;
        committer.database.checkpoint()?;
        drop(committer);
        // Empty, unless nobody was there to commit what is in it.
        drop(fs::remove_dir(self.folder.join(SPILL_FOLDER)));
        let path = self.folder.join(RECORDER_FILE);
        fs::remove_file(&path).map_err(|source| JournalError::io(&path, Doing::Write, source))?;
        Ok(committed)
    }
}
