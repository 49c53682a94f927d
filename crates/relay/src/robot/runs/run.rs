//! One run of a robot on its way to the station.

use super::super::follow::Followed;
use super::super::parcels::{NeededMachine, ParcelWork, SentParcels};
use super::super::scanner::FoundMachines;
use crate::about::{PARCEL_MAX, machine_parts, named_parts};
use crate::ids;
use crate::words::{ReportedRunState, RunFate};
use rafcon_link::{Rank, RobotSession, SessionTime, StreamId};
use rafcon_protocol::Snapshot;
use rafcon_storage::journal::{Chain, EventSource, Hash, JournalError};
use std::path::PathBuf;

/// Reported of a machine that no station takes.
const TOO_LARGE: &str = "a machine of a run has more than 64 MiB of files, and is not sent to the station: its events are";

/// A run that is sent.
#[derive(Debug)]
pub(super) struct RobotRun {
    pub(super) folder: PathBuf,
    /// The stream of its events.
    pub(super) events: StreamId,
    /// Longer pickles are sent by their hash.
    pub(super) pickle_max: usize,
    /// Description of the run in parts, with the number of its machines and the bytes of their files.
    pub(super) about: Vec<Vec<u8>>,
    pub(super) machines: usize,
    pub(super) machine_bytes: usize,
    /// The machines that come in parcels, as long as the station may not have them.
    pub(super) named: Vec<Hash>,
    /// Its journal, while it is read.
    pub(super) source: Option<EventSource>,
    pub(super) was_read: bool,
    /// The journal could not be opened at the last attempt.
    pub(super) is_unreadable: bool,
    pub(super) head: u64,
    pub(super) runner: Option<Followed>,
    /// Last snapshot of its runner, with the time.
    pub(super) snapshot: Option<(Box<Snapshot>, SessionTime)>,
    pub(super) fate: RunFate,
    /// It was over before the robot had this station.
    pub(super) is_older: bool,
    /// Last published state.
    pub(super) reported: ReportedRunState,
    /// An event that is too long for the link, and its length.
    pub(super) too_long: Option<(u64, usize)>,
    /// Hash of its events. `None` if the journal is incomplete.
    pub(super) chain: Option<Chain>,
}

impl RobotRun {
    /// Sends an older run after all newer ones.
    pub(super) fn send_last(&mut self, session: &mut RobotSession) {
        self.is_older = true;
        for stream in self.streams() {
            session.set_rank(stream, Rank::Last);
            session.ask_first(stream);
        }
    }

    /// Its events, and what is to be known about it besides.
    pub(super) fn streams(&self) -> [StreamId; 2] {
        [self.events, ids::about_beside(self.events)]
    }

    /// True if nothing more of it will be sent.
    pub(super) fn is_done(&self, session: &RobotSession) -> bool {
        let [events, about] = self.streams();
        let is_over = match self.fate {
            RunFate::Live | RunFate::Crashed => false,
            RunFate::Finished => self.is_hashed() && session.is_complete(events),
            RunFate::Removed => session.is_end_known(events),
        };
        is_over && self.runner.is_none() && self.named.is_empty() && session.is_complete(about)
    }

    /// True if the station can compare all events, or nobody can.
    pub(super) fn is_hashed(&self) -> bool {
        self.chain.is_none_or(|chain| chain.last() >= self.head)
    }

    /// Its journal, to be read anew.
    pub(super) fn source(&self) -> Result<EventSource, JournalError> {
        Ok(EventSource::open(&self.folder)?.without_pickles_over(self.pickle_max))
    }

    /// Its journal.
    pub(super) fn open(&mut self) -> Option<&mut EventSource> {
        self.was_read = true;
        if self.source.is_none() {
            self.source = self.source().ok();
            self.is_unreadable = self.source.is_none();
        }
        self.source.as_mut()
    }

    /// Lets go of the journal of a run that is over and was not read for a while.
    pub(super) fn rest(&mut self) {
        if self.runner.is_none() && !self.was_read {
            self.source = None;
        }
        self.was_read = false;
    }

    /// Adds the machines that are not known yet. They come in parcels, until they are very large together: then the run brings
    /// them itself. Each start of the robot therefore sends identical parts.
    pub(super) fn add_machines(
        &mut self,
        FoundMachines { before, packs }: FoundMachines,
        session: &mut RobotSession,
        parcels: &mut SentParcels,
        tell: fn(&str),
    ) {
        let known = self.machines.saturating_sub(before);
        if known >= packs.len() {
            return;
        }
        let packs = &packs[known..];
        self.machines += packs.len();
        for pack in packs {
            self.machine_bytes += pack.fresh.values().map(Vec::len).sum::<usize>();
            if self.machine_bytes > PARCEL_MAX {
                match machine_parts(pack) {
                    Some(parts) => self.about.extend(parts),
                    None => tell(TOO_LARGE),
                }
                continue;
            }
            let machine = pack.manifest.hash();
            self.about.extend(named_parts(machine));
            self.named.push(machine);
            let needed = NeededMachine { is_older: self.is_older, machine };
            parcels.tell(ParcelWork::Needed(needed, self.folder.clone()));
        }
        session.advance(ids::about_beside(self.events), self.about.len() as u64);
    }

    /// Lets go of the machines that the station has.
    pub(super) fn let_go(&mut self, session: &RobotSession, parcels: &mut SentParcels) {
        let about = session.progress(ids::about_beside(self.events));
        let is_told = about.is_some_and(|(_, missing)| missing == 0);
        let is_gone = self.fate == RunFate::Removed;
        let had = |machine: &mut Hash| is_gone || is_told && parcels.are_had(*machine, session);
        let all_had: Vec<_> = self.named.extract_if(.., had).collect();
        for machine in all_had {
            let is_older = self.is_older;
            parcels.tell(ParcelWork::CompletedRuns(NeededMachine { is_older, machine }));
        }
    }

    /// Publishes its state if it has changed.
    pub(super) fn tell(&mut self, reported: ReportedRunState, session: &mut RobotSession) {
        if reported != self.reported {
            let is_over = matches!(reported.fate, RunFate::Finished | RunFate::Removed);
            let state = serde_json::to_vec(&reported).unwrap_or_default();
            session.set_state(self.events, &state, is_over);
            self.reported = reported;
        }
    }
}
