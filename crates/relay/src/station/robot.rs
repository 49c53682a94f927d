//! One robot as a station knows it: its session, and the replicas of its runs.
//!
//! Long because it joins session, disk and viewers of one robot.

mod lists;

use super::asked::{Asked, is_room};
use super::disk::{Disk, FromDisk, KeyWork, OpenRun, SettledRun, Work};
use super::health::{health, run_of};
use super::in_order::InOrder;
use super::kept_runs::{KeptRuns, Place, Restored, RestoredState};
use super::lifetime::lifetime;
use super::parcels::{RestoredParcel, StationParcels};
use super::pending_requests::{PendingRequests, SendTimes, overdue};
use super::received::{Early, Received, StationRun};
use super::value_disk::FromValueDisk;
use super::values::StationValues;
use super::viewers::PendingRequest;
use super::{StationSettings, ToStation};
use crate::carrier::Carrier;
use crate::clock::SessionClock;
use crate::command_lists::CommandListStore;
use crate::contacts::{ContactStore, KnownContacts};
use crate::error::RelayError;
use crate::ids;
use crate::inbox::Input;
use crate::machine_lists::MACHINES_FOLDER;
use crate::meter::{LinkMeter, millis, shortened};
use crate::pairing::{Paired, Pairing};
use crate::request_words;
use crate::requests::RequestBroker;
use crate::start::Start;
use crate::value_fetch_broker::LinkRate;
use crate::watch_words;
use crate::words::{ReportedRunState, RunFate, StationRequest};
use rafcon_link::{
    CARRIER_OVERHEAD, CommandId, CommandState, EventHash, NewCommand, Profile, RangeSet, Rejected,
    StationSession, StreamId, Unusable,
};
use rafcon_protocol::api::{RobotAnswer, RobotRequest};
use rafcon_protocol::{CommandStage, LinkHealth, LinkReport, WatchTarget, Watching};
use rafcon_storage::journal::EventItems;
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

/// Reported while runs wait for others.
const CROWDED: &str = "more runs are incomplete than the station receives at a time (2,048): the others come once some are complete";

/// Capacity of the reasons of refused runs. Of more their number is reported.
const REFUSED_MAX: usize = 64;
/// Capacity of the hashes that were compared. Beyond it, all are forgotten, and compared again.
const CHECKED_MAX: usize = 4_096;
/// The end of a watch is sent this long: the robot may not know the run any more.
const WITHDRAW_FOR: Duration = Duration::from_mins(1);
/// The robot is asked for other values of a run at most this often.
const ASK_EVERY: Duration = Duration::from_secs(1);

pub(super) struct StationRobot {
    name: String,
    /// Name of this station at the robot.
    station: String,
    tell: fn(&str),
    session: StationSession,
    clock: SessionClock,
    meter: LinkMeter,
    /// Reason why the last datagram is not of this robot.
    rejected: Option<Rejected>,
    /// Transport of the newest datagram of the robot.
    carrier: Option<Carrier>,
    disk: Disk,
    /// Fault of the disk.
    problem: Option<String>,
    /// The runs that are open to viewers.
    runs: BTreeMap<StreamId, StationRun>,
    /// The streams of which nothing more is kept, and why.
    refused: BTreeMap<StreamId, String>,
    /// Number of further refused runs.
    refused_more: u64,
    /// Last compared hashes, with the times of the robot's reports.
    checked: BTreeMap<StreamId, (u64, u64)>,
    in_order: InOrder,
    early: Early,
    /// The pairing that is used and does not replace the one before yet.
    new: Option<Pairing>,
    /// This station's pairing with the robot.
    pairing: Pairing,
    /// Requests to the robot with an open fate.
    requests: PendingRequests,
    values: StationValues,
    server_requests: RequestBroker,
    contacts: ContactStore,
    lists: CommandListStore,
    /// Lists of watched values at the robot.
    watching: BTreeMap<StreamId, Asked>,
    /// Number of the last list.
    list_number: u64,
    profile: Profile,
}

impl StationRobot {
    pub(super) fn begin(
        settings: &StationSettings,
        number: usize,
        paired: &Paired,
        inbox: SyncSender<Input<ToStation>>,
        clock: SessionClock,
    ) -> Result<Self, RelayError> {
        let pairing = &paired.pairing;
        let folder = settings.folder.join(&pairing.robot);
        let start = Start::begin(&folder)?;
        let mut session = StationSession::new(&start.identity(pairing), settings.profile.clone());
        let new = paired.read_next().filter(|new| new.key_id != pairing.key_id);
        if let Some(Pairing { key_id, key, .. }) = &new {
            session.use_key(*key_id, key);
        }
        let values = StationValues::begin(settings, &pairing.robot, number, inbox.clone());
        let values = values.map_err(|source| RelayError::Thread { source })?;
        let (robot, runs) = (pairing.robot.clone(), settings.runs.clone());
        let machines = folder.join(MACHINES_FOLDER);
        let parcels = StationParcels::open(&machines)
            .map_err(|source| RelayError::Folder { path: machines, source })?;
        let mut kept = KeptRuns::new(
            Place {
                number,
                robot,
                runs,
                clock,
                inbox,
                paired: paired.clone(),
                machines: settings.machines.clone(),
            },
            start,
            parcels,
        );
        let (restored, parcels) = (kept.restore(), kept.restored_parcels());
        let whole = kept.whole();
        let disk = Disk::begin(kept).map_err(|source| RelayError::Thread { source })?;
        settings.server_requests.receive(&pairing.robot);
        settings.lists.receive(&pairing.robot, &folder);
        if let Some(problem) = settings.contacts.receive(&pairing.robot, &folder) {
            (settings.tell)(&format!("robot {}: {problem}", pairing.robot));
        }
        let mut robot = Self {
            values,
            server_requests: settings.server_requests.clone(),
            contacts: settings.contacts.clone(),
            lists: settings.lists.clone(),
            watching: BTreeMap::new(),
            list_number: clock::since_1970_ms(),
            profile: settings.profile.clone(),
            name: pairing.robot.clone(),
            station: pairing.station_name().to_owned(),
            tell: settings.tell,
            session,
            clock,
            meter: LinkMeter::new(pairing, &settings.profile, true),
            rejected: None,
            carrier: None,
            disk,
            problem: None,
            runs: BTreeMap::new(),
            refused: BTreeMap::new(),
            refused_more: 0,
            checked: BTreeMap::new(),
            in_order: InOrder::default(),
            early: Early::default(),
            new,
            pairing: pairing.clone(),
            requests: PendingRequests::default(),
        };
        robot.restore_whole(&whole);
        robot.restore(restored);
        robot.restore_parcels(parcels);
        Ok(robot)
    }

    /// Goes on with the replicas that are here.
    fn restore(&mut self, restored: Vec<Restored>) {
        for Restored { events, last, taken, state } in restored {
            let streams = [(events, last), (ids::about_beside(events), taken)];
            match state {
                RestoredState::Open(open) => {
                    for (stream, last) in streams {
                        self.session.restore(stream, RangeSet::up_to(last));
                        self.in_order.restore(stream, last);
                    }
                    self.opened(events, open);
                }
                RestoredState::Left => {
                    for (stream, last) in streams {
                        self.session.settle(stream, last);
                    }
                }
                RestoredState::Whole => {
                    let whole = streams.into_iter();
                    whole.for_each(|(it, last)| self.session.restore_whole(it, last));
                }
                RestoredState::Refused(why) => self.on_disk_event(FromDisk::Refused(events, why)),
            }
        }
    }

    /// Goes on with the runs that were whole once, by the streams of their events.
    fn restore_whole(&mut self, whole: &[(StreamId, u64, u64)]) {
        for (events, last, parts) in whole {
            self.session.restore_whole(*events, *last);
            self.session.restore_whole(ids::about_beside(*events), *parts);
        }
    }

    /// Goes on with the parcels that are here.
    fn restore_parcels(&mut self, restored: Vec<RestoredParcel>) {
        for RestoredParcel { stream, parts, is_whole } in restored {
            self.in_order.restore(stream, parts);
            if is_whole {
                self.session.restore_whole(stream, parts);
            } else {
                self.session.restore(stream, RangeSet::up_to(parts));
            }
        }
    }

    /// Applies an event of the disk's thread.
    pub(super) fn on_disk_event(&mut self, event: FromDisk) {
        match event {
            FromDisk::Opened(stream, open) => self.opened(stream, open),
            FromDisk::Safe(stream, safe) => {
                self.session.set_safe(stream, safe);
                if let Some(run) = self.runs.get_mut(&stream) {
                    run.safe = safe;
                }
            }
            FromDisk::Closed(stream) => self.closed(stream),
            FromDisk::Settled(SettledRun { stream, events, parts }) => {
                let about = ids::about_beside(stream);
                if let Some(events) = events {
                    self.session.settle(stream, events);
                    self.in_order.forget(stream);
                }
                self.session.settle(about, parts);
                self.in_order.forget(about);
            }
            FromDisk::Refused(stream, why) => {
                self.closed(stream);
                for stream in [stream, ids::about_beside(stream)] {
                    self.session.refuse(stream);
                    self.in_order.forget(stream);
                }
                let why = format!("robot {}: {why}", self.name);
                (self.tell)(&why);
                if self.refused.len() < REFUSED_MAX {
                    self.refused.insert(stream, why);
                } else {
                    self.refused_more += 1;
                }
            }
            FromDisk::ParcelsGone(streams) => {
                for stream in streams {
                    self.in_order.forget(stream);
                    self.session.forget(stream);
                }
            }
            FromDisk::KeyKept(new) => {
                self.session.use_key(new.key_id, &new.key);
                self.new = Some(new);
            }
            FromDisk::Problem(problem) => {
                if let Some(problem) = &problem {
                    let name = &self.name;
                    (self.tell)(&format!("what robot {name} sends is not safe: {problem}"));
                }
                self.problem = problem;
            }
        }
    }

    /// A run is not open to viewers any more.
    fn closed(&mut self, stream: StreamId) {
        self.runs.remove(&stream);
        drop(self.early.take(stream));
    }

    fn opened(&mut self, stream: StreamId, open: OpenRun) {
        let link = self.health(&self.contacts());
        open.shared.set_link(link);
        self.session.set_safe(stream, open.safe);
        let (reported, snapshot) = self.early.take(stream);
        if let Some(snapshot) = snapshot {
            open.shared.reported(snapshot);
        }
        self.runs.insert(stream, StationRun::new(open));
        if let Some(reported) = reported {
            self.reported(stream, reported);
        }
    }

    /// Sends due datagrams. Returns the time of the next one.
    pub(super) fn send(&mut self) -> Result<Duration, RelayError> {
        while let Some(datagram) = self.session.transmit(self.clock.now())? {
            if let Some(carrier) = &self.carrier {
                carrier.send(&datagram);
            }
        }
        Ok(self.session.next_transmit(self.clock.now()))
    }

    /// Applies a datagram. Returns false if it is of another robot.
    pub(super) fn receive(&mut self, from: &Carrier, datagram: &[u8]) -> bool {
        let (now, mut received) = (self.clock.now(), Vec::new());
        let before = self.session.horizon();
        let taken = self.session.receive(now, &mut datagram.to_vec(), |shown| {
            received.extend(Received::of(shown));
        });
        match taken {
            Ok(()) => {
                from.note_heard();
                // A delayed datagram of an old connection does not change it.
                if self.carrier.is_none() || self.session.horizon() != before {
                    self.carrier = Some(from.clone());
                }
            }
            Err(Unusable::Rejected(why)) => {
                self.rejected = Some(why);
                return false;
            }
            Err(Unusable::Broken(broken)) => {
                (self.tell)(&format!("robot {}: {broken}", self.name));
                self.meter.note_unusable(broken.to_string());
            }
        }
        for received in received {
            self.take(received);
        }
        true
    }

    /// No robot has made the datagram that was received last.
    pub(super) fn note_unusable(&mut self) {
        if let Some(why) = self.rejected.take() {
            self.meter.note_unusable(why.to_string());
        }
    }

    fn take(&mut self, received: Received) {
        match received {
            Received::Events(stream, items) => self.take_items(stream, items),
            Received::Stands(stream, reported, chain) => {
                if let Some((at_ms, chain)) = chain {
                    self.check(stream, at_ms, chain);
                }
                self.reported(stream, reported);
            }
            Received::Snapshot(stream, snapshot) => match self.runs.get(&stream) {
                Some(run) => run.shared.reported(*snapshot),
                None if self.is_awaited(stream) => self.early.snapshot(stream, *snapshot),
                None => {}
            },
            Received::NewKey(key_id, key) => {
                self.disk.keep_key(KeyWork::Next(Pairing { key_id, key, ..self.pairing.clone() }));
            }
            Received::State(id, state, reason) => self.answered(id, state, reason),
            Received::Watched(stream, values) => {
                if let Some(run) = self.runs.get(&stream) {
                    run.shared.watched(values);
                }
            }
            Received::Part(id, offset, bytes) => {
                self.values.take(id, offset, bytes, &mut self.session);
            }
            Received::NoValue(id, why) => self.values.refused(id, why, &mut self.session),
            Received::Started => {
                self.checked.clear();
                // A station that starts again has to know the newest start of its robot.
                self.save();
            }
        }
    }

    /// Events or parts: they are given to the disk in order.
    fn take_items(&mut self, stream: StreamId, items: EventItems) {
        if self.refused.contains_key(&run_of_stream(stream)) {
            return;
        }
        let safe = self.session.safe(stream);
        if let Some(lost) = self.in_order.add(stream, items, safe) {
            self.session.lose(stream, lost);
        }
        self.pass(stream);
    }

    fn pass(&mut self, stream: StreamId) {
        let (disk, is_part) = (&self.disk, stream.is_files() || ids::is_about(stream));
        self.in_order.pass(stream, |items| {
            let work = if is_part { Work::Part(items) } else { Work::Events(items) };
            disk.give(run_of_stream(stream), work).map_err(|work| match work {
                Work::Part(items) | Work::Events(items) => items,
                Work::Check(_) | Work::Close | Work::Leave { .. } => {
                    unreachable!("it was not given")
                }
            })
        });
    }

    /// Shows how the link is, and what became of words; has runs closed that are complete.
    pub(super) fn scan(&mut self) {
        self.note_overdue();
        if let Some(new) = self.new.take_if(|_| self.session.is_key_confirmed()) {
            self.disk.keep_key(KeyWork::Replace(new));
        }
        for stream in self.in_order.waiting() {
            self.pass(stream);
        }
        self.sync_subscriptions();
        self.send_server_requests();
        self.answer_list_questions();
        if let Some(round_trip) = self.session.round_trip() {
            self.requests.set_one_way(millis(round_trip) / 2);
        }
        let contacts = self.contacts();
        let (link, now_ms) = (self.health(&contacts), clock::since_1970_ms());
        let (session, requests) = (&self.session, &self.requests);
        for (stream, run) in &mut self.runs {
            let missing = run_of(session, *stream, &run.id).missing;
            let commands = requests.commands(Some(*stream), session, &contacts.plan, now_ms);
            run.shared.set_link(LinkHealth { missing, commands, ..link.clone() });
            let progress = session.progress(*stream);
            let head = progress.map_or(0, |progress| progress.head);
            // The last status may precede the opening of the run.
            run.is_over |= progress.is_some_and(|progress| progress.is_over);
            let is_complete = run.is_over && head > 0 && run.safe >= head;
            if is_complete && !run.is_closing && has_machines(session, *stream) {
                run.is_closing = self.disk.give(*stream, Work::Close).is_ok();
            }
        }
    }

    /// The planned contacts, as they are known.
    fn contacts(&self) -> KnownContacts {
        self.contacts.known(&self.name).unwrap_or_default()
    }

    /// Reads the planned contacts again if their file has changed.
    pub(super) fn refresh_contacts(&self) {
        if let Some(problem) = self.contacts.refresh(&self.name) {
            (self.tell)(&format!("robot {}: {problem}", self.name));
        }
    }

    fn health(&mut self, contacts: &KnownContacts) -> LinkHealth {
        health(&mut self.meter, &self.session, contacts, self.clock.now())
    }

    /// State of the link.
    pub(super) fn report(&mut self) -> LinkReport {
        let run = |(stream, run): (&StreamId, &StationRun)| run_of(&self.session, *stream, &run.id);
        let runs = self.runs.iter().map(run).collect();
        let (contacts, now_ms) = (self.contacts(), clock::since_1970_ms());
        let commands = self.requests.commands(None, &self.session, &contacts.plan, now_ms);
        let link = LinkHealth { commands, ..self.health(&contacts) };
        let (sent, received) = self.session.traffic();
        let report = self.meter.report(link, sent, received, runs);
        let problems = self.problem.iter().chain(self.refused.values());
        let problems = problems.map(|problem| format!("not everything is kept: {problem}"));
        let more = (self.refused_more > 0).then(|| {
            format!("not everything is kept: {} more runs are refused", self.refused_more)
        });
        let crowded = self.session.is_crowded(self.clock.now()).then(|| CROWDED.to_owned());
        let shortened = shortened(self.session.shortened_datagrams());
        let problems = problems.chain(more).chain(crowded).chain(shortened).collect();
        LinkReport { problems, ..report }
    }

    /// Stores the state of the link for the next start.
    pub(super) fn save(&mut self) {
        self.disk.keep_heard(self.session.key_id(), self.session.horizon());
    }

    /// Writes what waits for the disk, as far as it takes it.
    pub(super) fn end(&mut self) {
        self.save();
        self.disk.end();
    }

    /// The robot's events have this hash: the disk compares it with that of the replica.
    fn check(&mut self, stream: StreamId, at_ms: u64, chain: EventHash) {
        let before = self.checked.get(&stream);
        let is_news = before.is_none_or(|(then_ms, last)| at_ms > *then_ms && chain.last != *last);
        if is_news
            && !self.refused.contains_key(&stream)
            && self.disk.give(stream, Work::Check(chain)).is_ok()
        {
            if self.checked.len() >= CHECKED_MAX {
                self.checked.clear();
            }
            self.checked.insert(stream, (at_ms, chain.last));
        }
    }

    /// Applies the reported state of a run.
    fn reported(&mut self, stream: StreamId, reported: ReportedRunState) {
        let head = self.session.progress(stream).map_or(0, |progress| progress.head);
        let is_waiting = !self.in_order.is_empty(stream);
        let is_awaited = self.is_awaited(stream);
        let Some(run) = self.runs.get_mut(&stream) else {
            if is_awaited {
                self.early.reported(stream, reported);
            }
            return;
        };
        run.is_over |= matches!(reported.fate, RunFate::Finished | RunFate::Removed);
        if let Some(control) = reported.control(&self.station, clock::since_1970_ms()) {
            run.epoch = control.epoch;
            run.shared.set_control(control);
        }
        let is_here = run.safe >= head && !is_waiting && has_machines(&self.session, stream);
        let has_ended = reported.fate == RunFate::Crashed && is_here
            || reported.fate == RunFate::Removed && !is_waiting;
        if has_ended && !run.is_closing {
            // Closed as its runner left it, the run is shown as what it is: crashed.
            let is_final = reported.fate == RunFate::Removed;
            run.is_closing = self.disk.give(stream, Work::Leave { is_final }).is_ok();
        }
    }

    /// True if a run is to be opened. Only events open a settled one again.
    fn is_awaited(&self, stream: StreamId) -> bool {
        let is_open = self.session.progress(stream).is_some_and(|progress| !progress.is_settled);
        is_open && !stream.is_files() && !ids::is_about(stream)
    }

    /// Applies an event of the disk's thread for large values.
    pub(super) fn on_value_disk_event(&mut self, event: FromValueDisk) {
        self.values.on_disk_event(event, &mut self.session);
    }

    /// Asks the robot for what is watched of a run, as far as it fits.
    fn watch(&mut self, stream: StreamId, mut targets: Vec<WatchTarget>) {
        self.list_number = clock::since_1970_ms().max(self.list_number + 1);
        let wanted = targets.len();
        while self
            .session
            .watch(stream, self.list_number, watch_words::write_targets(&targets))
            .is_err()
        {
            targets.truncate(targets.len() / 2);
        }
        let left_out = u32::try_from(wanted - targets.len()).unwrap_or(u32::MAX);
        let asked_ms = clock::since_1970_ms();
        let watching = Watching { is_confirmed: false, asked_ms, left_out };
        let asked = Asked { at: self.clock.now(), is_any: !targets.is_empty(), watching };
        self.watching.insert(stream, asked);
    }

    /// Asks the robot for what viewers watch now; not again at once, however often they change it.
    fn ask(&mut self) {
        let now = self.clock.now();
        let is_due = |asked: Option<&Asked>| asked.is_none_or(|it| it.at + ASK_EVERY <= now);
        let open = self.runs.iter().filter(|(stream, _)| is_due(self.watching.get(stream)));
        let open: Vec<_> = open.map(|(stream, run)| (*stream, Arc::clone(&run.shared))).collect();
        // Nobody watches a run that is closed.
        let left = self
            .watching
            .iter()
            .filter(|(stream, asked)| asked.is_any && !self.runs.contains_key(stream));
        let left: Vec<_> = left.map(|(stream, _)| *stream).collect();
        for stream in left {
            self.watch(stream, Vec::new());
        }
        for (stream, shared) in open {
            if !is_room(&self.watching, stream) {
                shared.leave_out();
            } else if let Some(targets) = shared.take_subscription() {
                self.watch(stream, targets);
            }
        }
    }

    /// Says whether the robot knows what is watched, and how far large values are.
    fn sync_subscriptions(&mut self) {
        self.ask();
        for (stream, Asked { watching, .. }) in &mut self.watching {
            watching.is_confirmed = self.session.is_watch_confirmed(*stream).unwrap_or(false);
            if let Some(run) = self.runs.get(stream) {
                run.shared.set_watching(watching);
            }
        }
        self.forget_watches();
        let now = self.clock.now();
        self.values.handle_requests(&mut self.session);
        let link = self.health(&self.contacts());
        let used = link.down_bytes_per_s.saturating_sub(self.values.bytes_per_s(now));
        let (most, part) = (self.profile.down_bits_per_s / 8, self.profile.value_part_bytes());
        // However busy the link is, a little is left in the end.
        let spare = most.saturating_sub(used).max(most / 20);
        let overhead = self.profile.down_bytes_max as u64 - part + CARRIER_OVERHEAD as u64;
        let spare_per_s = link.is_heard.then_some(spare);
        self.values.sync(&self.session, LinkRate { part, overhead, spare_per_s });
    }

    /// Drops the watches of closed runs once the robot knows that.
    fn forget_watches(&mut self) {
        let (now, runs, session) = (self.clock.now(), &self.runs, &mut self.session);
        self.watching.retain(|stream, asked| {
            let is_withdrawn = asked.watching.is_confirmed || asked.at + WITHDRAW_FOR <= now;
            let is_over = !runs.contains_key(stream) && !asked.is_any && is_withdrawn;
            if is_over {
                session.end_watch(*stream);
            }
            !is_over
        });
    }

    /// Sends what a viewer has for the robot. What is on its way already is not sent twice, and what was answered is answered again.
    pub(super) fn command(&mut self, stream: StreamId, given: &PendingRequest) {
        let id = ids::command(&given.id);
        if let Some(answer) = self.requests.known_answer(id) {
            return self.answer(stream, &given.id, &answer);
        }
        if self.requests.is_open(id) {
            return;
        }
        let prepared = self.prepare(stream, given).and_then(|(command, times)| {
            let sent = self.session.command(self.clock.now(), command);
            sent.map(|()| times).map_err(|why| why.to_string())
        });
        match prepared {
            Ok(times) => self.requests.add(stream, given, times),
            Err(reason) => self.answer(stream, &given.id, &RobotAnswer::Refused { reason }),
        }
    }

    /// A request as the session sends it, with its times. The error is the reason for a refusal.
    fn prepare(
        &self,
        stream: StreamId,
        given: &PendingRequest,
    ) -> Result<(NewCommand, SendTimes), String> {
        let (now, today) = (self.clock.now(), clock::since_1970_ms());
        let known = self.runs.get(&stream).map_or(0, |run| run.epoch);
        let wait = given.not_before.map(|ms| Duration::from_millis(ms.saturating_sub(today)));
        let body = request_words::write(stream, &given.word);
        let transfer = self.session.transfer_time(body.len());
        let usual = default_lifetime(&self.session, now, body.len());
        let valid = lifetime(given, &self.contacts().plan, today, usual)?;
        let times = SendTimes {
            sent: today,
            transfer: millis(transfer),
            one_way: self.session.round_trip().map(|round_trip| millis(round_trip) / 2),
            expiry: (!given.is_lasting).then(|| today + millis(valid)),
        };
        let (id, epoch) = (ids::command(&given.id), given.epoch.unwrap_or(known));
        Ok((NewCommand { id, valid, wait, epoch, body }, times))
    }

    /// Sends what the server asks for: these runs have no viewers here.
    fn send_server_requests(&mut self) {
        for request in self.server_requests.take(&self.name) {
            let (stream, id, word) = match request {
                RobotRequest::Resume(it) => {
                    let (stream, id) = (ids::events_of(&it.run), it.asked.id.clone());
                    let (policy, from) = (it.asked.policy, it.asked.from);
                    (stream, id, StationRequest::Resume(it.asked.id, it.user, it.run, policy, from))
                }
                RobotRequest::Start(it) => {
                    // No run has an empty id.
                    let (stream, id) = (ids::events_of(""), it.id.clone());
                    (stream, id, StationRequest::Start(it.id, it.user, it.of))
                }
            };
            self.command(stream, &PendingRequest::soon(id, word));
        }
    }

    fn answered(&mut self, id: CommandId, state: CommandState, reason: String) {
        match state {
            CommandState::Received => self.requests.set_stage(id, CommandStage::Received),
            CommandState::Started => self.requests.set_stage(id, CommandStage::Started),
            CommandState::Done => self.close_word(id, &RobotAnswer::Done { run: reason }),
            CommandState::Refused => self.close_word(id, &RobotAnswer::Refused { reason }),
            CommandState::Expired => self.close_word(id, &RobotAnswer::Expired),
        }
    }

    fn close_word(&mut self, id: CommandId, answer: &RobotAnswer) {
        if let Some((stream, name)) = self.requests.close(id, answer) {
            self.answer(stream, &name, answer);
        }
    }

    /// Says of commands whose time is over that their fate is unknown.
    fn note_overdue(&mut self) {
        for id in self.session.take_overdue(self.clock.now()) {
            if self.requests.is_beginning_run(id) {
                continue;
            }
            self.requests.set_stage(id, CommandStage::Overdue);
            if let Some((stream, name)) = self.requests.find(id) {
                self.answer(stream, name, &overdue());
            }
        }
    }

    fn answer(&self, stream: StreamId, name: &str, answer: &RobotAnswer) {
        if let Some(run) = self.runs.get(&stream) {
            run.shared.answer(name, &answer.to_command());
        }
        self.server_requests.answer(&self.name, name, answer);
    }
}

/// Default lifetime of a request of `length` bytes.
pub(crate) fn default_lifetime(session: &StationSession, now: Duration, length: usize) -> Duration {
    // Twice: parts are lost and sent again.
    session.command_lifetime(now) + session.transfer_time(length) * 2
}

/// The stream with the events of the run that a stream is of; that of a parcel is of no run.
fn run_of_stream(stream: StreamId) -> StreamId {
    if stream.is_files() { stream } else { ids::events_beside(stream) }
}

/// True if the whole description of a run has arrived.
fn has_machines(session: &StationSession, events: StreamId) -> bool {
    let about = session.progress(ids::about_beside(events));
    about.is_some_and(|about| about.contiguous >= about.head)
}

#[cfg(test)]
mod tests;
