//! Thousands of short runs of one robot, more than are open at a time, over a path that loses datagrams, while both sides start again.

use crate::endpoint::Identity;
use crate::frame::{Frame, StreamId};
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::robot::{RobotSession, RunSource};
use crate::seal::{Direction, For, KeyId, PairingKey, Sealer, SenderStart};
use crate::session_time::SessionTime;
use crate::station::{FromRobot, OPEN_MAX, StationSession};
use rafcon_events::{EventBlock, EventBlockRef};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

/// Each run has as many events.
const EVENTS: u64 = 4;
/// The robot keeps the newest runs, and begins to send them again after a start.
const KEPT: usize = 30;

/// Events of a robot, which are alike.
struct Journal;

impl RunSource for Journal {
    fn events(&mut self, _: StreamId, first: u64, last: u64, _: usize) -> Option<EventBlock> {
        let count = last - first + 1;
        Some(EventBlock {
            first_sequence: first,
            count,
            time_before: 0,
            bytes: (0..count).map(|_| 7).collect(),
        })
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

fn events_of(run: u32) -> StreamId {
    StreamId(run * 4 + 1)
}

fn about_of(run: u32) -> StreamId {
    StreamId(run * 4)
}

/// A robot and its station, with what their disks have.
struct ShortRunWorld {
    key: PairingKey,
    now: SessionTime,
    starts: u32,
    robot: RobotSession,
    station: StationSession,
    kept: VecDeque<u32>,
    /// The events on the disk of the station.
    disk: BTreeMap<StreamId, RangeSet>,
    settled: BTreeMap<StreamId, u64>,
    over: BTreeSet<StreamId>,
    sent: u32,
}

impl ShortRunWorld {
    fn new() -> Self {
        let key = PairingKey::from_bytes([7; 32]);
        let identity = identity(&key, 1);
        Self {
            now: SessionTime::BEGIN,
            starts: 1,
            robot: RobotSession::new(&identity, Profile::LAN),
            station: StationSession::new(&identity, Profile::LAN),
            kept: VecDeque::new(),
            disk: BTreeMap::new(),
            settled: BTreeMap::new(),
            over: BTreeSet::new(),
            sent: 0,
            key,
        }
    }

    /// A run happens on the robot.
    fn run(&mut self, run: u32) {
        self.begin(run, 0);
        for first in 1..=EVENTS {
            let stream = events_of(run);
            self.robot.append(
                stream,
                EventBlockRef { first_sequence: first, count: 1, time_before: 0, bytes: &[7] },
            );
        }
        self.robot.set_state(events_of(run), b"f", true);
        self.kept.push_back(run);
        let is_known = |robot: &RobotSession, run: &u32| robot.progress(events_of(*run)).is_none();
        if self.kept.len() > KEPT && self.kept.front().is_some_and(|run| is_known(&self.robot, run))
        {
            self.kept.pop_front();
        }
    }

    fn begin(&mut self, run: u32, head: u64) {
        self.robot.begin(about_of(run), 1);
        self.robot.set_state(about_of(run), &[], true);
        self.robot.begin(events_of(run), head);
    }

    fn restart_robot(&mut self) {
        self.starts += 1;
        self.robot = RobotSession::new(&identity(&self.key, self.starts), Profile::LAN);
        for run in self.kept.clone() {
            self.begin(run, EVENTS);
            self.robot.set_state(events_of(run), b"f", true);
        }
    }

    fn restart_station(&mut self) {
        self.starts += 1;
        self.station = StationSession::new(&identity(&self.key, self.starts), Profile::LAN);
        for (stream, events) in &self.disk {
            match self.settled.get(stream) {
                Some(events) => self.station.restore_whole(*stream, *events),
                None => self.station.restore(*stream, events.clone()),
            }
        }
    }

    fn arrive_at_robot(&mut self, mut datagram: Vec<u8>) {
        if !self.lose_some() {
            let _of_an_earlier_start = self.robot.handle_datagram(self.now, &mut datagram, |_| {});
        }
    }

    /// Carries datagrams, of which one in five is lost.
    fn go_on(&mut self, steps: u64) {
        for _ in 0..steps {
            self.now += Duration::from_millis(10);
            while let Some(datagram) =
                self.robot.poll_transmit(self.now, &mut Journal).expect("room")
            {
                self.arrive(datagram);
            }
            while let Some(datagram) = self.station.poll_transmit(self.now).expect("room") {
                self.arrive_at_robot(datagram);
            }
        }
        for run in &self.kept {
            for stream in [about_of(*run), events_of(*run)] {
                if self.robot.is_complete(stream) {
                    self.robot.end(stream);
                }
            }
        }
    }

    fn lose_some(&mut self) -> bool {
        self.sent += 1;
        self.sent.is_multiple_of(5)
    }

    fn arrive(&mut self, mut datagram: Vec<u8>) {
        if self.lose_some() {
            return;
        }
        let (disk, over) = (&mut self.disk, &mut self.over);
        let mut changed = BTreeSet::new();
        let show = |shown: FromRobot<'_>| match shown {
            FromRobot::Events { stream, block } => {
                disk.entry(stream).or_default().insert(block.sequences());
                changed.insert(stream);
            }
            FromRobot::Status { stream, is_over: true, .. } => {
                over.insert(stream);
                changed.insert(stream);
            }
            _ => {}
        };
        let _of_an_earlier_start = self.station.handle_datagram(self.now, &mut datagram, show);
        for stream in changed {
            let safe = self.disk.get(&stream).map_or(0, RangeSet::contiguous);
            self.station.set_safe(stream, safe);
            let most = if stream.0.is_multiple_of(4) { 1 } else { EVENTS };
            if safe == most && self.over.contains(&stream) {
                self.settled.insert(stream, safe);
            }
        }
    }
}

fn identity(key: &PairingKey, start: u32) -> Identity<'_> {
    let (key_id, start) = (KeyId(1), SenderStart::new(start, 0));
    Identity { key_id, key, robot: "scout", start, heard: None }
}

#[test]
fn every_one_of_thousands_of_short_runs_arrives_and_is_settled() {
    let (mut world, runs) = (ShortRunWorld::new(), 2_400_usize);
    for run in (0..).take(runs) {
        world.run(run);
        world.go_on(2);
        match run % 700 {
            300 => world.restart_robot(),
            600 => world.restart_station(),
            _ => {}
        }
    }
    world.go_on(1_000);
    let is_missing = |run: &u32| !world.settled.contains_key(&events_of(*run));
    let missing: Vec<_> = (0..).take(runs).filter(is_missing).collect();
    assert_eq!(missing, [0; 0]);
    let (open, settled) = world.station.stream_counts();
    assert_eq!((open, settled), (0, 2 * runs));
    assert!(!world.station.is_crowded(world.now));
}

#[test]
fn a_settled_stream_goes_on_and_is_reported_when_the_robot_asks() {
    let mut world = ShortRunWorld::new();
    world.run(1);
    world.go_on(1_000);
    assert_eq!(world.station.stream_counts(), (0, 2));
    // The run is resumed on the robot, which has started again.
    world.restart_robot();
    world.go_on(100);
    assert!(world.robot.progress(events_of(1)).is_none_or(|(_, missing)| missing == 0));
    world.begin(1, EVENTS);
    world.robot.set_state(events_of(1), b"l", false);
    let (stream, items) = (events_of(1), &[7][..]);
    world.robot.append(
        stream,
        EventBlockRef { first_sequence: EVENTS + 1, count: 1, time_before: 0, bytes: items },
    );
    world.go_on(100);
    let received = world.station.received(events_of(1)).expect("a run").contiguous();
    assert_eq!(received, EVENTS + 1);
}

/// A station with as many open streams as it takes, and what seals for its robot.
fn full() -> (StationSession, Sealer) {
    let key = PairingKey::from_bytes([7; 32]);
    let mut station = StationSession::new(&identity(&key, 1), Profile::LAN);
    let mut robot = Sealer::new(KeyId(1), &key, "scout", Direction::Down, SenderStart::new(1, 0));
    for run in (0..).take(OPEN_MAX) {
        name(&mut station, &mut robot, SessionTime::BEGIN, run);
    }
    (station, robot)
}

/// The robot names a run.
fn name(station: &mut StationSession, robot: &mut Sealer, now: SessionTime, run: u32) {
    let (mut payload, mut datagram) = (vec![0], Vec::new());
    let stream = events_of(run);
    Frame::Status { stream, head: 9, is_over: false, state: b"", chain: None }.write(&mut payload);
    robot.seal(For::Anyone, &payload, &mut datagram).expect("a number");
    station.handle_datagram(now, &mut datagram, |_| {}).expect("a datagram");
}

#[test]
fn a_stream_that_is_turned_away_is_reported_and_comes_once_there_is_room() {
    let (mut station, mut robot) = full();
    let (now, new) = (SessionTime::from_millis(1_000), u32::MAX / 8);
    assert!(!station.is_crowded(now));
    name(&mut station, &mut robot, now, new);
    assert!(station.is_crowded(now));
    assert_eq!(station.progress(events_of(new)), None);
    station.settle(events_of(0), 9);
    name(&mut station, &mut robot, now, new);
    assert!(station.progress(events_of(new)).is_some());
}

#[test]
fn a_stream_that_the_robot_does_not_name_any_more_makes_room() {
    for (seconds, makes_room) in [(599, false), (600, true), (3_600, true)] {
        let (mut station, mut robot) = full();
        let now = SessionTime::after(Duration::from_secs(seconds));
        for run in (1..).take(OPEN_MAX) {
            name(&mut station, &mut robot, now, run);
        }
        assert_eq!(station.is_crowded(now), !makes_room, "after {seconds} s");
        let is_settled = station.progress(events_of(0)).is_some_and(|it| it.is_settled);
        assert_eq!(is_settled, makes_room, "after {seconds} s");
    }
}

#[test]
fn the_oldest_of_too_many_settled_streams_is_forgotten_and_may_come_again() {
    let (mut station, mut robot) = full();
    station.set_settled_max(3);
    for run in 0..5 {
        station.settle(events_of(run), 9);
    }
    let is_known = |run: u32| station.progress(events_of(run)).is_some();
    assert_eq!([0, 1, 2, 3, 4].map(is_known), [false, false, true, true, true]);
    name(&mut station, &mut robot, SessionTime::BEGIN, 0);
    assert!(station.progress(events_of(0)).is_some_and(|it| it.contiguous == 0));
}

#[test]
fn of_more_open_runs_than_fit_into_a_report_each_is_reported() {
    let (mut station, _) = full();
    let key = PairingKey::from_bytes([7; 32]);
    let mut robot = RobotSession::new(&identity(&key, 1), Profile::LAN);
    for run in (0..).take(OPEN_MAX) {
        robot.begin(events_of(run), 9);
        station.restore(events_of(run), RangeSet::up_to(9));
    }
    for second in 1..600 {
        let now = SessionTime::after(Duration::from_secs(second));
        while let Some(mut datagram) = station.poll_transmit(now).expect("a number") {
            robot.handle_datagram(now, &mut datagram, |_| {}).expect("a report");
        }
    }
    let is_missing = |run: &u32| robot.progress(events_of(*run)) != Some((9, 0));
    assert_eq!((0..).take(OPEN_MAX).find(is_missing), None);
}
