//! One robot as a station knows it: its session, and the replicas of its runs.

use super::replica_run::ReplicaRun;
use super::{GivenCommand, StationSettings};
use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::ids;
use crate::inbox::Input;
use crate::pairing::Pairing;
use crate::start::Start;
use rafcon_link::{
    CommandState, FromRobot, NewCommand, RangeSet, StationSession, StreamId, Unusable,
};
use rafcon_protocol::{Answer, Envelope};
use rafcon_storage::journal::{About, EventItems, run_folders};
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
    silence: Duration,
    address: Option<SocketAddr>,
    inbox: SyncSender<Input<GivenCommand>>,
    replicas: BTreeMap<StreamId, ReplicaRun>,
    /// Events of runs of which nothing else is known yet.
    early: BTreeMap<StreamId, Vec<EventItems>>,
    /// The run and the envelope of commands whose fate is open.
    given: BTreeMap<rafcon_link::CommandId, (StreamId, String)>,
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
            silence: settings.profile.silence(),
            address: None,
            inbox,
            replicas: BTreeMap::new(),
            early: BTreeMap::new(),
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
            let stream = ids::events_of(&about.id);
            self.session.restore(ids::about_beside(stream), RangeSet::up_to(1));
            self.open(stream, about);
            if let Some(replica) = self.replicas.get(&stream) {
                self.session.restore(stream, RangeSet::up_to(replica.next() - 1));
            }
        }
    }

    fn open(&mut self, stream: StreamId, about: About) {
        let about = About { robot: Some(self.name.clone()), on_crash: None, ..about };
        let given = (self.number, self.inbox.clone());
        match ReplicaRun::open(&self.runs, &about, given) {
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
    pub(super) fn receive(&mut self, from: SocketAddr, mut datagram: Vec<u8>) -> bool {
        let (now, mut received) = (self.clock.now(), Vec::new());
        let taken = self.session.receive(now, &mut datagram, |shown| match shown {
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
            Err(Unusable::Rejected(_)) => return false,
            Err(Unusable::Broken(broken)) => {
                (self.tell)(&format!("robot {}: {broken}", self.name));
            }
        }
        for received in received {
            self.take(received);
        }
        true
    }

    fn take(&mut self, received: Received) {
        match received {
            Received::Events(stream, items) if ids::is_about(stream) => {
                if let Ok(about) = serde_json::from_slice::<About>(&items.bytes)
                    && ids::about_of(&about.id) == stream
                    && !about.id.contains(['/', '\0'])
                {
                    self.open(ids::events_beside(stream), about);
                }
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

    fn take_events(&mut self, stream: StreamId, items: EventItems) {
        let Some(replica) = self.replicas.get_mut(&stream) else {
            return self.early.entry(stream).or_default().push(items);
        };
        if let Err(error) = replica.take(items) {
            let (id, name) = (replica.id(), &self.name);
            (self.tell)(&format!("run {id} of robot {name} is not kept: {error}"));
        }
    }

    /// Makes what arrived safe, shows it, and forgets what is complete.
    pub(super) fn sync(&mut self) {
        let is_heard =
            self.session.heard_before(self.clock.now()).is_some_and(|it| it < self.silence);
        let (session, tell, name) = (&mut self.session, self.tell, &self.name);
        self.replicas.retain(|stream, replica| {
            replica.set_heard(is_heard);
            match replica.sync() {
                Ok(safe) => session.set_safe(*stream, safe),
                Err(error) => {
                    tell(&format!("run {} of robot {name} is not safe: {error}", replica.id()));
                }
            }
            let head = session.progress(*stream).map_or(0, |(head, _)| head);
            !replica.close_if_complete(head)
        });
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
