//! Requests for values over a bad link in virtual time: large values and values that are watched, beside events that never wait for them.

use crate::frame::{NoValue, StreamId, ValueId, ValueName};
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::robot::{NewestValue, RobotSession, RunSource, WatchSubscription};
use crate::seal::{KeyId, PairingKey, SenderStart};
use crate::session_time::SessionTime;
use crate::station::{FromRobot, StationSession};
use crate::{Direction, Identity};
use expect_test::expect;
use rafcon_events::{EventBlock, EventBlockRef};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

const STREAM: StreamId = StreamId(1);
const DELAY: Duration = Duration::from_millis(500);
const STEP: Duration = Duration::from_millis(5);
const VALUE: ValueName = ValueName { stream: STREAM, number: 7, id: ValueId([9; 16]) };
/// What an event takes here.
const EVENT_BYTES: usize = 40;

/// An event that no coder makes shorter.
fn event(number: u64) -> Vec<u8> {
    let mut state = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state.to_be_bytes()[0]
    };
    (0..EVENT_BYTES).map(|_| next()).collect()
}

/// A robot with a run and a large value, a station, and a path that loses datagrams.
struct World {
    now: SessionTime,
    robot: RobotSession,
    station: StationSession,
    starts: u32,
    /// Datagrams on their way, with the time of their arrival.
    down: VecDeque<(SessionTime, Vec<u8>)>,
    up: VecDeque<(SessionTime, Vec<u8>)>,
    sent: u64,
    /// One in so many datagrams is lost; all, if it is 1.
    loses_one_in: [u64; 2],
    disk: Disk,
    here: Here,
}

struct Disk {
    value: Vec<u8>,
    head: u64,
    /// How many bytes of the value were read.
    read: u64,
}

/// What the station has.
#[derive(Default)]
struct Here {
    value: BTreeMap<u64, Vec<u8>>,
    refused: Option<NoValue>,
    watched: Vec<(u64, String)>,
    /// When each event arrived.
    events: BTreeMap<u64, SessionTime>,
}

impl RunSource for Disk {
    fn events(
        &mut self,
        _stream: StreamId,
        first: u64,
        last: u64,
        bytes_max: usize,
    ) -> Option<EventBlock> {
        let most = (bytes_max / EVENT_BYTES).max(1) as u64;
        let count = (last.min(self.head) + 1).saturating_sub(first).min(most);
        let items = (first..first + count).flat_map(event).collect();
        (count > 0).then_some(EventBlock {
            first_sequence: first,
            count,
            time_before: 0,
            bytes: items,
        })
    }

    fn snapshot(&mut self, _stream: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }

    fn value_length(&mut self, value: &ValueName) -> Option<u64> {
        (*value == VALUE).then_some(self.value.len() as u64)
    }

    fn value_bytes(
        &mut self,
        _value: &ValueName,
        offset: u64,
        bytes_max: usize,
    ) -> Option<Vec<u8>> {
        let rest = self.value.get(usize::try_from(offset).ok()?..)?;
        let bytes = rest[..rest.len().min(bytes_max)].to_vec();
        self.read += bytes.len() as u64;
        Some(bytes)
    }
}

fn identity(key: &PairingKey, start: u32) -> Identity<'_> {
    Identity {
        key_id: KeyId(1),
        key,
        robot: "scout",
        start: SenderStart::new(start, 0),
        heard: None,
    }
}

impl World {
    fn new(head: u64) -> Self {
        let key = PairingKey::from_bytes([7; 32]);
        let value = (0..200_000_u32).map(|at| at.to_le_bytes()[at as usize % 3]).collect();
        let mut robot = RobotSession::new(&identity(&key, 1), Profile::DELAY_2S);
        robot.begin(STREAM, head);
        Self {
            now: SessionTime::BEGIN,
            robot,
            station: StationSession::new(&identity(&key, 1), Profile::DELAY_2S),
            starts: 1,
            down: VecDeque::new(),
            up: VecDeque::new(),
            sent: 0,
            loses_one_in: [u64::MAX; 2],
            disk: Disk { value, head, read: 0 },
            here: Here::default(),
        }
    }

    /// Both servers start again; only disks stay.
    fn restart(&mut self) {
        self.starts += 1;
        let key = PairingKey::from_bytes([7; 32]);
        self.robot = RobotSession::new(&identity(&key, self.starts), Profile::DELAY_2S);
        self.robot.begin(STREAM, self.disk.head);
        self.station = StationSession::new(&identity(&key, self.starts), Profile::DELAY_2S);
        self.station.restore(STREAM, RangeSet::up_to(self.disk.head));
    }

    fn happens(&mut self) {
        self.disk.head += 1;
        let first = self.disk.head;
        let items = event(first);
        self.robot.append(
            STREAM,
            EventBlockRef { first_sequence: first, count: 1, time_before: 0, bytes: &items },
        );
    }

    /// Counts a datagram; answers whether it is lost.
    fn lose(&mut self, direction: Direction) -> bool {
        self.sent += 1;
        let one_in = self.loses_one_in[usize::from(direction == Direction::Up)];
        self.sent.is_multiple_of(one_in)
    }

    fn step(&mut self) {
        self.now += STEP;
        let now = self.now;
        while let Some(datagram) = self.robot.poll_transmit(now, &mut self.disk).expect("numbers") {
            if !self.lose(Direction::Down) {
                self.down.push_back((now + DELAY, datagram));
            }
        }
        while let Some(datagram) = self.station.poll_transmit(now).expect("numbers") {
            if !self.lose(Direction::Up) {
                self.up.push_back((now + DELAY, datagram));
            }
        }
        while let Some((_, mut datagram)) = self.up.pop_front_if(|(at, _)| *at <= now) {
            // What was on its way to the start before is rejected.
            let _used_or_obsolete = self.robot.handle_datagram(now, &mut datagram, |_| {});
        }
        while let Some((_, mut datagram)) = self.down.pop_front_if(|(at, _)| *at <= now) {
            let here = &mut self.here;
            let show = |shown: FromRobot<'_>| match shown {
                FromRobot::ValuePart { offset, bytes, .. } => {
                    here.value.insert(offset, bytes.to_vec());
                }
                FromRobot::NoValue { why, .. } => here.refused = Some(why),
                FromRobot::Watched { number, values, .. } => {
                    let text = |value: Vec<u8>| String::from_utf8(value).expect("text");
                    here.watched.extend(values.into_iter().map(|value| (number, text(value))));
                }
                FromRobot::Events { block, .. } => {
                    for event in block.sequences() {
                        here.events.entry(event).or_insert(now);
                    }
                }
                _ => {}
            };
            self.station.handle_datagram(now, &mut datagram, show).expect("a datagram");
        }
        if let Some(received) = self.station.received(STREAM) {
            let safe = received.contiguous();
            self.station.set_safe(STREAM, safe);
        }
    }

    /// For so long; events happen ten times a second if `is_busy`.
    fn run(&mut self, seconds: u64, is_busy: bool) {
        let steps = Duration::from_secs(seconds).as_millis() / STEP.as_millis();
        for step in 0..steps {
            if is_busy && step.is_multiple_of(20) {
                self.happens();
            }
            self.step();
        }
    }

    fn fetch(&mut self, here: RangeSet, budget: u64) {
        assert!(self.station.fetch(VALUE, self.disk.value.len() as u64, here, budget));
    }

    /// The value as the station has it.
    fn value(&self) -> Vec<u8> {
        self.here.value.values().flatten().copied().collect()
    }

    fn has_all(&self) -> bool {
        let progress = self.station.fetch_progress(VALUE.id);
        progress.is_some_and(|it| it.here.contiguous() == self.disk.value.len() as u64)
    }
}

#[test]
fn a_large_value_comes_whole_although_one_in_seven_datagrams_is_lost() {
    let mut world = World::new(0);
    world.loses_one_in = [7, 7];
    world.happens();
    world.run(5, false);
    world.fetch(RangeSet::default(), 1_000_000);
    world.run(60, false);
    assert!(world.has_all());
    assert!(world.value() == world.disk.value, "other bytes came");
    let read = world.disk.read * 100 / world.disk.value.len() as u64;
    assert!(read < 130, "{read} % of the value were sent");
}

#[test]
fn events_do_not_wait_for_a_large_value() {
    let latest = |is_fetching: bool| {
        let mut world = World::new(0);
        world.run(5, true);
        if is_fetching {
            world.fetch(RangeSet::default(), 1_000_000);
        }
        let first = world.disk.head + 1;
        // Shorter than the value takes.
        world.run(6, true);
        assert!(!is_fetching || world.disk.read > 100_000);
        // An event happens in every twentieth step.
        let begin = SessionTime::from_millis(5_000);
        let late = |(event, at): (&u64, &SessionTime)| {
            let happened =
                begin + STEP + Duration::from_millis(100) * u32::try_from(event - first).unwrap();
            at.since(happened + DELAY)
        };
        world.here.events.range(first..).map(late).max().expect("events")
    };
    let (alone, beside) = (latest(false), latest(true));
    // One datagram of the value may be leaving just then.
    let datagram = Duration::from_millis(40);
    assert!(beside <= alone + datagram, "{beside:?} beside it, {alone:?} without");
}

#[test]
fn a_large_value_never_costs_more_than_was_allowed() {
    let mut world = World::new(1);
    world.run(5, false);
    world.fetch(RangeSet::default(), 50_000);
    world.run(20, false);
    assert_eq!(world.here.refused, Some(NoValue::OverBudget));
    assert!(world.disk.read <= 50_000 + 1_200 && world.disk.read > 40_000, "{}", world.disk.read);
}

#[test]
fn a_large_value_goes_on_after_a_blackout_and_after_restarts_of_both_sides() {
    let mut world = World::new(1);
    world.run(5, false);
    world.fetch(RangeSet::default(), 1_000_000);
    world.run(4, false);
    world.loses_one_in = [1, 1];
    world.run(60, false);
    let in_the_dark = world.disk.read;
    world.run(60, false);
    assert_eq!(world.disk.read, in_the_dark, "nothing is sent to nobody");
    let noted = world.station.fetch_progress(VALUE.id).expect("progress").here.clone();
    let noted_bytes = noted.count();
    assert!(noted_bytes > 10_000);
    world.loses_one_in = [u64::MAX; 2];
    world.restart();
    world.fetch(noted, 1_000_000);
    world.run(20, false);
    assert!(world.has_all());
    assert!(world.value() == world.disk.value, "other bytes came");
    // Twice at most: what was on its way when it got dark, and what was sent before that was noticed.
    let (read, again) = (world.disk.read, 200_000 - noted_bytes);
    assert!(read <= 200_000 + again, "{read} bytes were sent, {noted_bytes} of them were noted");
}

#[test]
fn a_value_that_is_not_there_is_refused_and_one_that_is_given_up_stops() {
    let mut world = World::new(1);
    world.run(5, false);
    let other = ValueName { id: ValueId([1; 16]), ..VALUE };
    assert!(world.station.fetch(other, 77, RangeSet::default(), 1_000));
    world.run(3, false);
    assert_eq!(world.here.refused, Some(NoValue::Gone));
    world.station.end_fetch(other.id);
    world.fetch(RangeSet::default(), 1_000_000);
    world.run(3, false);
    world.station.end_fetch(VALUE.id);
    world.run(30, false);
    let read = world.disk.read;
    assert!(read < 130_000, "{read} bytes were sent, of which nobody wants most");
}

#[test]
fn many_large_values_take_their_turns_and_have_a_bound() {
    let mut world = World::new(1);
    world.run(5, false);
    let mut taken = 0;
    for nth in 0..100 {
        let value = ValueName { id: ValueId([nth; 16]), ..VALUE };
        taken += usize::from(world.station.fetch(value, 10, RangeSet::default(), 10));
    }
    assert_eq!(taken, 8);
}

/// Watches values, and returns what arrives at the robot.
fn watch(world: &mut World, number: u64, body: &str) -> Option<WatchSubscription> {
    world.station.watch(STREAM, number, body.as_bytes().to_vec()).expect("a short list");
    for _ in 0..2_000 {
        world.step();
        if let Some(subscription) = world.robot.take_subscription() {
            return Some(subscription);
        }
    }
    None
}

#[test]
fn a_wish_arrives_once_although_its_parts_are_lost() {
    let mut world = World::new(1);
    world.loses_one_in = [3, 3];
    world.run(5, false);
    // Three datagrams.
    let body = "navigation ".repeat(60);
    let arrived = watch(&mut world, 5, &body).expect("a list");
    assert_eq!((arrived.number, arrived.body), (5, body.into_bytes()));
    world.run(20, false);
    assert_eq!(world.robot.take_subscription(), None);
    assert_eq!(world.station.is_watch_confirmed(STREAM), Some(true));
    let up = world.station.traffic().0.by_kind["wishes"];
    world.run(60, false);
    assert_eq!(world.station.traffic().0.by_kind["wishes"], up, "what is known is not repeated");
    let later = watch(&mut world, 6, "vision").expect("a list");
    assert_eq!(later.number, 6);
    let endless = world.station.watch(STREAM, 7, vec![0; 20_000]).expect_err("too long");
    expect!["what is watched has 20000 bytes, and at most 16384 fit: watch less, or whole states instead of their values"]
        .assert_eq(&endless.to_string());
}

#[test]
fn a_robot_that_started_again_is_asked_again() {
    let mut world = World::new(1);
    world.run(5, false);
    watch(&mut world, 5, "arm").expect("a list");
    world.run(5, false);
    let key = PairingKey::from_bytes([7; 32]);
    world.robot = RobotSession::new(&identity(&key, 2), Profile::DELAY_2S);
    world.robot.begin(STREAM, 1);
    world.run(5, false);
    assert_eq!(world.robot.take_subscription().map(|it| it.number), Some(5));
}

fn set(world: &mut World, key: u32, priority: u8, text: &str) {
    let (sequence, bytes) = (world.disk.head, text.as_bytes().to_vec());
    world.robot.set_watched(STREAM, key, NewestValue { priority, sequence, bytes });
}

#[test]
fn watched_values_cost_nothing_while_their_events_come() {
    let mut world = World::new(0);
    world.run(5, true);
    watch(&mut world, 1, "arm").expect("a list");
    for round in 0..100 {
        world.happens();
        set(&mut world, 0, 0, &format!("pose {round}"));
        world.run(1, false);
    }
    assert_eq!(world.here.watched, []);
    let told = world.robot.traffic().0.by_kind["watched values"];
    assert!(told < 20, "{told} bytes for the answer that the list is known");
}

#[test]
fn watched_values_go_ahead_of_a_long_history_the_first_ones_first_and_only_the_newest() {
    // 800 KB of events: 25 s at this rate.
    let mut world = World::new(20_000);
    world.run(3, false);
    watch(&mut world, 1, "arm").expect("a list");
    for round in 0..50 {
        world.happens();
        set(&mut world, 0, 9, &format!("map {round}"));
        set(&mut world, 1, 0, &format!("pose {round}"));
    }
    world.run(2, false);
    let first: Vec<_> = world.here.watched.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(first, ["pose 49", "map 49", "pose 49", "map 49"]);
    let received = world.station.received(STREAM).expect("events");
    assert!(received.contiguous() < 20_000, "the events are not here yet");
    world.run(60, false);
    assert_eq!(world.here.watched.len(), 4, "nothing more was worth its bytes");
}

#[test]
fn without_an_up_link_what_was_asked_for_last_goes_on_and_stays_in_its_budget() {
    let mut world = World::new(0);
    world.run(5, true);
    watch(&mut world, 3, "arm").expect("a list");
    world.loses_one_in = [u64::MAX, 1];
    world.run(10, false);
    let before = world.robot.traffic().0.by_kind["watched values"];
    for round in 0..300 {
        world.happens();
        for key in 0..40 {
            let text = format!("value {key} {round} {}", "x".repeat(250));
            set(&mut world, key, u8::try_from(key).unwrap(), &text);
        }
        world.run(1, false);
    }
    let per_s = (world.robot.traffic().0.by_kind["watched values"] - before) / 300;
    let budget = Profile::DELAY_2S.down_bits_per_s / 8 / 8;
    assert!(per_s > budget / 2 && per_s <= budget + 100, "{per_s} bytes a second of {budget}");
    let newest = world.here.watched.iter().rev().find(|(_, text)| text.starts_with("value 0 "));
    assert!(newest.expect("values").1.starts_with("value 0 299"));
}

#[test]
fn whatever_a_station_wishes_memory_stays_bounded() {
    let mut world = World::new(1);
    world.run(5, false);
    watch(&mut world, 1, "all").expect("a list");
    for key in 0..10_000 {
        set(&mut world, key, 0, "value");
    }
    set(&mut world, 0, 0, &"too long for a datagram ".repeat(100));
    // Of a run that the robot does not have.
    world.station.watch(StreamId(99), 1, b"other".to_vec()).expect("a short list");
    world.run(5, false);
    assert_eq!(world.robot.take_subscription(), None);
    assert_eq!(world.station.is_watch_confirmed(StreamId(99)), Some(false));
}
