//! Random events over random links: every event arrives with its bytes, once, and neither side spins.

use rafcon_link::{
    EventBlock, EventBlockRef, FromRobot, Horizon, Identity, KeyId, PairingKey, Profile, RangeSet,
    Rank, RobotSession, RunSource, SenderStart, SessionTime, StationSession, StreamId, Unusable,
};
use rafcon_testkit::link_world::{Carrier, Conditions, Cut};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

const PROFILES: [Profile; 4] = [Profile::LAN, Profile::WIFI, Profile::DELAY_2S, Profile::DEEP];
/// Payload lengths of the datagrams of all profiles and shortened paths, about.
const LENGTHS: [usize; 7] = [1_200, 1_000, 800, 600, 500, 400, 150];
/// Datagrams at one instant that only a defect sends.
const INSTANT_MAX: usize = 2_000;

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        usize::try_from(self.next() % limit.max(1) as u64).unwrap_or_default()
    }

    fn percent(&mut self, chance: usize) -> bool {
        self.below(100) < chance
    }

    /// A time up to `most`.
    fn time(&mut self, most: Duration) -> Duration {
        most * u32::try_from(self.below(10_001)).unwrap_or_default() / 10_000
    }

    fn item(&mut self, sizes: usize, length_max: usize) -> Vec<u8> {
        let length = match (sizes, self.below(10)) {
            (0, _) | (_, 0..=3) => 1 + self.below(60),
            (_, 4..=6) => {
                let length = LENGTHS[self.below(LENGTHS.len())];
                (length + 10).saturating_sub(self.below(130))
            }
            (1, _) => 1 + self.below(1_500),
            (2, _) => 1 + self.below(4_000),
            _ => 1 + self.below(60_000),
        };
        let length = length.clamp(1, length_max);
        if self.percent(50) {
            return (0..length).map(|_| self.next().to_be_bytes()[0]).collect();
        }
        let mut text = Vec::new();
        let round = self.below(7);
        while text.len() < length {
            let line = format!("reading {} of round {round}: {}\n", text.len(), self.below(20));
            text.extend_from_slice(line.as_bytes());
        }
        text.truncate(length);
        text
    }
}

#[derive(Default)]
struct Journal {
    items: BTreeMap<StreamId, Vec<Vec<u8>>>,
    random: u64,
    /// Percentage of reads that fail.
    fails: u64,
}

impl Journal {
    fn bytes(&self, stream: StreamId, first: u64, count: u64) -> Vec<u8> {
        let first = usize::try_from(first - 1).expect("few");
        let count = usize::try_from(count).expect("few");
        self.items[&stream][first..first + count].concat()
    }
}

impl RunSource for Journal {
    fn events(
        &mut self,
        stream: StreamId,
        first: u64,
        last: u64,
        max: usize,
    ) -> Option<EventBlock> {
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        if self.random >> 33 < (self.fails << 31) / 100 {
            return None;
        }
        assert!(first <= last, "no events wanted: {first} to {last}");
        let (mut items, mut count) = (self.bytes(stream, first, 1), 1);
        while first + count <= last {
            let next = self.bytes(stream, first + count, 1);
            if items.len() + next.len() > max {
                break;
            }
            items.extend_from_slice(&next);
            count += 1;
        }
        Some(EventBlock {
            first_sequence: first,
            count,
            time_before: first * 1_000_000,
            bytes: items,
        })
    }

    fn snapshot(&mut self, stream: StreamId) -> Option<(u64, Vec<u8>)> {
        let head = self.items[&stream].len() as u64;
        (stream.0 % 4 == 1 && head > 0).then(|| (head, format!("state of {head}").repeat(9).into()))
    }
}

/// A stream with the times of its events.
struct Stream {
    id: StreamId,
    rank: Rank,
    planned: Vec<(Duration, Vec<u8>)>,
    is_live: bool,
}

struct World {
    random: Random,
    profile: Profile,
    now: Duration,
    robot: RobotSession,
    robot_from: Duration,
    station: StationSession,
    station_from: Duration,
    starts: (u32, u32),
    streams: Vec<Stream>,
    journal: Journal,
    down: Carrier,
    up: Carrier,
    carries: usize,
    /// Events at the station in this start.
    here: BTreeMap<StreamId, RangeSet>,
    calls: u64,
}

fn way(profile: &Profile, is_down: bool, random: &mut Random, delay: Duration) -> Conditions {
    let rate = if is_down { profile.down_bits_per_s } else { profile.up_bits_per_s };
    Conditions {
        delay,
        bits_per_s: rate,
        lost: if random.percent(30) { 0 } else { random.below(41) },
        doubled: random.below(15),
        late: random.below(15),
        late_max: random.time(delay / 2 + profile.gather * 3),
        queue_max: Duration::from_secs(20),
        flipped: 0,
        ..Conditions::delay_2s(rate)
    }
}

const KEY: [u8; 32] = [7; 32];

fn robot_of(profile: &Profile, generation: u32, heard: Option<Horizon>) -> RobotSession {
    let key = PairingKey::from_bytes(KEY);
    let start = SenderStart::new(generation, 0);
    let identity = Identity { key_id: KeyId(1), key: &key, robot: "scout", start, heard };
    RobotSession::new(&identity, profile.clone())
}

fn station_of(profile: &Profile, generation: u32, heard: Option<Horizon>) -> StationSession {
    let key = PairingKey::from_bytes(KEY);
    let start = SenderStart::new(generation, 0);
    let identity = Identity { key_id: KeyId(1), key: &key, robot: "scout", start, heard };
    StationSession::new(&identity, profile.clone())
}

fn random_streams(random: &mut Random, is_deep: bool, until: Duration) -> Vec<Stream> {
    let ids = [(1, Rank::Events), (0, Rank::Description), (5, Rank::Events)];
    let files = [(2, Rank::Needed), (6, Rank::Ahead), (10, Rank::Needed), (9, Rank::Last)];
    let (length_max, bytes_all) = if is_deep { (3_750, 12_000) } else { (60_000, 250_000) };
    let mut streams = Vec::new();
    let mut left = 0;
    for (id, rank) in ids.into_iter().chain(files) {
        if id != 1 && random.percent(50) {
            continue;
        }
        left += bytes_all / 2 / (streams.len() + 1);
        let sizes = random.below(4);
        let is_live = rank == Rank::Events && random.percent(80);
        let count = 1 + random.below(if is_deep { 40 } else { 400 });
        let mean = until / u32::try_from(count).unwrap_or(1);
        let is_bursty = random.percent(50);
        let before = if random.percent(30) { count / 2 } else { 0 };
        let (mut planned, mut at) = (Vec::new(), Duration::ZERO);
        for nth in 0..count {
            let item = random.item(sizes, length_max);
            if left < item.len() {
                continue;
            }
            left -= item.len();
            at += match is_bursty {
                _ if !is_live || nth <= before => Duration::ZERO,
                false => random.time(mean * 2),
                true if random.percent(8) => random.time(mean * 20),
                true => Duration::ZERO,
            };
            planned.push((at, item));
        }
        if planned.is_empty() {
            planned.push((at, vec![1]));
        }
        streams.push(Stream { id: StreamId(id), rank, planned, is_live });
    }
    streams
}

impl World {
    fn new(seed: u64) -> (Self, Duration) {
        let mut random = Random(seed);
        let profile = PROFILES[random.below(4)].clone();
        let is_deep = profile.name == "deep";
        let delay = match random.below(4) {
            0 => profile.round_trip / 2,
            1 => profile.round_trip / 8,
            _ => random.time(profile.round_trip / 4),
        };
        let until = if is_deep {
            Duration::from_mins(30)
        } else {
            Duration::from_secs(5 + random.below(60) as u64)
        };
        let streams = random_streams(&mut random, is_deep, until);
        let down = way(&profile, true, &mut random, delay);
        let up = way(&profile, false, &mut random, delay);
        let (down, up) = (Carrier::new(down, seed ^ 1), Carrier::new(up, seed ^ 2));
        let carries = if random.percent(25) { 400 + random.below(800) } else { usize::MAX };
        let robot = robot_of(&profile, 1, None);
        let station = station_of(&profile, 1, None);
        let fails = if random.percent(20) { 5 } else { 0 };
        let journal = Journal { random: seed, fails, ..Journal::default() };
        let zero = Duration::ZERO;
        let mut world = Self {
            random,
            now: zero,
            robot,
            robot_from: zero,
            station,
            station_from: zero,
            starts: (1, 1),
            streams,
            journal,
            down,
            up,
            carries,
            here: BTreeMap::new(),
            profile,
            calls: 0,
        };
        for stream in &mut world.streams {
            let due = stream.planned.iter().take_while(|(at, _)| at.is_zero()).count();
            let items = stream.planned.drain(..due).map(|(_, item)| item).collect();
            stream.planned.reverse();
            world.journal.items.insert(stream.id, items);
        }
        world.begin_streams();
        (world, until)
    }

    fn begin_streams(&mut self) {
        for stream in &self.streams {
            let head = self.journal.items[&stream.id].len() as u64;
            self.robot.begin(stream.id, head);
            self.robot.set_rank(stream.id, stream.rank);
            if self.starts.0 > 1 && self.random.percent(50) {
                self.robot.ask_first(stream.id);
            }
            let is_over = stream.planned.is_empty() && !stream.is_live;
            self.robot.set_state(stream.id, b"state", is_over);
        }
    }

    /// A restart, or a cut that lasts some silences.
    fn fault(&mut self, kind: usize, silence: Duration) {
        let (now, end) = (self.now, self.now + self.random.time(silence * 4));
        let how = if kind == 5 { Cut::Holds } else { Cut::Drops };
        match kind {
            6 => return self.restart_robot(),
            7 => return self.restart_station(),
            _ => {}
        }
        if kind != 2 && kind != 3 {
            self.down.cut(now, end, how);
        }
        if kind > 1 {
            self.up.cut(now, end, how);
        }
    }

    fn restart_robot(&mut self) {
        self.starts.0 += 1;
        let heard = self.robot.horizon();
        self.robot = robot_of(&self.profile, self.starts.0, heard);
        self.robot_from = self.now;
        self.begin_streams();
    }

    fn restart_station(&mut self) {
        self.starts.1 += 1;
        let heard = self.station.horizon();
        self.station = station_of(&self.profile, self.starts.1, heard);
        self.station_from = self.now;
        let loses = self.random.percent(20);
        for (stream, here) in &mut self.here {
            let mut kept = here.contiguous();
            if loses {
                kept -= kept.min(self.random.below(5) as u64);
            }
            *here = RangeSet::up_to(kept);
            if kept > 0 || self.random.percent(50) {
                self.station.restore(*stream, here.clone());
            }
        }
    }

    fn append_due(&mut self) {
        for stream in &mut self.streams {
            let items = self.journal.items.get_mut(&stream.id).expect("begun");
            let head = items.len() as u64;
            let group = 1 + if self.random.percent(10) { self.random.below(6) } else { 0 };
            let mut new = Vec::new();
            while new.len() < group
                && let Some((_, item)) = stream.planned.pop_if(|(at, _)| *at <= self.now)
            {
                new.push(item);
            }
            if new.is_empty() {
                continue;
            }
            let bytes = new.concat();
            let count = new.len() as u64;
            items.extend(new);
            if self.random.percent(5) {
                self.robot.advance(stream.id, head + count);
            } else {
                let time_before = (head + 1) * 1_000_000;
                let events =
                    EventBlockRef { first_sequence: head + 1, count, time_before, bytes: &bytes };
                self.robot.append(stream.id, events);
            }
            if self.random.percent(20) {
                self.robot.set_snapshot_changed(stream.id);
            }
            if stream.planned.is_empty() {
                self.robot.set_state(stream.id, b"end", true);
            }
        }
    }

    fn robot_time(&self) -> SessionTime {
        SessionTime::after(self.now.saturating_sub(self.robot_from))
    }

    fn station_time(&self) -> SessionTime {
        SessionTime::after(self.now.saturating_sub(self.station_from))
    }

    fn next_at(&self) -> Duration {
        let planned = self.streams.iter().filter_map(|it| it.planned.last().map(|(at, _)| *at));
        let robot = self.robot.poll_timeout(self.robot_time());
        let robot = robot.map(|at| self.robot_from + at.since(SessionTime::BEGIN));
        let station = self.station.poll_timeout(self.station_time());
        let station = station.map(|at| self.station_from + at.since(SessionTime::BEGIN));
        let others = [robot, station, self.down.next(), self.up.next()];
        planned.chain(others.into_iter().flatten()).min().expect("some")
    }

    /// Lets time pass to `until`, or with `stops` until all is at the station. Returns whether it is.
    fn run(&mut self, until: Duration, stops: bool) -> bool {
        while self.now < until {
            self.now = self.next_at().clamp(self.now, until);
            let (now, streams) = (self.now, &self.streams);
            let is_due = |it: &Stream| it.planned.last().is_some_and(|(at, _)| *at <= now);
            for _ in 0..streams.iter().map(|it| it.planned.len()).sum() {
                if !self.streams.iter().any(is_due) {
                    break;
                }
                self.append_due();
            }
            let arrived = self.receive_all();
            self.transmit_robot();
            self.transmit_station();
            if stops && arrived && self.is_complete() {
                return true;
            }
        }
        self.is_complete()
    }

    /// Returns whether the station received anything.
    fn receive_all(&mut self) -> bool {
        while let Some(mut datagram) = self.up.arrive(self.now) {
            let now = self.robot_time();
            let got = self.robot.handle_datagram(now, &mut datagram, |_| {});
            assert!(!matches!(got, Err(Unusable::Broken(_))), "broken to the robot: {got:?}");
        }
        let mut arrived = false;
        while let Some(mut datagram) = self.down.arrive(self.now) {
            self.receive(&mut datagram);
            arrived = true;
        }
        arrived
    }

    /// A call without a datagram may be followed by one with a datagram of another length, but not by many without.
    fn transmit_robot(&mut self) {
        let now = self.robot_time();
        let (mut sent, mut nones) = (0, 0);
        while nones == 0 || self.robot.poll_timeout(now).is_some_and(|at| at <= now) {
            self.calls += 1;
            let datagram = self.robot.poll_transmit(now, &mut self.journal).expect("sealed");
            nones += 1;
            if let Some(datagram) = datagram {
                assert!(datagram.len() <= self.profile.down_bytes_max, "{}", datagram.len());
                (sent, nones) = (sent + 1, 0);
                if datagram.len() <= self.carries {
                    self.down.send(self.now, datagram);
                }
            }
            assert!(nones < 8, "the robot spins at {:?}", self.now);
            assert!(sent < INSTANT_MAX, "the robot sends without end at {:?}", self.now);
        }
    }

    fn transmit_station(&mut self) {
        let now = self.station_time();
        let mut sent = 0;
        while let Some(datagram) = self.station.poll_transmit(now).expect("sealed") {
            assert!(datagram.len() <= self.profile.up_bytes_max, "{}", datagram.len());
            sent += 1;
            if datagram.len() <= self.carries {
                self.up.send(self.now, datagram);
            }
            assert!(sent < INSTANT_MAX, "the station sends without end at {:?}", self.now);
        }
        let spins = self.station.poll_timeout(now).is_some_and(|at| at <= now);
        assert!(!spins, "the station spins at {:?}", self.now);
    }

    fn receive(&mut self, datagram: &mut [u8]) {
        let now = self.station_time();
        let (here, journal) = (&mut self.here, &self.journal);
        let mut touched = BTreeSet::new();
        let got = self.station.handle_datagram(now, datagram, |shown| {
            let FromRobot::Events { stream, block } = shown else { return };
            let EventBlockRef { first_sequence: first, count, time_before, bytes: items } = block;
            let range = block.sequences();
            let here = here.entry(stream).or_default();
            assert!(!here.contains(&range), "{stream:?}: {range:?} is new twice");
            assert!(items == journal.bytes(stream, first, count), "{stream:?}: bytes of {range:?}");
            assert_eq!(time_before, first * 1_000_000, "{stream:?}: time before {range:?}");
            here.insert(range);
            touched.insert(stream);
        });
        assert!(!matches!(got, Err(Unusable::Broken(_))), "broken to the station: {got:?}");
        for stream in touched {
            self.station.set_safe(stream, self.here[&stream].contiguous());
        }
    }

    fn is_complete(&self) -> bool {
        self.streams.iter().all(|it| it.planned.is_empty() && self.missing(it.id) == 0)
    }

    fn missing(&self, stream: StreamId) -> u64 {
        let head = self.journal.items[&stream].len() as u64;
        let here = self.here.get(&stream).map_or(0, RangeSet::count);
        head - here
    }
}

/// Runs the world of a seed.
fn simulate(seed: u64) {
    let (mut world, until) = World::new(seed);
    let mut faults: Vec<_> = (0..world.random.below(5))
        .map(|_| (world.random.time(until), world.random.below(8)))
        .collect();
    faults.sort_unstable();
    let silence = world.profile.silence();
    for (at, kind) in faults {
        world.run(at, false);
        world.fault(kind, silence);
    }
    world.run(until + silence * 4, false);
    // A path that drops long datagrams is noticed only by many of them.
    world.carries = usize::MAX;
    for way in [&mut world.down, &mut world.up] {
        let whole = Conditions { lost: 0, ..way.conditions().clone() };
        way.set_conditions(whole);
    }
    let bytes: usize = world.journal.items.values().flatten().map(|item| item.len() + 60).sum();
    let once = Duration::from_secs(bytes as u64 * 8) / to_u32(world.profile.down_bits_per_s);
    let round_trip = world.down.conditions().delay * 2;
    let most = once * 12 + round_trip * 20 + silence * 10 + Duration::from_secs(100);
    assert!(world.run(world.now + most, true), "seed {seed} at {:?}", world.now);
    let (calls, sent) = (world.calls, world.down.bytes);
    world.run(world.now + world.profile.status_every * 200 + round_trip * 3, false);
    let (calls, sent) = (world.calls - calls, world.down.bytes - sent);
    assert!(calls < 20_000, "seed {seed}: {calls} calls after all is there");
    assert!(sent < bytes as u64 * 6 + 250_000, "seed {seed}: {sent} bytes after all is there");
}

fn to_u32(number: u64) -> u32 {
    u32::try_from(number).expect("small")
}

#[test]
fn every_event_arrives_once_with_its_bytes_and_no_side_spins() {
    (1..25).for_each(simulate);
}

/// Long events on a link whose round trip exceeds the time of several of them. Returns the bytes sent for each of theirs, in percent.
fn long_events(profile: &Profile, length: usize, count: usize, way: &Conditions) -> u64 {
    let mut world = World::new(0).0;
    world.profile = profile.clone();
    world.robot = robot_of(profile, 1, None);
    world.station = station_of(profile, 1, None);
    let up = Conditions { lost: 0, bits_per_s: profile.up_bits_per_s, ..way.clone() };
    (world.down, world.up) = (Carrier::new(way.clone(), 1), Carrier::new(up, 2));
    world.carries = usize::MAX;
    let mut noise = || (0..length).map(|_| world.random.next().to_be_bytes()[0]).collect();
    let items = (0..count).map(|_| noise()).collect();
    world.journal = Journal::default();
    world.journal.items.insert(StreamId(1), items);
    let (id, rank, planned, is_live) = (StreamId(1), Rank::Events, Vec::new(), false);
    world.streams = vec![Stream { id, rank, planned, is_live }];
    world.begin_streams();
    let done = world.run(Duration::from_mins(3), true);
    assert!(done, "{}: {} missing", profile.name, world.missing(StreamId(1)));
    world.down.bytes * 100 / (length * count) as u64
}

/// Parts that arrived are kept until the others are sent again, although many events are begun meanwhile.
#[test]
fn many_long_events_over_a_bad_link_cost_little_more_than_their_losses() {
    for (profile, length, count, delay) in
        [(Profile::WIFI, 25_000, 40, 300), (Profile::LAN, 60_000, 30, 50)]
    {
        let delay = Duration::from_millis(delay);
        let way = Conditions::delay_2s(profile.down_bits_per_s);
        let way = Conditions { delay, lost: 20, doubled: 0, late: 0, ..way };
        let percent = long_events(&profile, length, count, &way);
        assert!(percent <= 400, "{}: {percent} %", profile.name);
    }
}
