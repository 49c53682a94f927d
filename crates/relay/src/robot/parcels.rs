//! What the robot sends of machines: those that its runs have, and ahead of any run those in its projects. A thread of its own reads
//! and packs them, so that no event waits for it.

use super::follow::FromRun;
use super::project_machines::{ProjectMachines, Projects};
use crate::ids;
use crate::inbox::Input;
use crate::parcels::{Kept, Parcels};
use rafcon_link::{Rank, RobotSession, StreamId};
use rafcon_storage::journal::{Hash, Pack};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender, TrySendError};
use std::thread;
use std::time::Duration;

/// Interval of project scans while no run needs a parcel.
const SCAN_EVERY: Duration = Duration::from_secs(3);
/// Limits in parcels and bytes beyond which unused parcels are dropped.
const PARCELS_MAX: usize = 32;
const BYTES_MAX: u64 = 16 << 20;

/// Capacity of the queue to the thread. Further requests wait in this struct.
const WORKS_MAX: usize = 256;

/// Requests to the thread.
#[derive(Debug)]
pub(super) enum ParcelWork {
    /// The run in this folder has the machine with this hash.
    Needed(NeededMachine, PathBuf),
    /// The station has this machine of a run.
    CompletedRuns(NeededMachine),
}

/// A machine of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct NeededMachine {
    /// The run was over before the robot had this station.
    pub(super) is_older: bool,
    pub(super) machine: Hash,
}

/// A parcel that is sent.
#[derive(Debug, Clone)]
pub(super) struct SentParcel {
    pub(super) kept: Arc<Kept>,
    rank: Rank,
}

/// The parcels on their way, as the relay sees them.
#[derive(Debug)]
pub(super) struct SentParcels {
    maker: SyncSender<ParcelWork>,
    /// Requests that did not fit into the queue. The relay never blocks.
    waiting: VecDeque<ParcelWork>,
    sent: BTreeMap<StreamId, SentParcel>,
    /// Parcels sent since the start.
    begun: BTreeSet<StreamId>,
}

impl SentParcels {
    pub(super) fn new(maker: SyncSender<ParcelWork>) -> Self {
        let (waiting, sent, begun) = (VecDeque::new(), BTreeMap::new(), BTreeSet::new());
        Self { maker, waiting, sent, begun }
    }

    pub(super) fn tell(&mut self, work: ParcelWork) {
        self.waiting.push_back(work);
        self.tell_waiting();
    }

    /// Tells the thread what found no room before.
    pub(super) fn tell_waiting(&mut self) {
        while let Some(work) = self.waiting.pop_front() {
            if let Err(TrySendError::Full(work)) = self.maker.try_send(work) {
                return self.waiting.push_front(work);
            }
        }
    }

    /// These parcels are sent from now on, and no others.
    pub(super) fn set(&mut self, parcels: Vec<SentParcel>, session: &mut RobotSession) {
        let sent = parcels.into_iter().map(|parcel| (parcel.kept.stream(), parcel));
        let before = std::mem::replace(&mut self.sent, sent.collect());
        for stream in before.keys().filter(|stream| !self.sent.contains_key(stream)) {
            session.end(*stream);
        }
        for (stream, parcel) in &self.sent {
            if !before.contains_key(stream) {
                session.begin(*stream, parcel.kept.parts());
                if !self.begun.insert(*stream) || parcel.kept.is_old {
                    session.ask_first(*stream);
                }
            }
            session.set_state(*stream, &[], true);
            session.set_rank(*stream, parcel.rank);
        }
    }

    /// True if the station has reported all parcels of a machine.
    pub(super) fn are_had(&self, machine: Hash, session: &RobotSession) -> bool {
        let parcels = || self.sent.values().map(|parcel| &parcel.kept);
        let is_had = |name: &Hash| {
            let progress = session.progress(ids::parcel(*name));
            progress.is_some_and(|(_, missing)| missing == 0)
        };
        let of_machine = parcels().find(|kept| kept.machine == Some(machine));
        of_machine.is_some_and(|kept| is_had(&kept.name) && kept.needs.iter().all(is_had))
    }

    /// A part of a parcel.
    pub(super) fn part(&self, stream: StreamId, number: u64) -> Option<Vec<u8>> {
        self.sent.get(&stream)?.kept.part(number)
    }
}

struct ParcelMaker {
    parcels: Parcels,
    projects: ProjectMachines,
    /// The machines that runs need, and how many do.
    needed: BTreeMap<NeededMachine, usize>,
    inbox: SyncSender<Input<FromRun>>,
    tell: fn(&str),
    problem: Option<String>,
}

/// Begins the thread, which ends with the sender of its work. Parcels lie in this folder.
pub(super) fn begin(
    folder: &Path,
    projects: Projects,
    inbox: SyncSender<Input<FromRun>>,
    tell: fn(&str),
) -> io::Result<SyncSender<ParcelWork>> {
    let mut parcels = Parcels::open(folder)?;
    parcels.drop_incomplete();
    let (sender, works) = mpsc::sync_channel(WORKS_MAX);
    let projects = ProjectMachines::new(projects);
    let needed = BTreeMap::new();
    let mut maker = ParcelMaker { parcels, projects, needed, inbox, tell, problem: None };
    let work = move || maker.work(&works);
    thread::Builder::new().name("parcels".to_owned()).spawn(work)?;
    Ok(sender)
}

impl ParcelMaker {
    fn work(&mut self, works: &Receiver<ParcelWork>) {
        loop {
            let looked = self.projects.scan(&mut self.parcels);
            let mut is_new = self.told(looked).unwrap_or(false);
            let mut next = works.recv_timeout(if is_new { Duration::ZERO } else { SCAN_EVERY });
            while let Ok(work) = next {
                self.perform(work);
                is_new = true;
                next = works.try_recv().map_err(|error| match error {
                    mpsc::TryRecvError::Empty => RecvTimeoutError::Timeout,
                    mpsc::TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
                });
            }
            let is_over = matches!(next, Err(RecvTimeoutError::Disconnected));
            if is_over || is_new && !self.show() {
                return;
            }
        }
    }

    fn perform(&mut self, work: ParcelWork) {
        match work {
            ParcelWork::Needed(needed, run) => {
                *self.needed.entry(needed).or_default() += 1;
                let made = self.make(needed.machine, &run);
                self.told(made);
            }
            ParcelWork::CompletedRuns(needed) => {
                if let Some(count) = self.needed.get_mut(&needed) {
                    *count -= 1;
                }
                self.needed.retain(|_, count| *count > 0);
            }
        }
    }

    fn make(&mut self, machine: Hash, run: &Path) -> io::Result<()> {
        if self.parcels.of_machine(machine).is_some() {
            return Ok(());
        }
        let packs = Pack::read_after(run, 0).map_err(io::Error::other)?;
        let Some(pack) = packs.iter().find(|pack| pack.manifest.hash() == machine) else {
            return Ok(());
        };
        let all = |hash: &Hash| packs.iter().find_map(|pack| pack.fresh.get(hash));
        let files = pack.manifest.files().iter();
        let fresh = files.filter_map(|(_, hash)| Some((*hash, all(hash)?.clone()))).collect();
        let pack = Pack { manifest: pack.manifest.clone(), fresh };
        self.parcels.make(&pack).map(drop)
    }

    /// Says what is wrong, once.
    fn told<T>(&mut self, done: io::Result<T>) -> Option<T> {
        let problem = done.as_ref().err().map(|error| {
            format!("machines are not sent to the station: {error}; make room on the disk, or free the folder `machines` of the link")
        });
        if let Some(problem) = problem.as_ref().filter(|_| self.problem != problem) {
            (self.tell)(problem);
        }
        self.problem = problem;
        done.ok()
    }

    /// Publishes the list of parcels, and drops unused ones beyond the limits. Returns false without a receiver.
    fn show(&mut self) -> bool {
        let of_runs = |is_older: bool| {
            let needed = self.needed.keys().filter(move |it| it.is_older == is_older);
            self.with_needs(needed.map(|it| &it.machine))
        };
        let ranks = [
            (Rank::Needed, of_runs(false)),
            (Rank::Needed, self.projects.list().into_iter().collect()),
            (Rank::Ahead, self.with_needs(self.projects.ahead())),
            (Rank::Last, of_runs(true)),
        ];
        let rank = |kept: &Kept| {
            let found = ranks.iter().find(|(_, names)| names.contains(&kept.name));
            found.map(|(rank, _)| *rank)
        };
        while self.parcels.all().len() > PARCELS_MAX || self.parcels.bytes() > BYTES_MAX {
            if self.parcels.drop_oldest(|kept| rank(kept).is_none()).is_none() {
                break;
            }
            self.parcels.drop_incomplete();
        }
        let sent =
            |kept: &Arc<Kept>| Some(SentParcel { kept: Arc::clone(kept), rank: rank(kept)? });
        let sent = self.parcels.all().iter().filter_map(sent).collect();
        self.inbox.send(Input::Other(FromRun::Parcels(sent))).is_ok()
    }

    /// The names of the parcels with these machines, and of those that they need.
    fn with_needs<'h>(&self, machines: impl IntoIterator<Item = &'h Hash>) -> BTreeSet<Hash> {
        let of = |machine: &Hash| self.parcels.of_machine(*machine);
        let found = machines.into_iter().filter_map(of);
        found.flat_map(|kept| kept.needs.iter().copied().chain([kept.name])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_storage::Packer;
    use rafcon_storage::journal::{Manifest, Parcel};
    use rafcon_testkit::notation;
    use std::collections::BTreeMap;

    fn maker(folder: &Path) -> (ParcelMaker, Receiver<Input<FromRun>>) {
        let (inbox, told) = mpsc::sync_channel(8);
        let maker = ParcelMaker {
            parcels: Parcels::open(folder).unwrap(),
            projects: ProjectMachines::new(Projects::default()),
            needed: BTreeMap::new(),
            inbox,
            tell: |problem| panic!("{problem}"),
            problem: None,
        };
        (maker, told)
    }

    #[test]
    fn of_more_parcels_than_are_kept_the_oldest_that_nothing_needs_go() {
        let folder = tempfile::tempdir().unwrap();
        let (mut maker, _told) = maker(folder.path());
        let machines: Vec<_> = (0..=PARCELS_MAX)
            .map(|number| {
                let text = format!("execution ROOT \"{number}\"\n  script \"x = {number}\"\n");
                let machine = notation::parse(&text).unwrap();
                let pack =
                    Packer::default().pack(&machine, None, &rafcon_storage::Libraries::default());
                maker.parcels.make(&pack).unwrap();
                pack.manifest.hash()
            })
            .collect();
        let is_here =
            |maker: &ParcelMaker, nth: usize| maker.parcels.of_machine(machines[nth]).is_some();
        maker.needed.insert(NeededMachine { is_older: false, machine: machines[0] }, 1);
        assert!(maker.show());
        assert_eq!(maker.parcels.all().len(), PARCELS_MAX);
        assert_eq!([0, 1, 2].map(|nth| is_here(&maker, nth)), [true, false, true]);
    }

    #[test]
    fn of_more_bytes_than_are_kept_the_oldest_that_nothing_needs_go_and_needed_ones_stay() {
        let folder = tempfile::tempdir().unwrap();
        let (mut maker, _told) = maker(folder.path());
        // Noise: it is not shorter once it is deflated.
        let machines = [1, 2, 3].map(|seed| {
            let mut noise = vec![0; 6 << 20];
            blake3::Hasher::new().update(&[seed]).finalize_xof().fill(&mut noise);
            let fresh = BTreeMap::from([(Hash::of(&noise), noise)]);
            let mut parcel = Parcel::new(&Manifest::default(), None, Vec::new(), fresh);
            parcel.machine = Hash([seed; 32]);
            maker.parcels.add(&crate::about::parcel_bytes(&parcel)).unwrap().unwrap();
            parcel.machine
        });
        assert!(maker.parcels.bytes() > BYTES_MAX);
        let needed = |machine| (NeededMachine { is_older: false, machine }, 1);
        maker.needed = machines.map(needed).into();
        assert!(maker.show());
        assert_eq!(maker.parcels.all().len(), 3);
        maker.needed.clear();
        assert!(maker.show());
        assert!(maker.parcels.bytes() <= BYTES_MAX);
        let is_here = machines.map(|machine| maker.parcels.of_machine(machine).is_some());
        assert_eq!(is_here, [false, true, true]);
    }

    #[test]
    fn what_finds_no_room_at_the_thread_waits_and_comes_in_its_turn() {
        let (maker, works) = mpsc::sync_channel(WORKS_MAX);
        let mut sent = SentParcels::new(maker);
        let work = |number: usize| {
            let machine = Hash::of(&number.to_le_bytes());
            ParcelWork::CompletedRuns(NeededMachine { is_older: false, machine })
        };
        (0..WORKS_MAX + 3).for_each(|number| sent.tell(work(number)));
        assert_eq!(sent.waiting.len(), 3);
        let mut came: Vec<_> = works.try_iter().collect();
        sent.tell_waiting();
        came.extend(works.try_iter());
        let all: Vec<_> = (0..WORKS_MAX + 3).map(work).collect();
        assert_eq!(format!("{came:?}"), format!("{all:?}"));
        assert!(sent.waiting.is_empty());
    }
}
