//! Runs of one robot on its station's disk. Calls may block on the disk.

mod run;

use super::ToStation;
use super::completed_runs::CompletedRuns;
use super::disk::{FromDisk, KeyWork, OpenRun, SettledRun, Work};
use super::parcels::{RestoredParcel, StationParcels, TakenPart};
use super::replica_run::ReplicaRun;
use crate::clock::SessionClock;
use crate::inbox::Input;
use crate::machine_lists::MachineLists;
use crate::pairing::Paired;
use crate::start::Start;
use rafcon_link::{Horizon, KeyId, SessionTime, StreamId};
use rafcon_storage::journal::folder::DIVERGED_FILE;
use rafcon_storage::journal::{
    About, EventBlock, Full, JournalError, ReplicaError, RunState, Summary, run_folders,
};
use run::KeptRun;
use std::collections::{BTreeMap, VecDeque};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::SyncSender;
use std::time::Duration;

/// Shortest interval between two syncs.
const REST_MIN: Duration = Duration::from_millis(10);
/// Longest interval between two syncs, and the retry interval after a failure.
const REST_MAX: Duration = Duration::from_millis(250);
/// The newest replicas are compared with the list of whole runs at the start: their disk may have been put back.
const CHECKED_MAX: usize = 256;
/// Replicas that are open from the start. Others that are not whole are opened with the first news of them.
const OPEN_AT_START: usize = 64;
/// Refused runs whose late work is dropped.
const REFUSED_MAX: usize = 256;
/// Ratio of idle to busy time, because many robots share a disk.
const REST: u32 = 4;

/// Folders of a robot's runs, and the receiver of events.
pub(super) struct Place {
    /// The number of the robot.
    pub(super) number: usize,
    pub(super) robot: String,
    pub(super) runs: PathBuf,
    pub(super) clock: SessionClock,
    pub(super) inbox: SyncSender<Input<ToStation>>,
    pub(super) paired: Paired,
    pub(super) machines: MachineLists,
}

/// The runs of one robot.
pub(super) struct KeptRuns {
    place: Place,
    start: Start,
    completed: CompletedRuns,
    parcels: StationParcels,
    /// The parts of parcels that are not written.
    parts: VecDeque<(StreamId, EventBlock)>,
    /// Parts that failed are retried with the next sync.
    are_stuck: bool,
    /// Number of complete parcels.
    came: u64,
    /// The runs of which something is under way.
    all: BTreeMap<StreamId, KeptRun>,
    /// The ids of those that are not whole, and of which nothing is under way.
    left: BTreeMap<StreamId, String>,
    refused: VecDeque<StreamId>,
    sync_at: SessionTime,
    problem: Option<String>,
    /// Bytes of dropped work.
    dropped: usize,
}

/// A run that was kept by an earlier start.
pub(super) struct Restored {
    pub(super) events: StreamId,
    pub(super) last: u64,
    pub(super) taken: u64,
    pub(super) state: RestoredState,
}

/// State of a replica at the start.
pub(super) enum RestoredState {
    /// It is open to viewers.
    Open(OpenRun),
    /// It is not whole, and opened with the first news of it.
    Left,
    /// It is whole.
    Whole,
    /// Nothing more of it is kept: why.
    Refused(String),
}

/// Reason why an item is not stored.
pub(super) enum KeepError {
    /// It may be later.
    Retryable(String),
    /// It never will.
    Permanent(String),
    /// The robot has another history than the replica.
    Diverged(String),
}

impl From<JournalError> for KeepError {
    fn from(error: JournalError) -> Self {
        let said = error.to_string();
        match error {
            JournalError::DiskFull { .. }
            | JournalError::ReadOnly { .. }
            | JournalError::Io { .. }
            | JournalError::Going { .. }
            | JournalError::Database { .. } => Self::Retryable(said),
            _ => Self::Permanent(said),
        }
    }
}

impl From<ReplicaError> for KeepError {
    fn from(error: ReplicaError) -> Self {
        match error {
            ReplicaError::Journal(error) | ReplicaError::Full(Full::Disk(error)) => error.into(),
            ReplicaError::Full(Full::Recorder) => Self::Retryable(error.to_string()),
            ReplicaError::Diverged { .. } => Self::Diverged(error.to_string()),
            ReplicaError::Broken(_) | ReplicaError::Count { .. } => {
                Self::Permanent(error.to_string())
            }
        }
    }
}

impl KeptRuns {
    pub(super) fn new(place: Place, start: Start, parcels: StationParcels) -> Self {
        let (all, left, sync_at) = (BTreeMap::new(), BTreeMap::new(), SessionTime::BEGIN);
        let refused = VecDeque::new();
        let completed = CompletedRuns::read(start.folder());
        place.machines.set(&place.robot, parcels.machine_list());
        let (parts, are_stuck, came, problem) = (VecDeque::new(), false, 0, None);
        Self {
            place,
            start,
            completed,
            parcels,
            parts,
            are_stuck,
            came,
            all,
            left,
            refused,
            sync_at,
            problem,
            dropped: 0,
        }
    }

    /// The parcels that are here.
    pub(super) fn restored_parcels(&self) -> Vec<RestoredParcel> {
        self.parcels.restored()
    }

    /// The runs that are whole, by the streams of their events, with how many events and parts they have.
    pub(super) fn whole(&self) -> Vec<(StreamId, u64, u64)> {
        self.completed.runs().map(|(stream, run)| (stream, run.events, run.parts)).collect()
    }

    /// Goes on with the replicas that are here and may change.
    pub(super) fn restore(&mut self) -> Vec<Restored> {
        let (mut restored, mut open) = (Vec::new(), 0);
        let folders = run_folders(&self.place.runs).unwrap_or_default();
        for (nth, folder) in folders.iter().rev().enumerate() {
            let id = folder.file_name().unwrap_or_default().to_string_lossy();
            if nth >= CHECKED_MAX && self.completed.find(&id).is_some() {
                continue;
            }
            let run = self.restore_one(folder, open < OPEN_AT_START);
            open += usize::from(run.as_ref().is_some_and(Restored::is_open));
            restored.extend(run);
        }
        restored
    }

    fn restore_one(&mut self, folder: &Path, may_open: bool) -> Option<Restored> {
        let about = About::read(folder).ok()?;
        if about.robot.as_ref() != Some(&self.place.robot) {
            return None;
        }
        let id = about.id.clone();
        let (taken, events) = ReplicaRun::read_taken(folder, &id);
        let summary = Summary::of(folder);
        let last = summary.events;
        let found = |last, state| Some(Restored { events, last, taken, state });
        if let Ok(why) = fs::read_to_string(folder.join(DIVERGED_FILE)) {
            return found(last, RestoredState::Refused(why));
        }
        if matches!(summary.state, RunState::Finished { .. }) {
            self.completed.add(&id, events, last, taken);
            return found(last, RestoredState::Whole);
        }
        let mut run = KeptRun::new(about, taken);
        // The robot reports again whether its runner has ended.
        let has_crashed = summary.state == RunState::Crashed;
        if may_open
            && !has_crashed
            && let Ok(open) = run.open(&self.place, events)
        {
            let last = run.replica.as_ref().map_or(last, |it| it.next() - 1);
            self.all.insert(events, run);
            return found(last, RestoredState::Open(open));
        }
        self.left.insert(events, id);
        found(last, RestoredState::Left)
    }

    /// Adds work for a run.
    pub(super) fn add(&mut self, run: StreamId, work: Work) {
        if run.is_files() {
            if let Work::Part(part) = work {
                self.parts.push_back((run, part));
            }
            return;
        }
        if self.refused.contains(&run) {
            self.dropped += work.cost();
            return;
        }
        let woken = || KeptRun::woken(run, &self.place, &self.completed, &mut self.left);
        let run = self.all.entry(run).or_insert_with(woken);
        match work {
            Work::Part(part) => run.parts.push_back(part),
            work => run.todo.push_back(work),
        }
    }

    /// Performs the pending tasks and the due syncs, or all syncs. Returns the bytes of finished tasks.
    pub(super) fn go_on(&mut self, now: bool) -> usize {
        let begun = self.place.clock.now();
        let is_due = now || begun >= self.sync_at;
        self.are_stuck &= !is_due;
        let (mut written, mut problem) = (std::mem::take(&mut self.dropped), None);
        if let Err(error) = self.take_parcels(&mut written) {
            self.are_stuck = true;
            problem = Some(error.to_string());
        }
        for (stream, run) in &mut self.all {
            run.is_stuck &= !is_due;
            let mut trouble =
                run.work(*stream, &self.place, (&self.parcels, self.came), &mut written);
            if std::mem::take(&mut run.is_whole) {
                let events = run.closed.unwrap_or(0);
                self.completed.add(run.name(), *stream, events, run.taken);
            }
            if is_due && trouble.is_none() {
                trouble = run
                    .sync(*stream, &self.place)
                    .or_else(|| run.checking.check(run.folder(&self.place)));
            }
            match trouble {
                None => {}
                Some(KeepError::Retryable(why)) => {
                    run.is_stuck = true;
                    problem = Some(why);
                }
                Some(KeepError::Permanent(why)) => {
                    run.refuse();
                    self.place.say(FromDisk::Refused(*stream, format!("{}: {why}", run.name())));
                }
                Some(KeepError::Diverged(why)) => {
                    // Readers that find the replica closed look up the reason.
                    let said = run.note_diverged(&self.place, &why);
                    run.refuse();
                    // It can be fetched again once its folder is moved away.
                    self.completed.add(run.name(), *stream, 0, 0);
                    self.place.say(FromDisk::Refused(*stream, said));
                }
            }
            if run.is_refused {
                written += run.drop_work();
            }
        }
        self.settle();
        if is_due {
            let end = self.place.clock.now();
            let rest = (end.since(begun) * REST).clamp(REST_MIN, REST_MAX);
            self.sync_at = end + if problem.is_some() { REST_MAX } else { rest };
            self.tell(problem);
        }
        written
    }

    /// Releases the runs of which nothing is under way.
    fn settle(&mut self) {
        let settled: Vec<_> = self.all.extract_if(.., |_, run| run.is_settled()).collect();
        for (stream, run) in settled {
            if run.is_refused {
                self.refused.push_back(stream);
                self.refused.drain(..self.refused.len().saturating_sub(REFUSED_MAX));
                continue;
            }
            if self.completed.get(stream).is_none() {
                self.left.insert(stream, run.name().to_owned());
            }
            let (events, parts) = (run.closed, run.taken);
            self.place.say(FromDisk::Settled(SettledRun { stream, events, parts }));
        }
    }

    /// Keeps parts of parcels, as far as the disk takes them.
    fn take_parcels(&mut self, written: &mut usize) -> io::Result<()> {
        while !self.are_stuck
            && let Some((stream, part)) = self.parts.front()
        {
            let TakenPart { is_whole, gone } = self.parcels.take(*stream, part)?;
            self.came += u64::from(is_whole);
            if is_whole {
                self.place.machines.set(&self.place.robot, self.parcels.machine_list());
            }
            *written += self.parts.pop_front().map_or(0, |(_, part)| Work::Part(part).cost());
            if !gone.is_empty() {
                self.place.say(FromDisk::ParcelsGone(gone));
            }
        }
        Ok(())
    }

    fn tell(&mut self, problem: Option<String>) {
        if problem != self.problem {
            self.place.say(FromDisk::Problem(problem.clone()));
            self.problem = problem;
        }
    }

    /// Time until the next sync.
    pub(super) fn rest(&self) -> Duration {
        self.sync_at.since(self.place.clock.now())
    }

    /// True if syncs or retries are pending.
    pub(super) fn is_unsafe(&self) -> bool {
        let is_unsafe = |run: &KeptRun| {
            run.is_stuck
                || run.checking.goes_on()
                || run.replica.as_ref().is_some_and(ReplicaRun::is_unsafe)
        };
        self.are_stuck || self.all.values().any(is_unsafe)
    }

    pub(super) fn keep_heard(&mut self, key: KeyId, heard: Horizon) {
        if let Err(error) = self.start.keep_heard(key, Some(heard)) {
            self.tell(Some(error.to_string()));
        }
    }

    pub(super) fn keep_key(&mut self, work: KeyWork) {
        let kept = match work {
            KeyWork::Next(new) => self.place.paired.keep_next(&new).map(|()| Some(new)),
            KeyWork::Replace(new) => self.place.paired.replace(&new).map(|()| None),
        };
        match kept {
            Ok(Some(new)) => self.place.say(FromDisk::KeyKept(new)),
            Ok(None) => {}
            // The robot offers it again.
            Err(error) => self.tell(Some(error.to_string())),
        }
    }
}

impl Place {
    fn say(&self, said: FromDisk) {
        // A station that has ended needs to know nothing.
        self.inbox.send(Input::Other(ToStation::Disk(self.number, said))).unwrap_or_default();
    }
}

impl Restored {
    fn is_open(&self) -> bool {
        matches!(self.state, RestoredState::Open(_))
    }
}

#[cfg(test)]
mod tests;
