//! Open journals, shared by all readers, because opening one takes longer than reading a page. Their number is limited,
//! however many clients follow however many runs.
//!
//! Detects that an open journal no longer matches the disk. Does not know the purpose of a read.

use crate::Failure;
use crate::gate::blocking;
use rafcon_locks::Mutex;
use rafcon_storage::journal::folder::{DATABASE_FILE, RECORDER_FILE};
use rafcon_storage::journal::{JournalError, Reader, leave_log, writer_of};
use std::collections::VecDeque;
use std::fs;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};
use tokio::sync::Semaphore;
use tokio::time::{Instant, sleep};

/// Maximum number of parallel short reads. Others wait.
const AT_ONCE: usize = 8;
/// Maximum number of parallel long reads.
const SLOW_AT_ONCE: usize = 2;
/// Number of unused journals that stay open.
const IDLE: usize = 16;
/// Time after which an unused journal is closed, to release its files and memory.
const IDLE_TIME: Duration = Duration::from_secs(30);

/// Open journals and the limits on reads.
#[derive(Debug)]
pub(crate) struct Readers {
    turns: Arc<Semaphore>,
    slow_turns: Arc<Semaphore>,
    /// Least recently used journal first.
    idle: Mutex<VecDeque<OpenReader>>,
    /// True while a task closes unused journals.
    is_closing: AtomicBool,
}

#[derive(Debug)]
struct OpenReader {
    folder: PathBuf,
    version: JournalVersion,
    reader: Reader,
    used: Instant,
}

impl OpenReader {
    /// Blocks for a while: call it without holding a lock.
    fn close(self) {
        let Self { folder, reader, .. } = self;
        drop(reader);
        leave_log(&folder);
    }
}

/// Detects changes that invalidate an open journal: another writer, another database file, or changed leftovers.
#[derive(Debug, PartialEq, Eq)]
struct JournalVersion {
    writer: Option<u32>,
    database: Option<u64>,
    leftovers: Option<(u64, SystemTime)>,
}

impl JournalVersion {
    fn of(folder: &Path) -> Result<Self, JournalError> {
        let writer = writer_of(folder)?;
        let database = fs::metadata(folder.join(DATABASE_FILE)).ok().map(|it| it.ino());
        let recorder = || fs::metadata(folder.join(RECORDER_FILE)).ok();
        let leftovers = if writer.is_some() { None } else { recorder() };
        let leftovers = leftovers.and_then(|it| Some((it.ino(), it.modified().ok()?)));
        Ok(Self { writer, database, leftovers })
    }
}

impl Default for Readers {
    fn default() -> Self {
        let turns = |count| Arc::new(Semaphore::new(count));
        let (turns, slow_turns) = (turns(AT_ONCE), turns(SLOW_AT_ONCE));
        Self { turns, slow_turns, idle: Mutex::default(), is_closing: AtomicBool::new(false) }
    }
}

impl Readers {
    /// Runs work on a run's journal, on a blocking thread.
    pub(crate) async fn read<T: Send + 'static>(
        self: &Arc<Self>,
        folder: PathBuf,
        work: impl FnOnce(&mut Reader) -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        self.in_turn(&self.turns, folder, work).await
    }

    /// Runs long work on a run's journal. It does not delay short reads.
    pub(crate) async fn read_slowly<T: Send + 'static>(
        self: &Arc<Self>,
        folder: PathBuf,
        work: impl FnOnce(&mut Reader) -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        self.in_turn(&self.slow_turns, folder, work).await
    }

    async fn in_turn<T: Send + 'static>(
        self: &Arc<Self>,
        turns: &Arc<Semaphore>,
        folder: PathBuf,
        work: impl FnOnce(&mut Reader) -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        // The work holds the permit, because the request may be dropped before it ends.
        let turn = Arc::clone(turns).acquire_owned().await.ok();
        let readers = Arc::clone(self);
        let done = blocking(move || {
            let _turn = turn;
            readers.with(&folder, work)
        });
        let done = done.await;
        self.close_later();
        done
    }

    /// Starts the task that closes unused journals.
    fn close_later(self: &Arc<Self>) {
        if self.is_closing.swap(true, Ordering::AcqRel) {
            return;
        }
        let readers = Arc::clone(self);
        tokio::spawn(async move {
            loop {
                let now = Arc::clone(&readers);
                if blocking(move || Ok(now.close_unused())).await != Ok(true) {
                    break;
                }
                sleep(IDLE_TIME).await;
            }
        });
    }

    /// Closes journals whose timeout has expired. Returns `true` if others are still open.
    fn close_unused(&self) -> bool {
        let mut idle = self.idle.lock();
        let recent = idle.partition_point(|open| open.used.elapsed() >= IDLE_TIME);
        let old: Vec<_> = idle.drain(..recent).collect();
        let is_left = !idle.is_empty();
        self.is_closing.store(is_left, Ordering::Release);
        drop(idle);
        old.into_iter().for_each(OpenReader::close);
        is_left
    }

    /// Runs work on a run's journal on the current thread.
    pub(crate) fn with<T>(
        &self,
        folder: &Path,
        work: impl FnOnce(&mut Reader) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let mut open = self.take(folder)?;
        let done = work(&mut open.reader)?;
        // A journal that failed is closed.
        self.put(open);
        Ok(done)
    }

    /// Closes the journal in a folder that is about to be deleted.
    pub(crate) fn forget(&self, folder: &Path) {
        self.idle.lock().retain(|open| open.folder != folder);
    }

    fn take(&self, folder: &Path) -> Result<OpenReader, JournalError> {
        // Taken before the journal is opened, so that the next request notices a change in between.
        let version = JournalVersion::of(folder)?;
        let known = self.take_idle(folder).filter(|open| open.version == version);
        if let Some(open) = known {
            return Ok(open);
        }
        let reader = Reader::open(folder)?;
        Ok(OpenReader { folder: folder.to_owned(), version, reader, used: Instant::now() })
    }

    fn take_idle(&self, folder: &Path) -> Option<OpenReader> {
        let mut idle = self.idle.lock();
        let index = idle.iter().rposition(|open| open.folder == folder)?;
        idle.remove(index)
    }

    fn put(&self, open: OpenReader) {
        let mut idle = self.idle.lock();
        let open = OpenReader { used: Instant::now(), ..open };
        idle.push_back(open);
        let oldest = if idle.len() > IDLE { idle.pop_front() } else { None };
        drop(idle);
        if let Some(oldest) = oldest {
            oldest.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{IDLE, IDLE_TIME, Readers};
    use crate::Failure;
    use rafcon_storage::journal::{About, Journal, Options, Reader};
    use rafcon_testkit::journal_notation;
    use std::fs;
    use std::path::Path;
    use std::sync::Arc;
    use tokio::time::sleep;

    const MACHINE: &str = "place R \"Root\" outcome done\n";

    fn begin(folder: &Path) -> Journal {
        let about = About { name: "test".to_owned(), ..About::default() };
        let options = Options { recorder_bytes: 1 << 16, ..Options::default() };
        Journal::create(folder, &about, &options).unwrap()
    }

    fn append(journal: &Journal, text: &str) {
        journal.append(&journal_notation::batch(&format!("{MACHINE}{text}"), 0).unwrap()).unwrap();
    }

    fn last(reader: &mut Reader) -> Result<u64, Failure> {
        Ok(reader.last_sequence()?)
    }

    #[test]
    fn what_a_runner_leaves_is_seen_though_its_journal_was_open_before_it_died() {
        let folder = tempfile::tempdir().unwrap();
        let readers = Readers::default();
        let journal = begin(folder.path());
        append(&journal, "enter R");
        journal.commit().unwrap();
        assert_eq!(readers.with(folder.path(), last), Ok(1));
        append(&journal, "leave R done");
        assert_eq!(readers.with(folder.path(), last), Ok(1));
        drop(journal);
        assert_eq!(readers.with(folder.path(), last), Ok(2));
        let (journal, _) = Journal::resume(folder.path(), &Options::default()).unwrap();
        append(&journal, "enter R");
        journal.commit().unwrap();
        assert_eq!(readers.with(folder.path(), last), Ok(3));
        journal.close().unwrap();
        assert_eq!(readers.with(folder.path(), last), Ok(3));
    }

    #[tokio::test(start_paused = true)]
    async fn journals_that_no_one_reads_are_closed() {
        let folder = tempfile::tempdir().unwrap();
        let readers = Arc::new(Readers::default());
        for number in 0..3 {
            let run = folder.path().join(number.to_string());
            begin(&run).close().unwrap();
            readers.read(run, last).await.unwrap();
        }
        assert_eq!(readers.idle.lock().len(), 3);
        sleep(3 * IDLE_TIME).await;
        assert_eq!(readers.idle.lock().len(), 0);
        readers.read(folder.path().join("1"), last).await.unwrap();
        sleep(3 * IDLE_TIME).await;
        assert_eq!(readers.idle.lock().len(), 0);
    }

    #[tokio::test(start_paused = true)]
    async fn a_run_that_ended_while_it_was_read_takes_no_more_disk_than_others() {
        let folder = tempfile::tempdir().unwrap();
        let readers = Arc::new(Readers::default());
        let run = folder.path().join("run");
        let journal = begin(&run);
        readers.read(run.clone(), last).await.unwrap();
        journal.close_for_long().unwrap();
        assert_eq!(logs(&run), 2);
        sleep(3 * IDLE_TIME).await;
        assert_eq!(logs(&run), 0);
        assert_eq!(readers.read(run, last).await, Ok(0));
    }

    /// Files that belong to a write-ahead log.
    fn logs(folder: &Path) -> usize {
        let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        names.filter(|name| name.to_string_lossy().starts_with("journal.db-")).count()
    }

    #[test]
    fn so_many_journals_are_open_and_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let readers = Readers::default();
        for number in 0..IDLE + 3 {
            let run = folder.path().join(number.to_string());
            begin(&run).close().unwrap();
            assert_eq!(readers.with(&run, last), Ok(0));
            assert_eq!(readers.with(&run, last), Ok(0));
        }
        assert_eq!(readers.idle.lock().len(), IDLE);
        readers.forget(&folder.path().join("5"));
        assert_eq!(readers.idle.lock().len(), IDLE - 1);
    }
}
