//! One robot as a station knows it: its session, and the replicas of its runs.

use super::health::{self, Health};
use super::replica_run::ReplicaRun;
use super::{GivenCommand, StationSettings};
use crate::about::{AboutReader, AboutRecord, Taken};
use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::ids;
use crate::inbox::Input;
use crate::pairing::Pairing;
use crate::start::Start;
use rafcon_link::{
    CommandState, FromRobot, NewCommand, RangeSet, Rejected, StationSession, StreamId, Unusable,
};
use rafcon_protocol::{Answer, Envelope, LinkHealth, LinkReport};
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
    health: Health,
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
    /// The run and the envelope of commands whose fate is open.
    given: BTreeMap<rafcon_link::CommandId, (StreamId, String)>,
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
    Over(StreamId),
    Snapshot(StreamId, Vec<u8>),
    State(rafcon_link::CommandId, CommandState),
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
            health: Health::new(&pairing.robot, &settings.profile),
            rejected: None,
            address: None,
            inbox,
            replicas: BTreeMap::new(),
            abouts: BTreeMap::new(),
            early: BTreeMap::new(),
            told: String::new(),
            given: BTreeMap::new(),
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
            FromRobot::Status { stream, is_over: true, .. } => {
                received.push(Received::Over(stream));
            }
            FromRobot::Snapshot { stream, bytes, .. } => {
                received.push(Received::Snapshot(stream, bytes));
            }
            FromRobot::CommandState { id, state } => received.push(Received::State(id, state)),
            FromRobot::Started | FromRobot::Status { .. } => {}
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
            Received::Over(stream) => {
                if let Some(replica) = self.replicas.get_mut(&stream) {
                    replica.set_over();
                }
            }
            Received::Snapshot(stream, bytes) => {
                if let (Some(replica), Ok(snapshot)) =
                    (self.replicas.get_mut(&stream), serde_json::from_slice(&bytes))
                {
                    replica.stands(snapshot);
                }
            }
            Received::State(id, state) => self.answered(id, state),
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
        let link = self.health.of(&self.session, self.clock.now());
        let (session, name) = (&mut self.session, &self.name);
        let mut problem = String::new();
        self.replicas.retain(|stream, replica| {
            let missing = health::run(session, replica.id()).missing;
            replica.set_link(LinkHealth { missing, ..link.clone() });
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
        self.health.report(&self.session, self.clock.now(), runs)
    }

    /// Keeps what was heard, for the next start.
    pub(super) fn keep(&mut self) -> Result<(), RelayError> {
        self.start.keep_heard(self.session.horizon())
    }

    /// Sends a command of a viewer.
    pub(super) fn command(&mut self, run: &str, envelope: Envelope) {
        let stream = ids::events_of(run);
        let (id, name) = (ids::command(&envelope.id), envelope.id.clone());
        let left = envelope.expiry.map_or(LIFETIME, |expiry| {
            Duration::from_millis(expiry.0.saturating_sub(clock::since_1970_ms()))
        });
        let envelope = Envelope { expiry: None, ..envelope };
        let body = serde_json::to_vec(&(run, envelope)).unwrap_or_default();
        let command = NewCommand { id, valid: left, epoch: 0, body };
        match self.session.command(self.clock.now(), command) {
            Ok(()) => {
                self.given.insert(id, (stream, name));
            }
            Err(error) => {
                if let Some(replica) = self.replicas.get(&stream) {
                    replica.answer(&name, &Answer::Refused { reason: error.to_string() });
                }
            }
        }
    }

    fn answered(&mut self, id: rafcon_link::CommandId, state: CommandState) {
        let answer = match state {
            CommandState::Done => Answer::Applied,
            CommandState::Refused => Answer::Refused {
                reason: "the robot refused it; the run's history says why".to_owned(),
            },
            CommandState::Expired => Answer::Expired,
            CommandState::Received | CommandState::Started => return,
        };
        if let Some((stream, envelope)) = self.given.remove(&id)
            && let Some(replica) = self.replicas.get(&stream)
        {
            replica.answer(&envelope, &answer);
        }
    }
}
