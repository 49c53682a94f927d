//! Large values on the disk of a station: a thread of its own writes them, so that neither commands nor events wait for it. What waits
//! for it is bounded; parts that do not fit are lost, as on any bad link, and come again.

use super::replica_run::ReplicaRun;
use crate::ids;
use crate::inbox::Input;
use crate::station::ToStation;
use crate::value_fetch_broker::ValueKey;
use rafcon_link::{RangeSet, ValueId, ValueName};
use rafcon_storage::journal::folder::check_run_id;
use rafcon_storage::journal::folder::replace_file;
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{ContentHash, IncomingContent, Reader, ValueNumber, is_content_here};
use std::collections::BTreeMap;
use std::io;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread;

/// Capacity of the queue.
const WAITING_MAX: usize = 4_096;
/// Capacity in parts and notes, so that other tasks always fit.
const PARTS_MAX: usize = 3_072;

/// Tasks of the disk, in order.
#[derive(Debug)]
enum ValueWork {
    Open(ValueKey),
    Write(ValueId, u64, Vec<u8>),
    /// Which bytes of a value are here, for the next start.
    Note(ValueId, RangeSet),
    /// All bytes of a value are here.
    Finish(ValueId),
    /// Ends a request. Received bytes are kept for the next request, or dropped.
    Leave(ValueId, Rest),
    /// Stores the requests for the next start.
    Wanted(String),
}

/// Treatment of the received bytes after the end of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rest {
    Stays,
    Goes,
}

/// A value that can be written.
#[derive(Debug)]
pub(crate) struct OpenedValue {
    pub(super) key: ValueKey,
    pub(super) name: ValueName,
    /// Length in bytes.
    pub(super) length: u64,
    /// Received bytes.
    pub(super) here: RangeSet,
}

/// Events of the disk about values.
#[derive(Debug)]
pub(crate) enum FromValueDisk {
    /// A value can be written.
    Opened(OpenedValue),
    /// A value is here: there is nothing to fetch.
    Here(ValueKey),
    /// A value cannot be fetched: why.
    NotOpened(ValueKey, String),
    /// A value has failed, with the reason.
    Failed(ValueId, String),
    /// A value is complete and valid, or its bytes have another hash and are dropped.
    Finished(ValueId, bool),
}

/// The disk as the rest of the station sees it.
#[derive(Debug)]
pub(super) struct ValueDisk {
    work: SyncSender<ValueWork>,
    /// Length of the queue.
    waiting: Arc<AtomicUsize>,
}

impl ValueDisk {
    /// Begins the thread that keeps values of the runs in this folder, of the robot of this number.
    pub(super) fn begin(
        runs: PathBuf,
        wanted: PathBuf,
        robot: usize,
        inbox: SyncSender<Input<ToStation>>,
    ) -> io::Result<Self> {
        let (disk, works) = Self::new();
        let keeper = Keeper { runs, wanted, open: BTreeMap::new(), robot, inbox };
        let waiting = Arc::clone(&disk.waiting);
        let keep = move || keeper.keep(&works, &waiting);
        thread::Builder::new().name("values".to_owned()).spawn(keep)?;
        Ok(disk)
    }

    /// Without its thread, which takes the work.
    fn new() -> (Self, Receiver<ValueWork>) {
        let (work, works) = mpsc::sync_channel(WAITING_MAX);
        (Self { work, waiting: Arc::default() }, works)
    }

    /// Returns false if the queue is full.
    pub(super) fn open(&self, key: ValueKey) -> bool {
        self.give(ValueWork::Open(key))
    }

    /// Returns false if the queue has no room for the part.
    pub(super) fn write(&self, id: ValueId, offset: u64, bytes: Vec<u8>) -> bool {
        self.waiting.load(Ordering::Acquire) < PARTS_MAX
            && self.give(ValueWork::Write(id, offset, bytes))
    }

    /// Notes which bytes of a value are here, unless the disk is behind.
    pub(super) fn note(&self, id: ValueId, here: &RangeSet) {
        if self.waiting.load(Ordering::Acquire) < PARTS_MAX {
            self.give(ValueWork::Note(id, here.clone()));
        }
    }

    /// Returns false if the queue is full.
    pub(super) fn finish(&self, id: ValueId) -> bool {
        self.give(ValueWork::Finish(id))
    }

    pub(super) fn leave(&self, id: ValueId, rest: Rest) {
        self.give(ValueWork::Leave(id, rest));
    }

    /// Stores the requests.
    pub(super) fn keep_wanted(&self, text: String) {
        self.give(ValueWork::Wanted(text));
    }

    fn give(&self, work: ValueWork) -> bool {
        self.waiting.fetch_add(1, Ordering::AcqRel);
        let is_taken = self.work.try_send(work).is_ok();
        if !is_taken {
            self.waiting.fetch_sub(1, Ordering::AcqRel);
        }
        is_taken
    }
}

struct Keeper {
    runs: PathBuf,
    wanted: PathBuf,
    open: BTreeMap<ValueId, IncomingContent>,
    robot: usize,
    inbox: SyncSender<Input<ToStation>>,
}

/// State of a value before the transfer.
struct WantedValue {
    name: ValueName,
    content: IncomingContent,
    here: RangeSet,
}

impl Keeper {
    fn keep(mut self, works: &Receiver<ValueWork>, waiting: &AtomicUsize) {
        for work in works {
            if let Some(said) = self.perform(work) {
                // A station that has ended needs to know nothing.
                self.inbox
                    .send(Input::Other(ToStation::Values(self.robot, said)))
                    .unwrap_or_default();
            }
            waiting.fetch_sub(1, Ordering::AcqRel);
        }
    }

    fn perform(&mut self, work: ValueWork) -> Option<FromValueDisk> {
        let failed = |id, error: io::Error| {
            let why = format!("the station's disk does not take it: {error}");
            Some(FromValueDisk::Failed(id, why))
        };
        match work {
            ValueWork::Open(key) => Some(self.open(key)),
            ValueWork::Write(id, offset, bytes) => {
                let error = self.open.get(&id)?.write(offset, &bytes).err()?;
                failed(id, error)
            }
            ValueWork::Note(id, here) => {
                // Bytes without an entry are received again.
                let ranges = here.ranges().map(RangeInclusive::into_inner);
                drop(self.open.get(&id)?.note(ranges));
                None
            }
            ValueWork::Finish(id) => match self.open.remove(&id)?.finish() {
                Ok(is_right) => Some(FromValueDisk::Finished(id, is_right)),
                Err(error) => failed(id, error),
            },
            ValueWork::Leave(id, rest) => {
                let content = self.open.remove(&id)?;
                if rest == Rest::Goes {
                    content.remove();
                }
                None
            }
            ValueWork::Wanted(text) => {
                // A lost request can be repeated after the next start.
                drop(replace_file(&self.wanted, text.as_bytes()));
                None
            }
        }
    }

    fn open(&mut self, key: ValueKey) -> FromValueDisk {
        match find(&self.runs, &key) {
            Ok(None) => FromValueDisk::Here(key),
            Ok(Some(WantedValue { name, content, here })) => {
                let length = content.length();
                // The same bytes may be open for another run.
                self.open.entry(name.id).or_insert(content);
                FromValueDisk::Opened(OpenedValue { key, name, length, here })
            }
            Err(why) => FromValueDisk::NotOpened(key, why),
        }
    }
}

/// Looks for a value in its replica. `None` if it is complete.
fn find(runs: &Path, (run, number): &ValueKey) -> Result<Option<WantedValue>, String> {
    check_run_id(run).map_err(|bad| bad.to_string())?;
    let folder = runs.join(run);
    let reader = Reader::open(&folder).map_err(|error| error.to_string())?;
    let stored = reader.value(ValueNumber(*number)).map_err(|error| error.to_string())?;
    let Some(Content::File { hash, size }) = stored.map(|stored| stored.content) else {
        return Ok(None);
    };
    if is_content_here(&folder, &hash, size) {
        return Ok(None);
    }
    let hash = ContentHash::from_name(&hash).ok_or("the value has no hash to fetch it by")?;
    let full = |error| format!("the station's disk does not take it: {error}");
    let (content, noted) = IncomingContent::open(&folder, hash, size).map_err(full)?;
    let (_, stream) = ReplicaRun::read_taken(&folder, run);
    let name = ValueName { stream, number: *number, id: ids::value_id(hash) };
    let here = noted.into_iter().map(|(first, last)| first..=last).collect();
    Ok(Some(WantedValue { name, content, here }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn so_much_waits_for_the_disk_and_parts_leave_room_for_the_rest() {
        let (disk, works) = ValueDisk::new();
        let id = ids::value_id(ContentHash::of(b"x"));
        let write = || disk.write(id, 0, Vec::new());
        assert!((0..PARTS_MAX).all(|_| write()));
        assert!(!write());
        disk.note(id, &RangeSet::default());
        assert_eq!(disk.waiting.load(Ordering::Acquire), PARTS_MAX);
        let key = || ("run".to_owned(), 1);
        assert!((PARTS_MAX..WAITING_MAX).all(|_| disk.open(key())));
        assert!(!disk.open(key()) && !disk.finish(id));
        assert_eq!(disk.waiting.load(Ordering::Acquire), WAITING_MAX);
        // The disk catches up.
        let folder = tempfile::tempdir().unwrap();
        let (inbox, said) = mpsc::sync_channel(WAITING_MAX);
        let (runs, wanted) = (folder.path().to_owned(), folder.path().join("wanted"));
        let keeper = Keeper { runs, wanted, open: BTreeMap::new(), robot: 0, inbox };
        let waiting = Arc::clone(&disk.waiting);
        let (again, rest) = mpsc::sync_channel(WAITING_MAX);
        for work in works.try_iter() {
            again.try_send(work).unwrap();
        }
        drop(again);
        keeper.keep(&rest, &waiting);
        assert_eq!(disk.waiting.load(Ordering::Acquire), 0);
        assert_eq!(said.try_iter().count(), WAITING_MAX - PARTS_MAX);
        assert!(write() && disk.open(key()));
    }
}
