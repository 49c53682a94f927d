//! A station in the world: a persistent disk with a replica, and a server that can die.

use super::clock::LocalClock;
use super::mission::Mission;
use super::robot::{ROBOT, STREAM, key};
use super::watching::event_of;
use rafcon_link::{
    CommandId, CommandState, FromRobot, Horizon, Identity, KeyId, NewCommand, Profile, RangeSet,
    SenderStart, StationSession,
};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Interval of syncing the replica to disk.
const SYNC_EVERY: Duration = Duration::from_millis(250);

#[derive(Debug)]
pub(super) struct Station {
    /// Number of its pairing key.
    key: usize,
    pub(super) disk: StationDisk,
    pub(super) server: Option<StationServer>,
    /// Number of received events whose bytes differ from the robot's.
    pub(super) different: u64,
}

#[derive(Debug, Default)]
pub(super) struct StationDisk {
    starts: u32,
    heard: Option<Horizon>,
    /// True if the disk is full.
    pub(super) is_full: bool,
    /// The events of the replica.
    pub(super) events: RangeSet,
}

#[derive(Debug)]
pub(super) struct StationServer {
    clock: LocalClock,
    session: StationSession,
    unsynced: Vec<RangeInclusive<u64>>,
    synced: Duration,
    /// The event of the newest snapshot.
    snapshot: u64,
    /// The event of the shown state.
    pub(super) view: u64,
    pub(super) fates: BTreeMap<CommandId, CommandState>,
}

impl Station {
    pub(super) fn new(key: usize) -> Self {
        Self { key, disk: StationDisk::default(), server: None, different: 0 }
    }

    pub(super) fn start(&mut self, clock: LocalClock, profile: &Profile) {
        self.disk.starts += 1;
        let identity = Identity {
            key_id: KeyId(1),
            key: &key(self.key),
            robot: ROBOT,
            start: SenderStart::new(self.disk.starts, 0),
            heard: self.disk.heard,
        };
        let mut session = StationSession::new(&identity, profile.clone());
        session.restore(STREAM, self.disk.events.clone());
        self.server = Some(StationServer {
            clock,
            session,
            unsynced: Vec::new(),
            synced: Duration::ZERO,
            snapshot: 0,
            view: 0,
            fates: BTreeMap::new(),
        });
    }

    /// Kills the server, with all data not yet synced.
    pub(super) fn kill(&mut self) {
        self.server = None;
    }

    pub(super) fn next(&self, now: Duration) -> Option<Duration> {
        let server = self.server.as_ref()?;
        let next = server.session.poll_timeout(server.clock.local(now));
        let next = next.map(|at| server.clock.real(at));
        let may_sync = !server.unsynced.is_empty() && !self.disk.is_full;
        let sync = may_sync.then(|| server.synced + SYNC_EVERY);
        next.into_iter().chain(sync).min()
    }

    pub(super) fn transmit(&mut self, now: Duration) -> Result<Option<Vec<u8>>, String> {
        let Some(server) = &mut self.server else { return Ok(None) };
        if server.synced + SYNC_EVERY <= now && !self.disk.is_full {
            for range in server.unsynced.drain(..) {
                self.disk.events.insert(range);
            }
            self.disk.heard = server.session.horizon();
            server.session.set_safe(STREAM, self.disk.events.contiguous());
            server.synced = now;
        }
        let local = server.clock.local(now);
        server.session.poll_transmit(local).map_err(|error| error.to_string())
    }

    pub(super) fn receive(&mut self, now: Duration, mission: &Mission, mut datagram: Vec<u8>) {
        let Some(server) = &mut self.server else { return };
        let local = server.clock.local(now);
        let StationServer { session, unsynced, snapshot, fates, .. } = server;
        let different = &mut self.different;
        let _of_an_earlier_start_or_doubled =
            session.handle_datagram(local, &mut datagram, |shown| match shown {
                FromRobot::Events { block, .. } => {
                    let made = mission.items(block.first_sequence, block.last_sequence());
                    *different += u64::from(made != (block.time_before, block.bytes));
                    unsynced.push(block.sequences());
                }
                FromRobot::Snapshot { sequence, .. } => *snapshot = sequence,
                FromRobot::CommandState { id, state, .. } => {
                    fates.insert(id, state);
                }
                FromRobot::Watched { values, .. } => {
                    let head = mission.head(now);
                    let is_wrong = |value: &Vec<u8>| event_of(value).is_none_or(|of| of > head);
                    *different += values.iter().filter(|value| is_wrong(value)).count() as u64;
                }
                FromRobot::Started
                | FromRobot::Status { .. }
                | FromRobot::NewKey { .. }
                | FromRobot::ValuePart { .. }
                | FromRobot::NoValue { .. } => {}
            });
        let Some(received) = session.received(STREAM) else { return };
        let after_snapshot = received.end_at(*snapshot + 1).unwrap_or(*snapshot);
        server.view = server.view.max(received.contiguous()).max(after_snapshot);
    }

    /// The robot's calendar as the station knows it: the start of the robot whose clock is known, and the bounds.
    pub(super) fn robot_calendar(&self, now: Duration) -> Option<(u32, u64, Option<u64>)> {
        let server = self.server.as_ref()?;
        let local = server.clock.local(now);
        let (earliest, latest) = server.session.robot_calendar(local)?;
        Some((server.session.robot_clock(local)?.start.0, earliest, latest))
    }

    /// True if the server knows all events on its disk, and reports no other event as safe.
    pub(super) fn knows_its_disk(&self) -> bool {
        let received = self.server.as_ref().and_then(|server| server.session.received(STREAM));
        received
            .is_none_or(|received| self.disk.events.ranges().all(|range| received.contains(&range)))
    }

    /// The last event before the first gap.
    pub(super) fn contiguous(&self) -> u64 {
        let progress = self.server.as_ref().and_then(|server| server.session.progress(STREAM));
        progress.map_or(0, |progress| progress.contiguous)
    }

    /// Sends a watch request to the robot; false if no server runs.
    pub(super) fn watch(&mut self, number: u64, body: Vec<u8>) -> bool {
        let Some(server) = &mut self.server else { return false };
        server.session.watch(STREAM, number, body).is_ok()
    }

    /// Sends a command; false if it cannot be sent.
    pub(super) fn command(&mut self, now: Duration, command: NewCommand) -> bool {
        let Some(server) = &mut self.server else { return false };
        server.session.command(server.clock.local(now), command).is_ok()
    }
}
