//! The runs of a robot: which there are, what of them is sent, and from where.

mod run;
mod source;

use super::follow::{Followed, FromRun};
use super::numbers::RunNumbers;
use super::parcels::{SentParcel, SentParcels};
use super::values::RobotValues;
use super::watches::RobotWatches;
use crate::about::about_parts;
use crate::clock::SessionClock;
use crate::ids;
use crate::inbox::Input;
use crate::requests::Answered;
use crate::words::{ReportedRunState, RunFate};
use rafcon_link::{EventHash, Events, LENGTH_MAX, Rank, RobotSession, StreamId};
use rafcon_protocol::api::Control;
use rafcon_protocol::{Answer, Envelope, LinkRun, Snapshot};
use rafcon_storage::journal::{
    About, Chain, EventItems, EventSource, JournalError, Reader, RunState, Summary, run_folders,
    writer_of,
};
use run::RobotRun;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::SyncSender;
use std::time::Duration;

/// Up to this many new events are sent before the backlog. The journal has the others.
const AHEAD_MAX: u64 = 64;

/// Limit of older runs that are sent at a time.
const OLDER_AT_ONCE: usize = 2;
/// Newest whole runs that are named at once after a start of the station.
const NAMED_AGAIN: usize = 16;
/// Capacity of the whole runs in reports.
const WHOLE_MAX: usize = 8;

/// Bytes of events hashed in one step.
const HASH_BYTES: usize = 256 << 10;
/// Number of ended runs whose events are hashed in one step.
const HASHED_AT_ONCE: usize = 16;
/// Limit of open journals of ended runs. Each takes some 300 KB of memory.
const OPEN_MAX: usize = 32;

/// Limit of runs of earlier starts that are scanned again.
const LISTED_MAX: usize = 256;

/// The runs of a robot.
#[derive(Debug)]
pub(super) struct RobotRuns {
    folder: PathBuf,
    /// Lists the runs that were sent, for the next start.
    list: PathBuf,
    inbox: SyncSender<Input<FromRun>>,
    tell: fn(&str),
    clock: SessionClock,
    all: BTreeMap<String, RobotRun>,
    streams: BTreeMap<StreamId, String>,
    /// Ended runs whose journals were opened, the oldest first.
    opened: VecDeque<String>,
    /// The list on the disk is older than the runs.
    is_list_old: bool,
    numbers: RunNumbers,
    /// Newest runs that are whole at the station.
    whole: VecDeque<LinkRun>,
    /// The runs that were over before the robot had this station: they are sent last, the newest first.
    older: Vec<String>,
    /// The runs that are known without being sent now.
    seen: BTreeSet<String>,
    parcels: SentParcels,
    values: RobotValues,
    /// Longer pickles are sent by their hash.
    pickle_max: usize,
}

impl RobotRuns {
    pub(super) fn new(
        folder: &Path,
        list: PathBuf,
        inbox: SyncSender<Input<FromRun>>,
        (tell, clock): (fn(&str), SessionClock),
        parcels: SentParcels,
    ) -> Self {
        let (all, streams, folder) = (BTreeMap::new(), BTreeMap::new(), folder.to_owned());
        let numbers = RunNumbers::read(list.with_file_name("numbers"));
        Self {
            folder,
            list,
            inbox,
            tell,
            clock,
            all,
            streams,
            opened: VecDeque::new(),
            is_list_old: false,
            numbers,
            whole: VecDeque::new(),
            older: Vec::new(),
            seen: BTreeSet::new(),
            parcels,
            values: RobotValues::default(),
            pickle_max: usize::MAX,
        }
    }

    /// Longer pickles are sent by their hash from now on.
    pub(super) fn set_pickle_max(&mut self, bytes: usize) {
        self.pickle_max = bytes;
    }

    /// Looks for new values of a run that are watched.
    pub(super) fn scan_watched(
        &mut self,
        stream: StreamId,
        watches: &mut RobotWatches,
        session: &mut RobotSession,
    ) {
        // A later read may succeed, and the events have the data, too.
        let Some(id) = self.streams.get(&stream).cloned() else { return };
        let Some(source) = self.open(&id) else { return };
        drop(watches.scan(stream, source.reader(), session));
    }

    /// Goes on with the runs that earlier starts sent: they may have ended since.
    pub(super) fn restore(&mut self, session: &mut RobotSession) {
        let list = fs::read_to_string(&self.list).unwrap_or_default();
        let listed: Vec<_> = list.lines().rev().take(LISTED_MAX).map(str::to_owned).collect();
        for id in listed {
            let folder = self.folder.join(&id);
            if folder.is_dir() && self.begin(&id, &folder, session).unwrap_or(false) {
                self.gone(&id, session);
            }
        }
        let folders = run_folders(&self.folder).unwrap_or_default();
        let ids = folders.iter().filter_map(|folder| folder.file_name()?.to_str());
        self.older = ids.filter(|id| !self.all.contains_key(*id)).map(str::to_owned).collect();
        // The newest is taken first.
        self.older.sort();
        self.seen = self.older.iter().cloned().collect();
    }

    /// Goes on to the next of the older runs when the station has those before.
    fn scan_older(&mut self, session: &mut RobotSession, is_heard: bool) {
        let is_open = |run: &&RobotRun| run.is_older && !run.is_done(session);
        let mut open = self.all.values().filter(is_open).count();
        while is_heard
            && open < OLDER_AT_ONCE
            && let Some(id) = self.older.pop()
        {
            let folder = self.folder.join(&id);
            let is_over = matches!(writer_of(&folder), Ok(None)) && !self.all.contains_key(&id);
            // An unreadable run is not sent.
            if is_over && self.begin(&id, &folder, session).unwrap_or(false) {
                self.all.get_mut(&id).iter_mut().for_each(|run| run.send_last(session));
                self.gone(&id, session);
                open += 1;
            }
        }
    }

    /// Names the runs that are over again: a station that has started again may have lost them.
    pub(super) fn name_again(&mut self, session: &mut RobotSession) {
        self.whole.clear();
        let mut known: Vec<_> = self.seen.iter().cloned().collect();
        known.retain(|id| !self.all.contains_key(id) && !self.older.contains(id));
        let newest = known.split_off(known.len().saturating_sub(NAMED_AGAIN));
        self.older.extend(known);
        self.older.sort();
        for id in newest {
            let folder = self.folder.join(&id);
            if self.begin(&id, &folder, session).unwrap_or(false) {
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
                self.streams.remove(&stream);
            }
            streams.push(run.events);
            if run.fate == RunFate::Finished {
                self.remember_whole(LinkRun { id: id.clone(), head: run.head, missing: 0 });
                self.seen.insert(id);
            }
        }
        self.is_list_old |= !streams.is_empty();
        self.keep_list();
        streams
    }

    /// True if the next step of [`RobotRuns::go_on`] may change something. Most of it waits for reports of the station.
    pub(super) fn is_busy(&self, is_heard: bool) -> bool {
        let mut ended = self.all.values().filter(|run| run.runner.is_none());
        let is_over = |run: &RobotRun| matches!(run.fate, RunFate::Finished | RunFate::Removed);
        let is_due = |run: &RobotRun| !run.is_hashed() && !run.is_unreadable;
        let waits = |run: &RobotRun| is_due(run) || is_heard && is_over(run);
        is_heard && !self.older.is_empty() || ended.any(waits)
    }

    /// Continues with ended runs, in steps short enough for the loop.
    pub(super) fn go_on(&mut self, session: &mut RobotSession, is_heard: bool) {
        self.scan_older(session, is_heard);
        self.hash(session);
    }

    /// Lists a whole run in reports, in the place of the oldest if there are many.
    fn remember_whole(&mut self, run: LinkRun) {
        self.whole.push_back(run);
        self.whole.drain(..self.whole.len().saturating_sub(WHOLE_MAX));
    }

    /// Looks for runs that continue and are not followed, and for machines that runs have kept since.
    pub(super) fn scan(&mut self, session: &mut RobotSession, is_heard: bool) {
        self.parcels.tell_waiting();
        for run in self.all.values_mut() {
            // An ended run does not change after its last scan.
            if run.runner.is_some() {
                run.look_for_machines(session, &mut self.parcels, self.tell);
            } else if run.fate != RunFate::Removed && !run.folder.is_dir() {
                run.fate = RunFate::Removed;
                run.tell(ReportedRunState::of(run.fate, None, 0), session);
            }
            run.let_go(session, &mut self.parcels);
            run.rest();
        }
        self.go_on(session, is_heard);
        let folders = run_folders(&self.folder).unwrap_or_default();
        let there: BTreeSet<_> = folders.iter().filter_map(|folder| folder.file_name()).collect();
        self.seen.retain(|id| there.contains(OsStr::new(id)));
        for folder in &folders {
            let id = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let run = self.all.get(&id);
            if run.is_some_and(|run| run.runner.is_some()) {
                continue;
            }
            let is_live = matches!(writer_of(folder), Ok(Some(_)));
            if !is_live {
                let was_live = run.is_some_and(|run| run.fate == RunFate::Live);
                self.scan_ended(&id, folder, was_live, session);
                continue;
            }
            match self.find(&id, folder, session) {
                // The runner has just locked the folder, and writes its files now.
                Ok(()) | Err(JournalError::NoRun { .. }) => {}
                Err(error) => {
                    (self.tell)(&format!("run {id} is not sent to the station: {error}"));
                }
            }
        }
    }

    /// A run that ended before its runner was followed, or between two scans.
    fn scan_ended(&mut self, id: &str, folder: &Path, was_live: bool, session: &mut RobotSession) {
        let is_new = !self.all.contains_key(id) && !self.seen.contains(id);
        // An unreadable run may be about to start, so that it is scanned again.
        let begun = if is_new { self.begin(id, folder, session).ok() } else { None };
        if begun.is_some() {
            self.seen.insert(id.to_owned());
        }
        if was_live || begun == Some(true) {
            self.gone(id, session);
        }
    }

    /// Continues the hashes of all runs, those that run first.
    fn hash(&mut self, session: &mut RobotSession) {
        let due = |is_live: bool| {
            let runs = self.all.iter().filter(move |(_, run)| run.runner.is_some() == is_live);
            runs.filter(|(_, run)| !run.is_hashed()).map(|(id, _)| id.clone())
        };
        let due: Vec<_> = due(true).chain(due(false)).collect();
        let (mut left, mut ended_left) = (HASH_BYTES, HASHED_AT_ONCE);
        for id in due {
            // A journal that cannot be read now holds up no other.
            if self.open(&id).is_none() {
                continue;
            }
            let Some(run) = self.all.get_mut(&id) else { continue };
            let (Some(chain), Some(source)) = (&mut run.chain, &mut run.source) else { continue };
            // An incomplete journal has no hash.
            let Ok(hashed) = chain.advance(source.reader(), run.head, left) else {
                run.chain = None;
                continue;
            };
            left = left.saturating_sub(hashed);
            if chain.last() == run.head {
                let (last, hash) = (chain.last(), chain.hash());
                session.set_chain(run.events, EventHash { last, hash });
            }
            ended_left -= usize::from(run.runner.is_none());
            if left == 0 || ended_left == 0 {
                break;
            }
        }
    }

    /// The journal of a run. Of ended runs, those that were opened last stay open.
    fn open(&mut self, id: &str) -> Option<&mut EventSource> {
        let run = self.all.get(id)?;
        if run.source.is_none() && run.runner.is_none() {
            self.note_opened(id);
        }
        self.all.get_mut(id)?.open()
    }

    fn note_opened(&mut self, id: &str) {
        self.opened.retain(|opened| opened != id);
        self.opened.push_back(id.to_owned());
        while self.opened.len() > OPEN_MAX
            && let Some(oldest) = self.opened.pop_front()
        {
            let ended = self.all.get_mut(&oldest).filter(|run| run.runner.is_none());
            if let Some(ended) = ended {
                ended.source = None;
            }
        }
    }

    fn find(
        &mut self,
        id: &str,
        folder: &Path,
        session: &mut RobotSession,
    ) -> Result<(), JournalError> {
        if !self.all.contains_key(id) && !self.begin(id, folder, session)? {
            return Ok(());
        }
        let Some(run) = self.all.get_mut(id) else { return Ok(()) };
        run.source = Some(run.source()?);
        run.runner = Followed::join(folder, id, run.head + 1, &self.inbox);
        run.fate = RunFate::Live;
        Ok(())
    }

    /// Begins to send a run; not if it is itself a replica.
    fn begin(
        &mut self,
        id: &str,
        folder: &Path,
        session: &mut RobotSession,
    ) -> Result<bool, JournalError> {
        let about = About::read(folder)?;
        if about.robot.is_some() {
            return Ok(false);
        }
        let about = about_parts(&about);
        let head = EventSource::open(folder)?.last()?;
        let events = self.numbers.take(id);
        let beside = ids::about_beside(events);
        session.begin(beside, about.len() as u64);
        session.set_state(beside, &[], true);
        session.set_rank(beside, Rank::Description);
        session.begin(events, head);
        self.streams.extend([(events, id.to_owned()), (beside, id.to_owned())]);
        let (folder, runner) = (folder.to_owned(), None);
        let run = RobotRun {
            folder,
            events,
            pickle_max: self.pickle_max,
            about,
            machines: 0,
            machine_bytes: 0,
            named: Vec::new(),
            source: None,
            was_read: false,
            is_unreadable: false,
            is_older: false,
            head,
            runner,
            snapshot: None,
            fate: RunFate::default(),
            reported: ReportedRunState::default(),
            too_long: None,
            chain: Some(Chain::default()),
        };
        self.all.insert(id.to_owned(), run);
        self.is_list_old = true;
        Ok(true)
    }

    /// Writes the list if it has changed.
    fn keep_list(&mut self) {
        if !std::mem::take(&mut self.is_list_old) {
            return;
        }
        let sent = self.all.iter().filter(|(_, run)| !run.is_older);
        let list: String = sent.flat_map(|(id, _)| [id, "\n"]).collect();
        if let Err(error) = fs::write(&self.list, list) {
            let list = self.list.display();
            (self.tell)(&format!(
                "{list} cannot be written: after a restart, ended runs are not sent: {error}"
            ));
        }
    }

    /// Sends what is new in the journal of a run.
    pub(super) fn happened(&mut self, id: &str, session: &mut RobotSession) {
        let Some(Ok(last)) = self.open(id).map(|source| source.last()) else { return };
        let Some(run) = self.all.get_mut(id) else { return };
        if last > run.head + AHEAD_MAX {
            session.advance(run.events, last);
            run.head = last;
        }
        while run.head < last {
            let next = run.head + 1;
            let read = run.open().map(|source| source.read(next, last, 0));
            let Some(Ok(Some(read))) = read else { return };
            let EventItems { first, count, t_before, bytes } = &read;
            let (stream, first, count, t_before) = (run.events, *first, *count, *t_before);
            session.append(&Events { stream, first, count, t_before, items: bytes });
            run.head = first + count - 1;
        }
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
            run.snapshot = Some((snapshot, self.clock.now()));
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
            Err(error) => (self.tell)(&format!("the journal of run {id} cannot be read: {error}")),
        }
        self.happened(id, session);
        if let Some(run) = self.all.get_mut(id) {
            run.look_for_machines(session, &mut self.parcels, self.tell);
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
    pub(super) fn tell_ground(&mut self, now: Duration, heard: Option<Duration>) {
        for runner in self.all.values_mut().filter_map(|run| run.runner.as_mut()) {
            runner.tell_ground(now, heard);
        }
    }

    /// The id of the run whose events these are.
    pub(super) fn name(&self, events: StreamId) -> Option<&str> {
        let known = || self.seen.iter().find(|id| self.numbers.find(id) == Some(events));
        self.streams.get(&events).or_else(known).map(String::as_str)
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
            run.runner = Followed::join(&run.folder, &id, run.head + 1, &self.inbox);
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
        self.whole.iter().cloned().chain(self.all.iter().filter_map(run)).collect()
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
        let inbox = self.inbox.clone();
        // Without the relay, nobody waits for the answer.
        Box::new(move |answer| drop(inbox.send(Input::Other(FromRun::Answered(None, id, answer)))))
    }

    /// The folder of the run with these events, whether it is sent now or not.
    fn folder_of(&self, events: StreamId) -> Option<PathBuf> {
        Some(self.folder.join(self.name(events)?))
    }

    fn run(&mut self, stream: StreamId) -> Option<&mut RobotRun> {
        self.all.get_mut(self.streams.get(&stream)?)
    }
}

#[cfg(test)]
mod tests;
