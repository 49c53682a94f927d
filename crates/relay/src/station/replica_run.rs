//! The replica of one run: an ordinary run folder, written by the link, and open to viewers as if its runner were here.

use super::viewers::{PendingRequest, Shared, Viewers};
use crate::ids;
use rafcon_link::StreamId;
use rafcon_protocol::LinkHealth;
use rafcon_storage::journal::{
    About, EventBlock, JournalError, Options, Pack, Replica, ReplicaError,
};
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// In the folder of a replica: up to which part what is known about the run is here, and the stream of its events.
const TAKEN_FILE: &str = "about-parts";
/// The recorder of a replica: what it holds is at the robot, too. A larger group of events has a file of its own.
const RECORDER_BYTES: usize = 512 << 10;

/// Written by one thread, which may wait for the disk.
pub(super) struct ReplicaRun {
    replica: Replica,
    safe: u64,
    shared: Arc<Shared>,
    /// Closed when this is dropped.
    _viewers: Viewers,
}

impl ReplicaRun {
    /// Creates or opens the replica of a run. `give` forwards commands of viewers to the robot.
    pub(super) fn open(
        runs: &Path,
        about: &About,
        link: LinkHealth,
        give: impl Fn(PendingRequest) -> bool + Send + Sync + 'static,
    ) -> Result<Self, JournalError> {
        let folder = runs.join(&about.id);
        let replica = Replica::open(&folder, about, &options(about))?;
        let safe = replica.next() - 1;
        let shared = Arc::new(Shared::new(folder.clone(), about, safe, link));
        let viewers = Viewers::open(&folder, Arc::clone(&shared), give)?;
        Ok(Self { replica, safe, shared, _viewers: viewers })
    }

    /// Keeps a machine of the run.
    pub(super) fn keep_machine(&self, pack: &Pack) -> Result<(), JournalError> {
        self.replica.keep_root(pack).map(drop)
    }

    /// Keeps a machine of a run that is not open.
    pub(super) fn keep_machine_of(
        runs: &Path,
        about: &About,
        pack: &Pack,
    ) -> Result<(), JournalError> {
        let replica = Replica::open(&runs.join(&about.id), about, &options(about))?;
        replica.keep_root(pack)?;
        replica.close().map(drop)
    }

    /// Notes that what is known about the run in this folder is kept up to this part.
    pub(super) fn keep_taken(folder: &Path, taken: u64, stream: StreamId) {
        // Content without an entry is received again.
        drop(fs::write(folder.join(TAKEN_FILE), format!("{taken} {}", stream.0)));
    }

    /// Up to which part what is known about the run in this folder is kept, and the stream of its events.
    pub(super) fn read_taken(folder: &Path, id: &str) -> (u64, StreamId) {
        let text = fs::read_to_string(folder.join(TAKEN_FILE)).unwrap_or_default();
        let mut words = text.split_whitespace();
        let taken = words.next().and_then(|word| word.parse().ok()).unwrap_or(0);
        let stream = words.next().and_then(|word| word.parse().ok()).map(StreamId);
        let stream = stream.filter(|stream| ids::is_of(*stream, id));
        (taken, stream.unwrap_or_else(|| ids::events_of(id)))
    }

    /// The number of the event that comes next.
    pub(super) fn next(&self) -> u64 {
        self.replica.next()
    }

    /// Content for viewers.
    pub(super) fn shared(&self) -> Arc<Shared> {
        Arc::clone(&self.shared)
    }

    /// Takes events that continue what is here.
    pub(super) fn append(&mut self, items: &EventBlock) -> Result<(), ReplicaError> {
        self.replica.append(items).map(drop)
    }

    /// True if a sync is pending.
    pub(super) fn is_unsafe(&self) -> bool {
        self.replica.next() - 1 > self.safe
    }

    /// Syncs everything and publishes it. Returns the number of the last event.
    pub(super) fn commit(&mut self) -> Result<u64, JournalError> {
        self.safe = self.replica.commit()?.sequence;
        self.shared.set_safe(self.safe);
        Ok(self.safe)
    }

    /// Closes the replica: it costs neither descriptors nor a recorder any more.
    pub(super) fn close(self) {
        // After a failure, the replica reads like a run whose runner died.
        drop(self.replica.close());
    }
}

fn options(about: &About) -> Options {
    let usual = Options::default();
    let size_max = about.size_max.unwrap_or(usual.size_max);
    Options { size_max, recorder_bytes: RECORDER_BYTES }
}
