//! One robot as a station knows it: its session, and the replicas of its runs.

use super::health::{self, StationHealth};
use super::replica_run::ReplicaRun;
use super::viewers::GivenWord;
use super::{GivenCommand, StationSettings};
use crate::about::{AboutReader, AboutRecord, Taken};
use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::ids;
use crate::inbox::Input;
use crate::pairing::Pairing;
use crate::start::Start;
use crate::words::{RunFate, RunStands, StationWord};
use rafcon_link::{
    CommandState, FromRobot, NewCommand, RangeSet, Rejected, StationSession, StreamId, Unusable,
};
use rafcon_protocol::{Answer, CommandStage, LinkHealth, LinkReport, OpenCommand};
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
    health: StationHealth,
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
    /// The commands whose fate is open.
    given: BTreeMap<rafcon_link::CommandId, GivenToRobot>,
    /// Wishes about control and signs of life, likewise: the run and the id of each.
    moves: BTreeMap<rafcon_link::CommandId, (StreamId, String)>,
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

/// A command whose fate is open.
struct GivenToRobot {
    stream: StreamId,
    command: OpenCommand,
}

/// What a datagram had, so that nothing is done while the session is borrowed.
enum Received {
    Events(StreamId, EventItems),
    Stands(StreamId, RunStands, bool),
    Snapshot(StreamId, Vec<u8>),
    State(rafcon_link::CommandId, CommandState, String),
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
            health: StationHealth::new(&pairing.robot, &settings.profile),
            rejected: None,
            address: None,
            inbox,
            replicas: BTreeMap::new(),
            abouts: BTreeMap::new(),
            early: BTreeMap::new(),
            told: String::new(),
            given: BTreeMap::new(),
            moves: BTreeMap::new(),
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
        let link = self.health.of(&self.session, self.clock.now());
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
                self.health.note_unusable(broken.to_string());
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
            self.health.note_unusable(why.to_string());
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
            Received::Started => self.lose_commands(),
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
        self.expire_commands();
        let link = self.health.of(&self.session, self.clock.now());
        let (session, name, given) = (&mut self.session, &self.name, &self.given);
        let mut problem = String::new();
        self.replicas.retain(|stream, replica| {
            let missing = health::run(session, replica.id()).missing;
            let commands = given.values().filter(|given| given.stream == *stream);
            let commands = commands.map(|given| given.command.clone()).collect();
            replica.set_link(LinkHealth { missing, commands, ..link.clone() });
            match replica.sync() {
                Ok(safe) => session.set_safe(*stream, safe),
                Err(error) => {
                    problem = format!("run {} of robot {name} is not safe: {error}", replica.id());
                }
            }
            let head = session.progress(*stream).map_or(0, |(head, _)| head);
            let about = session.progress(ids::about_of(replica.id()));
            let is_known = about.is_some_and(|(head, parts)| parts.contiguous() >= head);
            !(is_known && replica.close_if_complete(head))
        });
        if !problem.is_empty() && problem != self.told {
            (self.tell)(&problem);
        }
        self.told = problem;
    }

    /// How the link is.
    pub(super) fn report(&mut self) -> LinkReport {
        let runs = self.replicas.values().map(ReplicaRun::id);
        let mut report = self.health.report(&self.session, self.clock.now(), runs);
        report.health.commands = self.given.values().map(|given| given.command.clone()).collect();
        report
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
        if stands.fate == RunFate::Crashed && replica.is_at(head) {
            // Closed as its runner left it, the run is shown as what it is: crashed.
            if let Ok(about) = About::read(&self.runs.join(replica.id())) {
                self.crashed.insert(stream, about);
                self.replicas.remove(&stream);
            }
        }
    }

    /// Sends what a viewer has for the robot.
    pub(super) fn command(&mut self, run: &str, given: GivenWord) {
        let GivenWord { id: name, expiry, word } = given;
        let (stream, id, today) =
            (ids::events_of(run), ids::command(&name), clock::since_1970_ms());
        let left =
            expiry.map_or(LIFETIME, |expiry| Duration::from_millis(expiry.0.saturating_sub(today)));
        let is_shown = matches!(word, StationWord::Command(..));
        let body = serde_json::to_vec(&(stream.0, word)).unwrap_or_default();
        let command = NewCommand { id, valid: left, epoch: 0, body };
        if let Err(error) = self.session.command(self.clock.now(), command) {
            return self.answer(stream, &name, &Answer::Refused { reason: error.to_string() });
        }
        let there = self.session.round_trip().map(|round_trip| health::millis(round_trip) / 2);
        let command = OpenCommand {
            id: name,
            stage: CommandStage::Sent,
            sent_ms: today,
            arrives_ms: there.map(|there| today + there),
        };
        if is_shown {
            self.given.entry(id).or_insert(GivenToRobot { stream, command });
        } else {
            self.moves.insert(id, (stream, command.id));
        }
    }

    fn answered(&mut self, id: rafcon_link::CommandId, state: CommandState, reason: String) {
        let stage = match state {
            CommandState::Done => return self.close_command(id, &Answer::Applied),
            CommandState::Refused => {
                return self.close_command(id, &Answer::Refused { reason });
            }
            CommandState::Expired => return self.close_command(id, &Answer::Expired),
            CommandState::Received => CommandStage::Received,
            CommandState::Started => CommandStage::Started,
        };
        if let Some(given) = self.given.get_mut(&id) {
            given.command.stage = stage;
        }
    }

    fn close_command(&mut self, id: rafcon_link::CommandId, answer: &Answer) {
        let given = self.given.remove(&id).map(|given| (given.stream, given.command.id));
        if let Some((stream, name)) = given.or_else(|| self.moves.remove(&id)) {
            self.answer(stream, &name, answer);
        }
    }

    /// The robot's server has started again: it knows nothing of commands that were on their way to the one before.
    fn lose_commands(&mut self) {
        let given = std::mem::take(&mut self.given).into_values();
        let given = given.map(|given| (given.stream, given.command.id));
        for (stream, name) in given.chain(std::mem::take(&mut self.moves).into_values()) {
            let reason = "the robot's server has started again: whether it still took the command is in the run's history";
            self.answer(stream, &name, &Answer::Refused { reason: reason.to_owned() });
        }
    }

    /// Says of commands that the robot never had that they are too late to be carried out.
    fn expire_commands(&mut self) {
        let given = self.given.keys().chain(self.moves.keys()).copied();
        let late: Vec<_> = given.filter(|id| !self.session.is_open(*id)).collect();
        for id in late {
            self.close_command(id, &Answer::Expired);
        }
    }

    fn answer(&self, stream: StreamId, name: &str, answer: &Answer) {
        if let Some(replica) = self.replicas.get(&stream) {
            replica.answer(name, answer);
        }
    }
}
