//! The replica of one run: an ordinary run folder, written by the link, and open to viewers as if its runner were here.

use super::GivenCommand;
use super::viewers::{Shared, Viewers};
use crate::inbox::Input;
use rafcon_protocol::api::Control;
use rafcon_protocol::{Answer, LinkHealth, Snapshot};
use rafcon_storage::journal::{
    About, EventItems, JournalError, Options, Pack, Replica, ReplicaError,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::SyncSender;

/// In the folder of a replica: up to which part what is known about the run is here.
const TAKEN_FILE: &str = "about-parts";

pub(super) struct ReplicaRun {
    id: String,
    folder: PathBuf,
    replica: Option<Replica>,
    safe: u64,
    is_over: bool,
    /// Events behind a gap, by the number of the first.
    ahead: BTreeMap<u64, EventItems>,
    shared: Arc<Shared>,
    /// Closed when this is dropped.
    _viewers: Viewers,
}

impl ReplicaRun {
    /// Begins the replica of a run, or goes on with it. Commands of viewers arrive at `given`, with the number of the robot.
    pub(super) fn open(
        runs: &Path,
        about: &About,
        link: LinkHealth,
        (robot, given): (usize, SyncSender<Input<GivenCommand>>),
    ) -> Result<Self, JournalError> {
        let folder = runs.join(&about.id);
        let options = Options {
            size_max: about.size_max.unwrap_or(Options::default().size_max),
            ..Options::default()
        };
        let replica = Replica::open(&folder, about, &options)?;
        let safe = replica.next() - 1;
        let shared = Arc::new(Shared::new(folder.clone(), about, safe, link));
        let run = about.id.clone();
        let give = move |word| {
            let command = GivenCommand { robot, run: run.clone(), word };
            given.try_send(Input::Other(command)).is_ok()
        };
        let viewers = Viewers::open(&folder, Arc::clone(&shared), give)?;
        Ok(Self {
            id: about.id.clone(),
            folder,
            replica: Some(replica),
            safe,
            is_over: false,
            ahead: BTreeMap::new(),
            shared,
            _viewers: viewers,
        })
    }

    /// Keeps a machine of the run.
    pub(super) fn keep_machine(&self, pack: &Pack) -> Result<(), JournalError> {
        self.replica.as_ref().map_or(Ok(()), |replica| replica.keep_root(pack).map(drop))
    }

    /// Notes that what is known about the run is kept up to this part.
    pub(super) fn keep_taken(&self, taken: u64) {
        // What is not noted is sent again.
        drop(fs::write(self.folder.join(TAKEN_FILE), taken.to_string()));
    }

    /// Up to which part what is known about the run in this folder is kept.
    pub(super) fn read_taken(folder: &Path) -> u64 {
        let text = fs::read_to_string(folder.join(TAKEN_FILE)).unwrap_or_default();
        text.trim().parse().unwrap_or(0)
    }

    pub(super) fn id(&self) -> &str {
        &self.id
    }

    /// The number of the event that comes next.
    pub(super) fn next(&self) -> u64 {
        self.replica.as_ref().map_or(self.safe + 1, Replica::next)
    }

    /// Takes events. Those behind a gap wait until it is filled, those that the disk refuses until it takes them.
    pub(super) fn take(&mut self, items: EventItems) {
        self.ahead.insert(items.first, items);
        // What is wrong with the disk is said by the next sync.
        drop(self.append());
    }

    fn append(&mut self) -> Result<(), ReplicaError> {
        let Some(replica) = &mut self.replica else { return Ok(()) };
        while let Some(first) = self.ahead.first_entry().filter(|it| *it.key() <= replica.next()) {
            replica.append(first.get())?;
            first.remove();
        }
        Ok(())
    }

    /// The robot says that no event will follow.
    pub(super) fn set_over(&mut self) {
        self.is_over = true;
    }

    /// The robot says that this is its state.
    pub(super) fn stands(&self, snapshot: Snapshot) {
        self.shared.stands(snapshot);
    }

    /// Control of the run is like this.
    pub(super) fn set_control(&self, control: Control) {
        self.shared.set_control(control);
    }

    /// Whether everything up to this event is safe, and nothing waits.
    pub(super) fn is_at(&self, head: u64) -> bool {
        self.safe >= head && self.ahead.is_empty()
    }

    /// The link is like this.
    pub(super) fn set_link(&self, link: LinkHealth) {
        self.shared.set_link(link);
    }

    /// Makes all so far safe, and shows it; answers up to which event that is.
    pub(super) fn sync(&mut self) -> Result<u64, ReplicaError> {
        self.append()?;
        if let Some(replica) = &self.replica
            && replica.next() - 1 > self.safe
        {
            self.safe = replica.commit()?.sequence;
            self.shared.set_safe(self.safe);
        }
        Ok(self.safe)
    }

    /// Closes the replica if the run is over, the robot's last event is this one, and all are here. Answers whether it did.
    pub(super) fn close_if_complete(&mut self, head: u64) -> bool {
        let is_complete = self.is_over && head > 0 && self.safe >= head;
        if is_complete && let Some(replica) = self.replica.take() {
            // What could not be closed is like a run whose runner died: complete, and read as such.
            drop(replica.close());
        }
        is_complete
    }

    /// Answers a command.
    pub(super) fn answer(&self, envelope: &str, answer: &Answer) {
        self.shared.answer(envelope, answer);
    }
}
