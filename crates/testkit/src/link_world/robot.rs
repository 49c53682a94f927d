//! The robot in the world: a persistent disk, and a server that can die.

use super::clock::LocalClock;
use super::mission::{Mission, MissionState};
use super::watching::Watched;
use rafcon_link::{
    CommandId, CommandState, EventBlock, EventBlockRef, Horizon, Identity, KeyId, PairingKey,
    Profile, ReceivedCommand, RobotSession, RunSource, SenderStart, StreamId, Traffic,
};
use std::collections::BTreeMap;
use std::time::Duration;

/// Stream of the only run.
pub(super) const STREAM: StreamId = StreamId(1);
pub(super) const ROBOT: &str = "scout";

/// The key that the robot shares with the station of this number.
pub(super) fn key(station: usize) -> PairingKey {
    PairingKey::from_bytes([if station == 0 { 7 } else { 8 }; 32])
}

#[derive(Debug)]
pub(super) struct Robot {
    disk: RobotDisk,
    pub(super) calendar: Calendar,
    pub(super) server: Option<RobotServer>,
    state: MissionState,
}

/// Offsets of the calendar from the time of the world, in ms, each with the time from which it applies.
#[derive(Debug)]
pub(super) struct Calendar {
    pub(super) settings: Vec<(Duration, u64)>,
}

impl Calendar {
    /// The calendar time now, in ms since 1970.
    fn at(&self, now: Duration) -> u64 {
        let more = self.settings.last().map_or(0, |(_, more)| *more);
        more + u64::try_from(now.as_millis()).unwrap_or_default()
    }

    /// Sets the calendar forward, or back.
    pub(super) fn jump(&mut self, now: Duration, ms: i64) {
        let more = self.settings.last().map_or(0, |(_, more)| *more);
        self.settings.push((now, more.saturating_add_signed(ms)));
    }
}

#[derive(Debug)]
struct RobotDisk {
    starts: u32,
    heard: Vec<Option<Horizon>>,
    /// Watched states of each station.
    watched: Vec<Watched>,
    commands: BTreeMap<CommandId, CommandState>,
    epoch: u64,
}

#[derive(Debug)]
pub(super) struct RobotServer {
    clock: LocalClock,
    /// One for each station.
    sessions: Vec<RobotSession>,
    head: u64,
}

/// A command that the robot executed.
#[derive(Debug, Clone, Copy)]
pub(super) struct CarriedOut {
    pub(super) id: CommandId,
    pub(super) epoch: u64,
}

struct Journal<'m> {
    mission: &'m Mission,
    state: &'m mut MissionState,
    head: u64,
}

impl RunSource for Journal<'_> {
    fn events(
        &mut self,
        _stream: StreamId,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Option<EventBlock> {
        let fits = |last: &u64| self.mission.items(first, *last).1.len() <= bytes_max;
        let (mut fitting, mut beyond) = (first, last.min(self.head) + 1);
        while beyond - fitting > 1 {
            let middle = fitting.midpoint(beyond);
            *(if fits(&middle) { &mut fitting } else { &mut beyond }) = middle;
        }
        let (time_before, items) = self.mission.items(first, fitting);
        let (count, items) = (fitting - first + 1, items.to_vec());
        Some(EventBlock { first_sequence: first, count, time_before, bytes: items })
    }

    fn snapshot(&mut self, _stream: StreamId) -> Option<(u64, Vec<u8>)> {
        self.state.follow(self.mission, self.head);
        Some((self.head, self.state.take_bytes()))
    }
}

impl Robot {
    pub(super) fn new(stations: usize) -> Self {
        let heard = vec![None; stations];
        let watched = (0..stations).map(|_| Watched::default()).collect();
        let disk = RobotDisk { starts: 0, heard, watched, commands: BTreeMap::new(), epoch: 1 };
        let calendar = Calendar { settings: vec![(Duration::ZERO, 1_700_000_000_000)] };
        Self { disk, calendar, server: None, state: MissionState::new() }
    }

    /// Starts the server when the mission is at this event.
    pub(super) fn start(&mut self, clock: LocalClock, profile: &Profile, head: u64) {
        self.disk.starts += 1;
        let session = |(station, heard): (usize, &Option<Horizon>)| {
            let identity = Identity {
                key_id: KeyId(1),
                key: &key(station),
                robot: ROBOT,
                start: SenderStart::new(self.disk.starts, 0),
                heard: *heard,
            };
            let mut session = RobotSession::new(&identity, profile.clone());
            session.begin(STREAM, head);
            if self.disk.watched[station].number > 0 {
                session.set_subscription(STREAM, self.disk.watched[station].number);
            }
            session
        };
        let sessions = self.disk.heard.iter().enumerate().map(session).collect();
        self.server = Some(RobotServer { clock, sessions, head });
    }

    /// Ends the server without saving. Only the disk remains.
    pub(super) fn kill(&mut self) {
        self.server = None;
    }

    /// The number of the last start of the server.
    pub(super) fn starts(&self) -> u32 {
        self.disk.starts
    }

    /// Follows the mission up to this event.
    pub(super) fn follow(&mut self, now: Duration, mission: &Mission, head: u64, is_over: bool) {
        let Some(server) = &mut self.server else { return };
        let (local, calendar) = (server.clock.local(now), self.calendar.at(now));
        for first in server.head + 1..=head {
            let (time_before, items) = mission.items(first, first);
            let block =
                EventBlockRef { first_sequence: first, count: 1, time_before, bytes: items };
            server.sessions.iter_mut().for_each(|session| session.append(STREAM, block));
        }
        server.head = server.head.max(head);
        for session in &mut server.sessions {
            session.set_calendar(local, calendar);
            session.set_state(STREAM, b"running", is_over);
        }
        for (session, watched) in server.sessions.iter_mut().zip(&mut self.disk.watched) {
            if watched.number > 0 {
                self.state.follow(mission, head);
                watched.tell(local, &self.state, session);
            }
        }
    }

    /// The next datagram for a station.
    pub(super) fn transmit(
        &mut self,
        now: Duration,
        station: usize,
        mission: &Mission,
    ) -> Result<Option<Vec<u8>>, String> {
        let Some(server) = &mut self.server else { return Ok(None) };
        let (local, state) = (server.clock.local(now), &mut self.state);
        let mut journal = Journal { mission, state, head: server.head };
        let session = &mut server.sessions[station];
        session.poll_transmit(local, &mut journal).map_err(|error| error.to_string())
    }

    /// Traffic to a station since the start of the server.
    pub(super) fn sent(&self, station: usize) -> Traffic {
        let sent = self.server.as_ref().map(|server| server.sessions[station].traffic().0.clone());
        sent.unwrap_or_default()
    }

    /// Time of the next action for a station.
    pub(super) fn next(&self, now: Duration, station: usize) -> Option<Duration> {
        let server = self.server.as_ref()?;
        let next = server.sessions[station].poll_timeout(server.clock.local(now));
        next.map(|at| server.clock.real(at))
    }

    /// Receives a datagram of a station; returns the commands executed because of it.
    pub(super) fn receive(
        &mut self,
        now: Duration,
        station: usize,
        mut datagram: Vec<u8>,
    ) -> Vec<CarriedOut> {
        let Some(server) = &mut self.server else { return Vec::new() };
        let (local, mut received) = (server.clock.local(now), Vec::new());
        let session = &mut server.sessions[station];
        let _of_an_earlier_start_or_doubled =
            session.handle_datagram(local, &mut datagram, |command| received.push(command));
        self.disk.heard[station] = session.horizon();
        self.disk.watched[station].take(session);
        let mut done = Vec::new();
        for ReceivedCommand { id, epoch, is_late, .. } in received {
            let is_new = !self.disk.commands.contains_key(&id);
            if is_new && is_late {
                continue;
            }
            let is_allowed = epoch >= self.disk.epoch;
            let outcome = if is_allowed { CommandState::Done } else { CommandState::Refused };
            let state = *self.disk.commands.entry(id).or_insert(outcome);
            if is_new && is_allowed {
                self.disk.epoch = epoch;
                done.push(CarriedOut { id, epoch });
            }
            server.sessions[station].set_command_state(local, id, state, "");
        }
        done
    }
}
