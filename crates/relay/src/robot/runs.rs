//! The runs of a robot: which there are, what of them is sent, and from where.

mod ended;
mod journals;
mod run;
mod source;
mod streams;

use super::follow::{Followed, FromRun};
use super::numbers::RunNumbers;
use super::parcels::{SentParcel, SentParcels};
use super::scanner::{FoundMachines, FoundRun, RunFiles};
use super::values::RobotValues;
use super::watches::RobotWatches;
use crate::about::about_parts;
use crate::clock::SessionClock;
use crate::inbox::Input;
use crate::requests::Answered;
use crate::words::{ReportedRunState, RunFate};
use ended::EndedRuns;
use rafcon_link::{LENGTH_MAX, Rank, RobotSession, SessionTime, StreamId};
use rafcon_protocol::api::Control;
use rafcon_protocol::{Answer, Envelope, LinkRun, Snapshot};
use rafcon_storage::journal::{
    Chain, JournalError, Reader, RunState, Summary, run_folders, writer_of,
};
use run::RobotRun;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::mpsc::SyncSender;
use streams::RunStreams;

/// Limit of older runs that are sent at a time.
const OLDER_AT_ONCE: usize = 2;
/// Limit of runs of earlier starts that are scanned again.
const LISTED_MAX: usize = 256;

/// Place of the runs, and who receives their news.
#[derive(Debug)]
pub(super) struct RunsPlace {
    pub(super) folder: PathBuf,
    pub(super) inbox: SyncSender<Input<FromRun>>,
    pub(super) tell: fn(&str),
    pub(super) clock: SessionClock,
    /// Longer pickles are sent by their hash.
    pub(super) pickle_max: usize,
}

/// The runs of a robot.
#[derive(Debug)]
pub(super) struct RobotRuns {
    place: RunsPlace,
    all: BTreeMap<String, RobotRun>,
    streams: RunStreams,
    ended: EndedRuns,
    /// Ended runs whose journals were opened, the oldest first.
    opened: VecDeque<String>,
    /// The list on the disk is older than the runs.
    is_list_old: bool,
    parcels: SentParcels,
    values: RobotValues,
}

impl RobotRuns {
    pub(super) fn new(place: RunsPlace, numbers: RunNumbers, parcels: SentParcels) -> Self {
        Self {
            place,
            all: BTreeMap::new(),
            streams: RunStreams::new(numbers),
            ended: EndedRuns::default(),
            opened: VecDeque::new(),
            is_list_old: false,
            parcels,
            values: RobotValues::default(),
        }
    }

    /// Looks for new values of a run that are watched.
    pub(super) fn scan_watched(
        &mut self,
        stream: StreamId,
        watches: &mut RobotWatches,
        session: &mut RobotSession,
    ) {
        // A later read may succeed, and the events have the data, too.
        let Some(id) = self.streams.run(stream).cloned() else { return };
        let Some(source) = self.open(&id) else { return };
        drop(watches.scan(stream, source.reader(), session));
    }

    /// Goes on with the runs that earlier starts sent, which this list names: they may have ended since.
    pub(super) fn restore(&mut self, list: &str, session: &mut RobotSession) {
        let listed: Vec<_> = list.lines().rev().take(LISTED_MAX).map(str::to_owned).collect();
        for id in listed {
            let folder = self.place.folder.join(&id);
            if folder.is_dir() && self.begin_from(&id, &folder, session) {
                self.gone(&id, session);
            }
        }
        let folders = run_folders(&self.place.folder).unwrap_or_default();
        let ids = folders.iter().filter_map(|folder| folder.file_name()?.to_str());
        let older = ids.filter(|id| !self.all.contains_key(*id)).map(str::to_owned).collect();
        self.ended.restore(older);
    }

    /// The runs whose files a scan does not have to read.
    pub(super) fn known(&self) -> BTreeSet<String> {
        self.ended.seen().chain(self.all.keys()).cloned().collect()
    }

    /// Goes on to the next of the older runs when the station has those before.
    fn scan_older(&mut self, session: &mut RobotSession, is_heard: bool) {
        let is_open = |run: &&RobotRun| run.is_older && !run.is_done(session);
        let mut open = self.all.values().filter(is_open).count();
        while is_heard
            && open < OLDER_AT_ONCE
            && let Some(id) = self.ended.pop_older()
        {
            let folder = self.place.folder.join(&id);
            let is_over = matches!(writer_of(&folder), Ok(None)) && !self.all.contains_key(&id);
            // An unreadable run is not sent.
            if is_over && self.begin_from(&id, &folder, session) {
                self.all.get_mut(&id).iter_mut().for_each(|run| run.send_last(session));
                self.gone(&id, session);
                open += 1;
            }
        }
    }

    /// Names the runs that are over again: a station that has started again may have lost them.
    pub(super) fn name_again(&mut self, session: &mut RobotSession) {
        let all = &self.all;
        for id in self.ended.name_again(|id| all.contains_key(id)) {
            let folder = self.place.folder.join(&id);
            if self.begin_from(&id, &folder, session) {
                let streams = self.all.get(&id).map(RobotRun::streams);
                streams.into_iter().flatten().for_each(|stream| session.ask_first(stream));
                self.gone(&id, session);
            }
        }
    }

    /// Releases runs that are whole at the station, and deleted runs whose end is known there. Returns the streams of their
    /// events.
    pub(super) fn let_go(&mut self, session: &mut RobotSession) -> Vec<StreamId> {
        let done: Vec<_> = self.all.extract_if(.., |_, run| run.is_done(session)).collect();
        let mut streams = Vec::new();
        for (id, run) in done {
            for stream in run.streams() {
                session.end(stream);
                self.streams.end(stream);
            }
            streams.push(run.events);
            if run.fate == RunFate::Finished {
                self.ended.add_whole(LinkRun { id, head: run.head, missing: 0 });
            }
        }
        self.is_list_old |= !streams.is_empty();
        streams
    }

    /// True if the next step of [`RobotRuns::go_on`] may change something. Most of it waits for reports of the station.
    pub(super) fn is_busy(&self, is_heard: bool) -> bool {
        let mut ended = self.all.values().filter(|run| run.runner.is_none());
        let is_over = |run: &RobotRun| matches!(run.fate, RunFate::Finished | RunFate::Removed);
        let is_due = |run: &RobotRun| !run.is_hashed() && !run.is_unreadable;
        let waits = |run: &RobotRun| is_due(run) || is_heard && is_over(run);
        is_heard && self.ended.has_older() || ended.any(waits)
    }

    /// Continues with ended runs, in steps short enough for the loop.
    pub(super) fn go_on(&mut self, session: &mut RobotSession, is_heard: bool) {
        self.scan_older(session, is_heard);
        self.hash(session);
    }

    /// Releases machines and journals that nothing needs. Reads no folder.
    pub(super) fn release(&mut self, session: &mut RobotSession) {
        self.parcels.tell_waiting();
        for run in self.all.values_mut() {
            run.let_go(session, &mut self.parcels);
            run.rest();
        }
    }

    /// Applies a scan of the folder: follows runs that continue, and sends new ones and their machines.
    pub(super) fn scanned(&mut self, found: Vec<FoundRun>, session: &mut RobotSession) {
        let there: BTreeSet<_> = found.iter().map(|run| run.id.clone()).collect();
        self.ended.retain(|id| there.contains(id));
        for (id, run) in &mut self.all {
            if run.runner.is_none() && run.fate != RunFate::Removed && !there.contains(id) {
                run.fate = RunFate::Removed;
                run.tell(ReportedRunState::of(run.fate, None, 0), session);
            }
        }
        for run in found {
            self.found(run, session);
        }
    }

    fn found(&mut self, found: FoundRun, session: &mut RobotSession) {
        let FoundRun { id, is_live, files, machines } = found;
        let is_new = !self.all.contains_key(&id) && !self.ended.has_seen(&id);
        let begun = match files {
            Some(files) if is_new => Some(self.begin(&id, files, session)),
            _ => None,
        };
        let run = self.all.get(&id);
        let is_followed = run.is_some_and(|run| run.runner.is_some());
        let was_live = run.is_some_and(|run| run.fate == RunFate::Live);
        if is_live {
            if !is_followed {
                self.follow(&id, session);
            }
            self.add_machines(&id, machines, session);
        } else if !is_followed {
            if begun.is_some() {
                self.ended.add_seen(&id);
            }
            if was_live || begun == Some(true) {
                self.gone(&id, session);
            }
        }
    }

    fn add_machines(&mut self, id: &str, machines: FoundMachines, session: &mut RobotSession) {
        if let Some(run) = self.all.get_mut(id) {
            // The scan does not know that the run is sent anew.
            let is_gap = machines.before > run.machines;
            let machines =
                if is_gap { FoundMachines::read(&run.folder, run.machines) } else { machines };
            run.add_machines(machines, session, &mut self.parcels, self.place.tell);
        }
    }

    /// Joins the runner of a run. A run that was sent before, and continues now, is sent again.
    fn follow(&mut self, id: &str, session: &mut RobotSession) {
        let folder = self.place.folder.join(id);
        if !self.all.contains_key(id) && !self.begin_from(id, &folder, session) {
            return;
        }
        let Some(run) = self.all.get_mut(id) else { return };
        match run.source() {
            Ok(source) => {
                run.source = Some(source);
                run.runner = Followed::join(&folder, id, run.head + 1, &self.place.inbox);
                run.fate = RunFate::Live;
            }
            Err(JournalError::NoRun { .. }) => {}
            Err(error) => {
                (self.place.tell)(&format!("run {id} is not sent to the station: {error}"));
            }
        }
    }

    /// Begins to send the run in a folder. False if it cannot be read, or is not sent.
    fn begin_from(&mut self, id: &str, folder: &Path, session: &mut RobotSession) -> bool {
        RunFiles::read(folder).is_ok_and(|files| self.begin(id, files, session))
    }

    /// Begins to send a run. False if it is itself a replica.
    fn begin(&mut self, id: &str, files: RunFiles, session: &mut RobotSession) -> bool {
        let RunFiles { about, head } = files;
        if about.robot.is_some() {
            return false;
        }
        let about = about_parts(&about);
        let [events, beside] = self.streams.begin(id);
        session.begin(beside, about.len() as u64);
        session.set_state(beside, &[], true);
        session.set_rank(beside, Rank::Description);
        session.begin(events, head);
        let run = RobotRun {
            folder: self.place.folder.join(id),
            events,
            pickle_max: self.place.pickle_max,
            about,
            machines: 0,
            machine_bytes: 0,
            named: Vec::new(),
            source: None,
            was_read: false,
            is_unreadable: false,
            is_older: false,
            head,
            runner: None,
            snapshot: None,
            fate: RunFate::default(),
            reported: ReportedRunState::default(),
            too_long: None,
            chain: Some(Chain::default()),
        };
        self.all.insert(id.to_owned(), run);
        self.is_list_old = true;
        true
    }

    /// Entries for the end of the file with the numbers of the runs.
    pub(super) fn take_numbers(&mut self) -> Vec<u8> {
        self.streams.take_unsaved()
    }

    /// The list of the runs that are sent, for the next start, if it has changed.
    pub(super) fn take_list(&mut self) -> Option<String> {
        std::mem::take(&mut self.is_list_old).then(|| {
            let sent = self.all.iter().filter(|(_, run)| !run.is_older);
            sent.flat_map(|(id, _)| [id, "\n"]).collect()
        })
    }

    /// These parcels are sent from now on, and no others.
    pub(super) fn set_parcels(&mut self, parcels: Vec<SentParcel>, session: &mut RobotSession) {
        self.parcels.set(parcels, session);
    }

    /// A run is in this state.
    pub(super) fn reported(
        &mut self,
        id: &str,
        snapshot: Box<Snapshot>,
        session: &mut RobotSession,
    ) {
        if let Some(run) = self.all.get_mut(id) {
            run.snapshot = Some((snapshot, self.place.clock.now()));
            session.set_snapshot_changed(run.events);
        }
    }

    /// The runner of a run has ended or crashed.
    pub(super) fn gone(&mut self, id: &str, session: &mut RobotSession) {
        let Some(run) = self.all.get_mut(id) else { return };
        run.runner = None;
        // Files beside the database of a crashed runner are included.
        match run.source() {
            Ok(source) => {
                run.source = Some(source);
                self.note_opened(id);
            }
            Err(error) => {
                (self.place.tell)(&format!("the journal of run {id} cannot be read: {error}"));
            }
        }
        self.happened(id, session);
        if let Some(run) = self.all.get_mut(id) {
            let machines = FoundMachines::read(&run.folder, run.machines);
            run.add_machines(machines, session, &mut self.parcels, self.place.tell);
            let is_over = matches!(Summary::of(&run.folder).state, RunState::Finished { .. });
            run.fate = if is_over { RunFate::Finished } else { RunFate::Crashed };
            run.tell(ReportedRunState::of(run.fate, None, 0), session);
        }
    }

    /// Publishes the control of running runs at this time of the calendar.
    pub(super) fn tell_control(
        &mut self,
        session: &mut RobotSession,
        now_ms: u64,
        control: impl Fn(&str) -> Option<Control>,
    ) {
        for (id, run) in self.all.iter_mut().filter(|(_, run)| run.fate == RunFate::Live) {
            run.tell(ReportedRunState::of(run.fate, control(id), now_ms), session);
        }
    }

    /// Sends the time of the last contact to the runners, because machines define their behaviour without it.
    pub(super) fn tell_ground(&mut self, now: SessionTime, heard: Option<SessionTime>) {
        for runner in self.all.values_mut().filter_map(|run| run.runner.as_mut()) {
            runner.tell_ground(now, heard);
        }
    }

    /// The id of the run whose events these are.
    pub(super) fn name(&self, events: StreamId) -> Option<&str> {
        let known = || self.ended.seen().find(|id| self.streams.is_of(events, id));
        self.streams.run(events).or_else(known).map(String::as_str)
    }

    /// Gives a command to the runner of a run; false if it has none.
    pub(super) fn command(&mut self, id: &str, envelope: Envelope) -> bool {
        self.all
            .get_mut(id)
            .and_then(|run| run.runner.as_mut())
            .is_some_and(|it| it.command(envelope))
    }

    /// False while a run has just begun and its runner listens to nobody yet.
    pub(super) fn make_ready(&mut self, stream: StreamId) -> bool {
        let Some(id) = self.name(stream).map(str::to_owned) else { return true };
        let Some(run) = self.all.get_mut(&id) else { return true };
        if run.runner.is_none() && run.fate == RunFate::Live {
            run.runner = Followed::join(&run.folder, &id, run.head + 1, &self.place.inbox);
        }
        let is_over = || run.fate != RunFate::Live || matches!(writer_of(&run.folder), Ok(None));
        run.runner.is_some() || is_over()
    }

    /// The answer to a command in the journal of a run.
    pub(super) fn answer_of(&self, stream: StreamId, command: &str) -> Option<Answer> {
        let folder = &self.all.get(self.name(stream)?)?.folder;
        let moment = Reader::open(folder).ok()?.moment(u64::MAX).ok()?;
        moment.whole().answer(command).cloned()
    }

    /// Reported progress of each run at the station.
    pub(super) fn progress(&self, session: &RobotSession) -> Vec<LinkRun> {
        let run = |(id, run): (&String, &RobotRun)| {
            let (head, missing) = session.progress(run.events)?;
            Some(LinkRun { id: id.clone(), head, missing })
        };
        self.ended.whole().cloned().chain(self.all.iter().filter_map(run)).collect()
    }

    /// Events that the link cannot carry.
    pub(super) fn problems(&self) -> Vec<String> {
        let problem = |(id, run): (&String, &RobotRun)| {
            let (number, bytes) = run.too_long?;
            Some(format!(
                "event {number} of run {id} has {bytes} bytes, and the link carries {LENGTH_MAX}: the station receives neither it nor \
                 the events after it"
            ))
        };
        self.all.iter().filter_map(problem).collect()
    }

    /// Tells the relay what became of the request with this id, from any thread.
    pub(super) fn answerer(&self, id: String) -> Answered {
        let inbox = self.place.inbox.clone();
        // Without the relay, nobody waits for the answer.
        Box::new(move |answer| drop(inbox.send(Input::Other(FromRun::Answered(None, id, answer)))))
    }

    /// The folder of the run with these events, whether it is sent now or not.
    fn folder_of(&self, events: StreamId) -> Option<PathBuf> {
        Some(self.place.folder.join(self.name(events)?))
    }

    fn run(&mut self, stream: StreamId) -> Option<&mut RobotRun> {
        self.all.get_mut(self.streams.run(stream)?)
    }
}

#[cfg(test)]
mod tests;
