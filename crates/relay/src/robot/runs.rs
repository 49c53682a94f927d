//! The runs of a robot: which there are, what of them is sent, and from where.

use super::follow::{Followed, FromRun};
use super::parcels::{NeededMachine, ParcelWork, SentParcel, SentParcels};
use super::values::RobotValues;
use super::watches::RobotWatches;
use crate::about::{PARCEL_MAX, about_parts, machine_parts, named_parts};
use crate::clock::SessionClock;
use crate::ids;
use crate::inbox::Input;
use crate::meter::millis;
use crate::snapshot_words;
use crate::words::{RunFate, RunStands};
use rafcon_link::{
    EventBuffer, EventHash, Events, Rank, RobotSession, RunSource, StreamId, ValueName,
};
use rafcon_protocol::api::Control;
use rafcon_protocol::{Envelope, LinkRun, Snapshot};
use rafcon_storage::journal::{
    About, Chain, EventItems, EventSource, Hash, JournalError, Pack, RunState, Summary,
    run_folders, writer_of,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::SyncSender;
use std::time::Duration;

/// Of so many new events each goes ahead of older ones; of more the journal has them, in their turn.
const AHEAD_MAX: u64 = 64;

/// So many of the older runs are sent at a time.
const OLDER_AT_ONCE: usize = 2;

/// So many bytes of events are hashed at a time.
const HASH_BYTES: usize = 256 << 10;

/// So many of the runs that earlier starts sent are looked at again.
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
    /// The runs that were over before the robot had this station: they are sent last, the newest first.
    older: Vec<String>,
    /// The runs that are known without being sent now.
    seen: BTreeSet<String>,
    parcels: SentParcels,
    values: RobotValues,
    /// Longer pickles are sent by their hash.
    pickle_max: usize,
}

#[derive(Debug)]
struct RobotRun {
    folder: PathBuf,
    /// Longer pickles are sent by their hash.
    pickle_max: usize,
    /// What is known about it, in parts, how many machines are among that, and how many bytes of files they have.
    about: Vec<Vec<u8>>,
    machines: usize,
    machine_bytes: usize,
    /// The machines that come in parcels, as long as the station may not have them.
    named: Vec<Hash>,
    /// Its journal, while it is read.
    source: Option<EventSource>,
    was_read: bool,
    head: u64,
    runner: Option<Followed>,
    /// The state that its runner told last, and when.
    snapshot: Option<(Box<Snapshot>, Duration)>,
    fate: RunFate,
    /// It was over before the robot had this station.
    is_older: bool,
    /// What was told of it last.
    stands: RunStands,
    /// The hash of its events; none if the journal does not have them all.
    chain: Option<Chain>,
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
        Self {
            folder,
            list,
            inbox,
            tell,
            clock,
            all,
            streams,
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
    pub(super) fn look_at_watched(
        &mut self,
        stream: StreamId,
        watches: &mut RobotWatches,
        session: &mut RobotSession,
    ) {
        // What cannot be read now may be later; the events say the same.
        let Some(source) = self.run(stream).and_then(RobotRun::open) else { return };
        drop(watches.look(stream, source.reader(), session));
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
    fn look_at_older(&mut self, session: &mut RobotSession, is_heard: bool) {
        let is_open = |(id, run): (&String, &RobotRun)| run.is_older && !has_all(session, id);
        let open = self.all.iter().filter(|run| is_open(*run)).count();
        if !is_heard || open >= OLDER_AT_ONCE {
            return;
        }
        while let Some(id) = self.older.pop() {
            let folder = self.folder.join(&id);
            let is_over = matches!(writer_of(&folder), Ok(None)) && !self.all.contains_key(&id);
            // What cannot be read is not sent, as if it were not there.
            if is_over && self.begin(&id, &folder, session).unwrap_or(false) {
                session.set_rank(ids::events_of(&id), Rank::Last);
                session.set_rank(ids::about_of(&id), Rank::Last);
                if let Some(run) = self.all.get_mut(&id) {
                    run.is_older = true;
                }
                self.gone(&id, session);
                return;
            }
        }
    }

    /// Looks for runs that continue and are not followed, and for machines that runs have kept since.
    pub(super) fn look(&mut self, session: &mut RobotSession, is_heard: bool) {
        self.parcels.tell_waiting();
        for (id, run) in &mut self.all {
            // A run that is over has what it had when it was looked at last.
            if run.runner.is_some() {
                run.look_for_machines(id, session, &mut self.parcels);
            } else if run.fate != RunFate::Removed && !run.folder.is_dir() {
                run.fate = RunFate::Removed;
                run.tell(id, RunStands::of(run.fate, None, 0), session);
            }
            run.let_go(id, session, &mut self.parcels);
            run.rest();
        }
        self.hash(session);
        self.look_at_older(session, is_heard);
        for folder in run_folders(&self.folder).unwrap_or_default() {
            let id = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let is_live = matches!(writer_of(&folder), Ok(Some(_)));
            let run = self.all.get(&id);
            if run.is_some_and(|run| run.runner.is_some()) {
                continue;
            }
            if !is_live {
                let was_live = run.is_some_and(|run| run.fate == RunFate::Live);
                self.look_at_ended(&id, &folder, was_live, session);
                continue;
            }
            if let Err(error) = self.find(&id, &folder, session) {
                (self.tell)(&format!("run {id} is not sent to the station: {error}"));
            }
        }
    }

    /// A run that ended before its runner could be followed, or between two looks.
    fn look_at_ended(
        &mut self,
        id: &str,
        folder: &Path,
        was_live: bool,
        session: &mut RobotSession,
    ) {
        let is_new = !self.all.contains_key(id) && !self.seen.contains(id);
        // What cannot be read may be about to begin: it is looked at again.
        let begun = if is_new { self.begin(id, folder, session).ok() } else { None };
        if begun.is_some() {
            self.seen.insert(id.to_owned());
        }
        if was_live || begun == Some(true) {
            self.gone(id, session);
        }
    }

    /// Goes on with the hashes of the events of all runs, so far at a time that nothing else waits for it.
    fn hash(&mut self, session: &mut RobotSession) {
        let mut left = HASH_BYTES;
        let (live, ended): (Vec<_>, Vec<_>) =
            self.all.iter_mut().partition(|(_, run)| run.runner.is_some());
        for (id, run) in live.into_iter().chain(ended) {
            let head = run.head;
            if run.chain.is_none_or(|chain| chain.last() >= head) || run.open().is_none() {
                continue;
            }
            let (Some(chain), Some(source)) = (&mut run.chain, &mut run.source) else { continue };
            // Of a journal that has dropped something there is none.
            if chain.advance(source.reader(), run.head, left).is_err() {
                run.chain = None;
                continue;
            }
            if chain.last() == run.head {
                let (last, hash) = (chain.last(), chain.hash());
                session.set_chain(ids::events_of(id), EventHash { last, hash });
            }
            // Of those that are over, one at a time.
            if chain.last() < run.head || run.runner.is_none() {
                left = 0;
            }
            if left == 0 {
                break;
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
        let (events, beside) = (ids::events_of(id), ids::about_of(id));
        session.begin(beside, about.len() as u64);
        session.set_state(beside, &[], true);
        session.begin(events, head);
        self.streams.extend([(events, id.to_owned()), (beside, id.to_owned())]);
        let (folder, runner) = (folder.to_owned(), None);
        let run = RobotRun {
            folder,
            pickle_max: self.pickle_max,
            about,
            machines: 0,
            machine_bytes: 0,
            named: Vec::new(),
            source: None,
            was_read: false,
            is_older: false,
            head,
            runner,
            snapshot: None,
            fate: RunFate::default(),
            stands: RunStands::default(),
            chain: Some(Chain::default()),
        };
        self.all.insert(id.to_owned(), run);
        self.keep_list();
        Ok(true)
    }

    fn keep_list(&self) {
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
        let Some(run) = self.all.get_mut(id) else { return };
        let Some(Ok(last)) = run.open().map(|source| source.last()) else { return };
        if last > run.head + AHEAD_MAX {
            session.advance(ids::events_of(id), last);
            run.head = last;
        }
        while run.head < last {
            let next = run.head + 1;
            let read = run.open().map(|source| source.read(next, last, 0));
            let Some(Ok(Some(read))) = read else { return };
            let EventItems { first, count, t_before, bytes } = &read;
            let (stream, first, count, t_before) = (ids::events_of(id), *first, *count, *t_before);
            session.append(&Events { stream, first, count, t_before, items: bytes });
            run.head = first + count - 1;
        }
    }

    /// These parcels are sent from now on, and no others.
    pub(super) fn set_parcels(&mut self, parcels: Vec<SentParcel>, session: &mut RobotSession) {
        self.parcels.set(parcels, session);
    }

    /// A run is in this state.
    pub(super) fn stands(&mut self, id: &str, snapshot: Box<Snapshot>, session: &mut RobotSession) {
        if let Some(run) = self.all.get_mut(id) {
            run.snapshot = Some((snapshot, self.clock.now()));
            session.set_snapshot_changed(ids::events_of(id));
        }
    }

    /// The runner of a run is gone: it has ended, or died.
    pub(super) fn gone(&mut self, id: &str, session: &mut RobotSession) {
        let Some(run) = self.all.get_mut(id) else { return };
        run.runner = None;
        // What is beside the database of a dead runner counts, too.
        match run.source() {
            Ok(source) => run.source = Some(source),
            Err(error) => (self.tell)(&format!("the journal of run {id} cannot be read: {error}")),
        }
        self.happened(id, session);
        if let Some(run) = self.all.get_mut(id) {
            run.look_for_machines(id, session, &mut self.parcels);
            let is_over = matches!(Summary::of(&run.folder).state, RunState::Finished { .. });
            run.fate = if is_over { RunFate::Finished } else { RunFate::Crashed };
            run.tell(id, RunStands::of(run.fate, None, 0), session);
        }
    }

    /// Tells who holds control of the runs that continue, as `control` says at this time of the calendar.
    pub(super) fn tell_control(
        &mut self,
        session: &mut RobotSession,
        now_ms: u64,
        control: impl Fn(&str) -> Option<Control>,
    ) {
        for (id, run) in self.all.iter_mut().filter(|(_, run)| run.fate == RunFate::Live) {
            run.tell(id, RunStands::of(run.fate, control(id), now_ms), session);
        }
    }

    /// Tells the runners when the ground was heard last: machines say what happens without it.
    pub(super) fn tell_ground(&mut self, now: Duration, heard: Option<Duration>) {
        for runner in self.all.values_mut().filter_map(|run| run.runner.as_mut()) {
            runner.tell_ground(now, heard);
        }
    }

    /// The id of the run whose events these are.
    pub(super) fn name(&self, events: StreamId) -> Option<&str> {
        self.streams.get(&events).map(String::as_str)
    }

    /// Gives a command to the runner of a run; false if it has none.
    pub(super) fn command(&mut self, id: &str, envelope: Envelope) -> bool {
        let Some(run) = self.all.get_mut(id) else { return false };
        if run.runner.is_none() && run.fate == RunFate::Live {
            // It had only just begun when it was found.
            run.runner = Followed::join(&run.folder, id, run.head + 1, &self.inbox);
        }
        run.runner.as_mut().is_some_and(|runner| runner.command(envelope))
    }

    /// How much of each run the station has, as far as it said so.
    pub(super) fn progress(&self, session: &RobotSession) -> Vec<LinkRun> {
        let run = |id: &String| {
            let (head, missing) = session.progress(ids::events_of(id))?;
            Some(LinkRun { id: id.clone(), head, missing })
        };
        self.all.keys().filter_map(run).collect()
    }

    /// The folder of the run with these events, whether it is sent now or not.
    fn folder_of(&self, events: StreamId) -> Option<PathBuf> {
        let is_it = |id: &&String| ids::events_of(id) == events;
        let id = self.streams.get(&events).or_else(|| self.seen.iter().find(is_it))?;
        Some(self.folder.join(id))
    }

    fn run(&mut self, stream: StreamId) -> Option<&mut RobotRun> {
        self.all.get_mut(self.streams.get(&stream)?)
    }
}

/// Whether the station reports that it has everything of a run.
fn has_all(session: &RobotSession, id: &str) -> bool {
    let streams = [ids::events_of(id), ids::about_of(id)];
    streams.iter().all(|stream| session.progress(*stream).is_none_or(|(_, missing)| missing == 0))
}

impl RobotRun {
    /// Its journal, to be read anew.
    fn source(&self) -> Result<EventSource, JournalError> {
        Ok(EventSource::open(&self.folder)?.without_pickles_over(self.pickle_max))
    }

    /// Its journal.
    fn open(&mut self) -> Option<&mut EventSource> {
        self.was_read = true;
        if self.source.is_none() {
            self.source = self.source().ok();
        }
        self.source.as_mut()
    }

    /// Lets go of the journal of a run that is over and was not read for a while.
    fn rest(&mut self) {
        if self.runner.is_none() && !self.was_read {
            self.source = None;
        }
        self.was_read = false;
    }

    /// Adds the machines that the run has kept since. They come in parcels, until they are very large together: then the run brings
    /// them itself. So each start of the robot sends the same parts.
    fn look_for_machines(
        &mut self,
        id: &str,
        session: &mut RobotSession,
        parcels: &mut SentParcels,
    ) {
        let Ok(packs) = Pack::read_after(&self.folder, self.machines) else { return };
        self.machines += packs.len();
        for pack in packs {
            self.machine_bytes += pack.fresh.values().map(Vec::len).sum::<usize>();
            if self.machine_bytes > PARCEL_MAX {
                self.about.extend(machine_parts(&pack));
                continue;
            }
            let machine = pack.manifest.hash();
            self.about.extend(named_parts(machine));
            self.named.push(machine);
            let needed = NeededMachine { is_older: self.is_older, machine };
            parcels.tell(ParcelWork::Needed(needed, self.folder.clone()));
        }
        session.advance(ids::about_of(id), self.about.len() as u64);
    }

    /// Lets go of the machines that the station has.
    fn let_go(&mut self, id: &str, session: &RobotSession, parcels: &mut SentParcels) {
        let is_told = session.progress(ids::about_of(id)).is_some_and(|(_, missing)| missing == 0);
        let is_gone = self.fate == RunFate::Removed;
        let had = |machine: &mut Hash| is_gone || is_told && parcels.are_had(*machine, session);
        let all_had: Vec<_> = self.named.extract_if(.., had).collect();
        for machine in all_had {
            let is_older = self.is_older;
            parcels.tell(ParcelWork::Had(NeededMachine { is_older, machine }));
        }
    }

    /// Tells how it stands, if that is news.
    fn tell(&mut self, id: &str, stands: RunStands, session: &mut RobotSession) {
        if stands != self.stands {
            let is_over = matches!(stands.fate, RunFate::Finished | RunFate::Removed);
            let state = serde_json::to_vec(&stands).unwrap_or_default();
            session.set_state(ids::events_of(id), &state, is_over);
            self.stands = stands;
        }
    }
}

impl RunSource for RobotRuns {
    fn events(
        &mut self,
        stream: StreamId,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Option<EventBuffer> {
        if stream.is_files() {
            let items = self.parcels.part(stream, first)?;
            return Some(EventBuffer { first, count: 1, t_before: 0, items });
        }
        let run = self.run(stream)?;
        if ids::is_about(stream) {
            let part = run.about.get(usize::try_from(first - 1).ok()?)?;
            return Some(EventBuffer { first, count: 1, t_before: 0, items: part.clone() });
        }
        let read = run.open()?.read(first, last, bytes_max).ok()??;
        let EventItems { first, count, t_before, bytes: items } = read;
        Some(EventBuffer { first, count, t_before, items })
    }

    fn snapshot(&mut self, stream: StreamId) -> Option<(u64, Vec<u8>)> {
        let now = self.clock.now();
        let run = self.run(stream).filter(|_| !ids::is_about(stream))?;
        let (snapshot, told) = run.snapshot.as_ref()?;
        // Its runner says something only when something changes: the time went on since.
        let since_ms =
            if run.fate == RunFate::Live { millis(now.saturating_sub(*told)) } else { 0 };
        Some((snapshot.sequence, snapshot_words::write(snapshot, since_ms)?))
    }

    fn value_length(&mut self, value: &ValueName) -> Option<u64> {
        let folder = self.folder_of(value.stream)?;
        self.values.length(&folder, value)
    }

    fn value_bytes(&mut self, value: &ValueName, offset: u64, bytes_max: usize) -> Option<Vec<u8>> {
        let folder = self.folder_of(value.stream)?;
        self.values.bytes(&folder, value, (offset, bytes_max))
    }
}
