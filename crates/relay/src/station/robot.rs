//! One robot as a station knows it: its session, and the replicas of its runs.

use super::health::{health, run};
use super::open_words::OpenWords;
use super::replica_run::ReplicaRun;
use super::viewers::GivenWord;
use super::{GivenCommand, StationSettings};
use crate::about::{AboutReader, AboutRecord, Taken};
use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::ids;
use crate::inbox::Input;
use crate::meter::{LinkMeter, millis};
use crate::pairing::Pairing;
use crate::start::Start;
use crate::words::{RunFate, RunStands};
use rafcon_link::{
    CommandId, CommandState, FromRobot, NewCommand, RangeSet, Rejected, StationSession, StreamId,
    Unusable,
};
use rafcon_protocol::{Answer, CommandStage, Expiry, LinkHealth, LinkReport};
use rafcon_storage::journal::{About, EventItems, JournalError, RunState, Summary, run_folders};
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::net::{SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

/// A command without an expiry, such as a stop, is sent for so long.
const LIFETIME: Duration = Duration::from_hours(1);

pub(super) struct StationRobot {
    number: usize,
    name: String,
    runs: PathBuf,
    tell: fn(&str),
    start: Start,
    session: StationSession,
    clock: SessionClock,
    meter: LinkMeter,
    /// Why the last datagram is not of this robot.
    rejected: Option<Rejected>,
    address: Option<SocketAddr>,
    inbox: SyncSender<Input<GivenCommand>>,
    replicas: BTreeMap<StreamId, ReplicaRun>,
    abouts: BTreeMap<StreamId, IncomingAbout>,
    /// Events of runs of which nothing else is known yet.
    early: BTreeMap<StreamId, Vec<EventItems>>,
    /// What went wrong last, so that it is said once.
    told: String,
    /// What was given for the robot and whose fate is open.
    words: OpenWords,
    /// Runs whose runner died on the robot: closed here until the robot says that they go on.
    crashed: BTreeMap<StreamId, About>,
}

/// What is to be known about a run, on its way.
#[derive(Default)]
struct IncomingAbout {
    /// Up to which part everything was taken.
    taken: u64,
    ahead: BTreeMap<u64, Vec<u8>>,
    reader: AboutReader,
}

/// What a datagram had, so that nothing is done while the session is borrowed.
enum Received {
    Events(StreamId, EventItems),
    Stands(StreamId, RunStands, bool),
    Snapshot(StreamId, Vec<u8>),
    State(CommandId, CommandState, String),
    Started,
}

impl StationRobot {
    pub(super) fn begin(
        settings: &StationSettings,
        number: usize,
        pairing: &Pairing,
        inbox: SyncSender<Input<GivenCommand>>,
        clock: SessionClock,
    ) -> Result<Self, RelayError> {
        let start = Start::begin(&settings.folder.join(&pairing.robot))?;
        let session = StationSession::new(&start.identity(pairing), settings.profile.clone());
        let mut robot = Self {
            number,
            name: pairing.robot.clone(),
            runs: settings.runs.clone(),
            tell: settings.tell,
            start,
            session,
            clock,
            meter: LinkMeter::new(&pairing.robot, &settings.profile, true),
            rejected: None,
            address: None,
            inbox,
            replicas: BTreeMap::new(),
            abouts: BTreeMap::new(),
            early: BTreeMap::new(),
            told: String::new(),
            words: OpenWords::default(),
            crashed: BTreeMap::new(),
        };
        robot.restore();
        Ok(robot)
    }

    /// Goes on with the replicas that are here and not complete.
    fn restore(&mut self) {
        for folder in run_folders(&self.runs).unwrap_or_default() {
            let Ok(about) = About::read(&folder) else { continue };
            if about.robot.as_ref() != Some(&self.name) {
                continue;
            }
            let (stream, beside) = (ids::events_of(&about.id), ids::about_of(&about.id));
            let taken = ReplicaRun::read_taken(&folder);
            self.session.restore(beside, RangeSet::up_to(taken));
            self.abouts.insert(beside, IncomingAbout { taken, ..IncomingAbout::default() });
            let summary = Summary::of(&folder);
            if matches!(summary.state, RunState::Finished { .. }) {
                self.session.restore(stream, RangeSet::up_to(summary.events));
                continue;
            }
            self.open(stream, about);
            if let Some(replica) = self.replicas.get(&stream) {
                self.session.restore(stream, RangeSet::up_to(replica.next() - 1));
            }
        }
    }

    fn open(&mut self, stream: StreamId, about: About) {
        let about = About { robot: Some(self.name.clone()), on_crash: None, ..about };
        let given = (self.number, self.inbox.clone());
        let link = health(&mut self.meter, &self.session, self.clock.now());
        match ReplicaRun::open(&self.runs, &about, link, given) {
            Ok(replica) => {
                self.replicas.insert(stream, replica);
                for items in self.early.remove(&stream).unwrap_or_default() {
                    self.take_events(stream, items);
                }
            }
            Err(error) => {
                let (id, name) = (&about.id, &self.name);
                (self.tell)(&format!("run {id} of robot {name} is not kept: {error}"));
            }
        }
    }

    /// Sends what is due; answers when something will be.
    pub(super) fn send(&mut self, socket: &UdpSocket) -> Result<Duration, RelayError> {
        while let Some(datagram) = self.session.transmit(self.clock.now())? {
            if let Some(address) = self.address {
                // A network that is not there is a link that loses everything.
                drop(socket.send_to(&datagram, address));
            }
        }
        Ok(self.session.next_transmit(self.clock.now()))
    }

    /// Takes a datagram; answers whether it is of this robot.
    pub(super) fn receive(&mut self, from: SocketAddr, datagram: &[u8]) -> bool {
        let (now, mut received) = (self.clock.now(), Vec::new());
        let taken = self.session.receive(now, &mut datagram.to_vec(), |shown| match shown {
            FromRobot::Events(events) => {
                let (first, count, t_before) = (events.first, events.count, events.t_before);
                let bytes = events.items.to_vec();
                let items = EventItems { first, count, t_before, bytes };
                received.push(Received::Events(events.stream, items));
            }
            FromRobot::Status { stream, is_over, state, .. } => {
                let stands = serde_json::from_slice(state).unwrap_or_default();
                received.push(Received::Stands(stream, stands, is_over));
            }
            FromRobot::Snapshot { stream, bytes, .. } => {
                received.push(Received::Snapshot(stream, bytes));
            }
            FromRobot::CommandState { id, state, reason } => {
                let reason = String::from_utf8_lossy(reason).into_owned();
                received.push(Received::State(id, state, reason));
            }
            FromRobot::Started => received.push(Received::Started),
        });
        match taken {
            Ok(()) => self.address = Some(from),
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
            Received::Events(stream, items) if ids::is_about(stream) => {
                self.take_about(stream, items);
            }
            Received::Events(stream, items) => self.take_events(stream, items),
            Received::Stands(stream, stands, is_over) => self.stands(stream, &stands, is_over),
            Received::Snapshot(stream, bytes) => {
                if let (Some(replica), Ok(snapshot)) =
                    (self.replicas.get_mut(&stream), serde_json::from_slice(&bytes))
                {
                    replica.stands(snapshot);
                }
            }
            Received::State(id, state, reason) => self.answered(id, state, reason),
            Received::Started => self.lose_words(),
        }
    }

    /// Parts of what is to be known about a run: they are put together in order.
    fn take_about(&mut self, stream: StreamId, items: EventItems) {
        let incoming = self.abouts.entry(stream).or_default();
        incoming.ahead.insert(items.first, items.bytes);
        while let Some(incoming) = self.abouts.get_mut(&stream)
            && let Some(part) = incoming.ahead.remove(&(incoming.taken + 1))
        {
            incoming.taken += 1;
            let taken = incoming.taken;
            let kept = match incoming.reader.take(&part) {
                Taken::Part => continue,
                Taken::Record(Some(record)) => self.take_record(stream, record),
                Taken::Record(None) => Ok(()),
            };
            if let Err(error) = kept {
                (self.tell)(&format!("a machine of robot {} is not kept: {error}", self.name));
            } else if let Some(replica) = self.replicas.get(&ids::events_beside(stream)) {
                replica.keep_taken(taken);
            }
        }
    }

    fn take_record(&mut self, stream: StreamId, record: AboutRecord) -> Result<(), JournalError> {
        let events = ids::events_beside(stream);
        match record {
            AboutRecord::About(about) => {
                let is_plain = !about.id.contains(['/', '\0']) && !about.id.starts_with('.');
                let is_known = self.replicas.contains_key(&events);
                if ids::about_of(&about.id) == stream && is_plain && !is_known {
                    self.open(events, *about);
                }
                Ok(())
            }
            AboutRecord::Machine(pack) => {
                self.replicas.get(&events).map_or(Ok(()), |replica| replica.keep_machine(&pack))
            }
        }
    }

    fn take_events(&mut self, stream: StreamId, items: EventItems) {
        let Some(replica) = self.replicas.get_mut(&stream) else {
            return self.early.entry(stream).or_default().push(items);
        };
        replica.take(items);
    }

    /// Makes what arrived safe, shows it, and forgets what is complete.
    pub(super) fn sync(&mut self) {
        self.expire_words();
        let link = health(&mut self.meter, &self.session, self.clock.now());
        let (session, name, words) = (&mut self.session, &self.name, &self.words);
        let mut problem = String::new();
        self.replicas.retain(|stream, replica| {
            let missing = run(session, replica.id()).missing;
            let commands = words.commands(Some(*stream));
            replica.set_link(LinkHealth { missing, commands, ..link.clone() });
            match replica.sync() {
                Ok(safe) => session.set_safe(*stream, safe),
                Err(error) => {
                    problem = format!("run {} of robot {name} is not safe: {error}", replica.id());
                }
            }
            let head = session.progress(*stream).map_or(0, |(head, _)| head);
            !(has_machines(session, replica) && replica.close_if_complete(head))
        });
        if !problem.is_empty() && problem != self.told {
            (self.tell)(&problem);
        }
        self.told = problem;
    }

    /// How the link is.
    pub(super) fn report(&mut self) -> LinkReport {
        let runs = self.replicas.values().map(|replica| run(&self.session, replica.id())).collect();
        let link = health(&mut self.meter, &self.session, self.clock.now());
        let link = LinkHealth { commands: self.words.commands(None), ..link };
        self.meter.report(link, self.session.traffic(), runs)
    }

    /// Keeps what was heard, for the next start.
    pub(super) fn keep(&mut self) -> Result<(), RelayError> {
        self.start.keep_heard(self.session.horizon())
    }

    /// A run stands like this on the robot.
    fn stands(&mut self, stream: StreamId, stands: &RunStands, is_over: bool) {
        if stands.fate == RunFate::Live
            && let Some(about) = self.crashed.remove(&stream)
        {
            self.open(stream, about);
        }
        let Some(replica) = self.replicas.get_mut(&stream) else { return };
        if is_over {
            replica.set_over();
        }
        if let Some(control) = stands.control(clock::since_1970_ms()) {
            replica.set_control(control);
        }
        let head = self.session.progress(stream).map_or(0, |(head, _)| head);
        let is_here = replica.is_at(head) && has_machines(&self.session, replica);
        if stands.fate == RunFate::Crashed && is_here {
            // Closed as its runner left it, the run is shown as what it is: crashed.
            if let Ok(about) = About::read(&self.runs.join(replica.id())) {
                self.crashed.insert(stream, about);
                self.replicas.remove(&stream);
            }
        }
    }

    /// Sends what a viewer has for the robot.
    pub(super) fn command(&mut self, run: &str, given: &GivenWord) {
        let (stream, today) = (ids::events_of(run), clock::since_1970_ms());
        let left = |expiry: Expiry| Duration::from_millis(expiry.0.saturating_sub(today));
        let command = NewCommand {
            id: ids::command(&given.id),
            valid: given.expiry.map_or(LIFETIME, left),
            epoch: 0,
            body: serde_json::to_vec(&(stream.0, &given.word)).unwrap_or_default(),
        };
        if let Err(error) = self.session.command(self.clock.now(), command) {
            return self.answer(stream, &given.id, &Answer::Refused { reason: error.to_string() });
        }
        let there_ms = self.session.round_trip().map(|round_trip| millis(round_trip) / 2);
        self.words.add(stream, given, (today, there_ms));
    }

    fn answered(&mut self, id: CommandId, state: CommandState, reason: String) {
        match state {
            CommandState::Received => self.words.set_stage(id, CommandStage::Received),
            CommandState::Started => self.words.set_stage(id, CommandStage::Started),
            CommandState::Done => self.close_word(id, &Answer::Applied),
            CommandState::Refused => self.close_word(id, &Answer::Refused { reason }),
            CommandState::Expired => self.close_word(id, &Answer::Expired),
        }
    }

    fn close_word(&mut self, id: CommandId, answer: &Answer) {
        if let Some((stream, name)) = self.words.close(id) {
            self.answer(stream, &name, answer);
        }
    }

    /// The robot's server has started again: it knows nothing of what was on its way to the one before.
    fn lose_words(&mut self) {
        let reason = "the robot's server has started again: whether it still took the command is in the run's history";
        let answer = Answer::Refused { reason: reason.to_owned() };
        for id in self.words.ids() {
            self.close_word(id, &answer);
        }
    }

    /// Says of what the robot never had that it is too late.
    fn expire_words(&mut self) {
        for id in self.words.ids() {
            if !self.session.is_open(id) {
                self.close_word(id, &Answer::Expired);
            }
        }
    }

    fn answer(&self, stream: StreamId, name: &str, answer: &Answer) {
        if let Some(replica) = self.replicas.get(&stream) {
            replica.answer(name, answer);
        }
    }
}

/// Whether all that the robot has said about a run besides its events is here.
fn has_machines(session: &StationSession, replica: &ReplicaRun) -> bool {
    let about = session.progress(ids::about_of(replica.id()));
    about.is_some_and(|(head, parts)| parts.contiguous() >= head)
}
