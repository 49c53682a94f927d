//! What is in the robot's datagrams, and what comes first.

use super::{Rank, RobotSession, RunSource};
use crate::endpoint::Identity;
use crate::frame::{EventHash, StreamId};
use crate::profile::{Compression, Profile};
use crate::seal::{KeyId, PairingKey, SenderStart};
use crate::session_time::SessionTime;
use crate::station::{FromRobot, StationSession};
use expect_test::expect;
use rafcon_events::{EventBlock, EventBlockRef};
use std::time::Duration;

const MACHINES: StreamId = StreamId(1);
const EVENTS: StreamId = StreamId(5);

/// Much is to be known of a run besides its present state.
struct LongHistory;

impl RunSource for LongHistory {
    fn events(&mut self, _: StreamId, first: u64, _: u64, _: usize) -> Option<EventBlock> {
        Some(EventBlock { first_sequence: first, count: 1, time_before: 0, bytes: vec![7; 400] })
    }

    fn snapshot(&mut self, stream: StreamId) -> Option<(u64, Vec<u8>)> {
        (stream == EVENTS).then(|| (1_000, b"how it stands".to_vec()))
    }
}

#[test]
fn after_a_start_the_present_state_comes_before_any_history() {
    let key = PairingKey::from_bytes([7; 32]);
    let (key_id, start) = (KeyId(1), SenderStart::new(1, 0));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    let mut robot = RobotSession::new(&identity, Profile::DELAY_2S);
    let mut station = StationSession::new(&identity, Profile::DELAY_2S);
    robot.begin(MACHINES, 1_000);
    robot.begin(EVENTS, 1_000);
    let (mut now, mut datagrams, mut is_shown) = (SessionTime::BEGIN, 0, false);
    while !is_shown {
        now += Duration::from_millis(1);
        while let Some(mut datagram) = robot.poll_transmit(now, &mut LongHistory).expect("room") {
            datagrams += 1;
            let show = |shown: FromRobot<'_>| {
                is_shown |= matches!(shown, FromRobot::Snapshot { sequence: 1_000, .. });
            };
            station.handle_datagram(now, &mut datagram, show).expect("a datagram");
        }
    }
    assert_eq!(datagrams, 1);
}

/// Number of parts of machines in what the station received.
fn machine_parts(shown: &FromRobot<'_>) -> u64 {
    if let FromRobot::Events { stream: MACHINES, block } = shown { block.count } else { 0 }
}

/// The robot knows that the station has received the description; it cannot learn that the station has lost it.
#[test]
fn a_station_that_lost_a_description_has_it_again_without_an_up_link() {
    let key = PairingKey::from_bytes([7; 32]);
    let (key_id, start) = (KeyId(1), SenderStart::new(1, 0));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    let mut robot = RobotSession::new(&identity, Profile::DELAY_2S);
    let mut station = StationSession::new(&identity, Profile::DELAY_2S);
    robot.begin(EVENTS, 1_000);
    robot.begin(MACHINES, 3);
    robot.set_rank(MACHINES, Rank::Description);
    let mut now = SessionTime::BEGIN;
    let mut received = |robot: &mut RobotSession, station: &mut StationSession, ms: u64| {
        let mut received = 0;
        for _ in 0..ms {
            now += Duration::from_millis(1);
            while let Some(mut datagram) = robot.poll_transmit(now, &mut LongHistory).expect("room")
            {
                let show = |shown: FromRobot<'_>| received += machine_parts(&shown);
                // A new station rejects datagrams with a short header.
                let _rejected = station.handle_datagram(now, &mut datagram, show);
            }
        }
        (received, now)
    };
    let (_, now) = received(&mut robot, &mut station, 1_000);
    let mut report = station.poll_transmit(now).expect("a number").expect("a report");
    robot.handle_datagram(now, &mut report, |_| {}).expect("a report");
    assert_eq!(robot.progress(MACHINES), Some((3, 0)));
    let mut station = StationSession::new(&identity, Profile::DELAY_2S);
    assert_eq!(received(&mut robot, &mut station, 20_000).0, 3);
}

const RUN: StreamId = StreamId(1);

/// A robot whose run has no snapshot, and nothing to read again.
struct NoJournal;

impl RunSource for NoJournal {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBlock> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

#[test]
fn no_datagram_is_longer_than_the_profile_says() {
    let key = PairingKey::from_bytes([7; 32]);
    let (key_id, start) = (KeyId(1), SenderStart::new(u32::MAX, 0));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    let mut profile = Profile::LAN;
    (profile.down_bytes_max, profile.compression) = (300, Compression::Nothing);
    let now = SessionTime::after(Duration::from_hours(200));
    for length in 0..260 {
        let mut station = StationSession::new(&identity, profile.clone());
        let mut robot = RobotSession::new(&identity, profile.clone());
        robot.begin(RUN, 0);
        let mut first =
            robot.poll_transmit(now, &mut NoJournal).expect("a number").expect("a status");
        station.handle_datagram(now, &mut first, |_| {}).expect("a status");
        let mut report = station.poll_transmit(now).expect("a number").expect("a report");
        robot.handle_datagram(now, &mut report, |_| {}).expect("a report");
        let now = now + Duration::from_secs(1);
        robot.set_calendar(now, u64::MAX);
        let items = vec![9; length];
        robot.append(
            RUN,
            EventBlockRef { first_sequence: 1, count: 1, time_before: 1 << 50, bytes: &items },
        );
        robot.set_state(RUN, &vec![b's'; 260 - length], false);
        while let Some(datagram) = robot.poll_transmit(now, &mut NoJournal).expect("a number") {
            assert!(datagram.len() <= 300, "{} bytes with {length} of items", datagram.len());
        }
    }
}

/// The items of the events from this one to that one.
fn items(first: u64, last: u64) -> Vec<u8> {
    (first..=last).flat_map(|event| format!("event {event:06} of a state").into_bytes()).collect()
}

/// Events that are alike, so that coding them pays.
struct Journal;

impl RunSource for Journal {
    fn events(&mut self, _: StreamId, first: u64, last: u64, max: usize) -> Option<EventBlock> {
        let fit = (max / items(first, first).len()).max(1) as u64;
        let last = last.min(first + fit - 1);
        let (count, items) = (last - first + 1, items(first, last));
        Some(EventBlock { first_sequence: first, count, time_before: 0, bytes: items })
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

#[test]
fn what_was_coded_for_a_station_that_started_again_is_sent_again_at_once() {
    let key = PairingKey::from_bytes([7; 32]);
    let identity = |start| Identity {
        key_id: KeyId(1),
        key: &key,
        robot: "scout",
        start: SenderStart::new(start, 0),
        heard: None,
    };
    let mut robot = RobotSession::new(&identity(1), Profile::DELAY_2S);
    let mut station = StationSession::new(&identity(1), Profile::DELAY_2S);
    robot.begin(RUN, 2_000);
    let mut now = SessionTime::BEGIN;
    // A step of both; what the robot hears is what the station says, or nothing.
    let go_on =
        |robot: &mut RobotSession, station: &mut StationSession, is_heard, now: SessionTime| {
            while let Some(mut datagram) = robot.poll_transmit(now, &mut Journal).expect("room") {
                // Without the start of the robot, which comes with each status, a short header says nothing.
                let _unreadable = station.handle_datagram(now, &mut datagram, |_| {});
            }
            while is_heard && let Some(mut report) = station.poll_transmit(now).expect("room") {
                robot.handle_datagram(now, &mut report, |_| {}).expect("a report");
            }
        };
    for _ in 0..2_000 {
        now += Duration::from_millis(10);
        go_on(&mut robot, &mut station, true, now);
    }
    assert_eq!(robot.progress(RUN), Some((2_000, 0)));

    let events = station.received(RUN).expect("a run");
    let mut restarted = StationSession::new(&identity(2), Profile::DELAY_2S);
    restarted.restore(RUN, events.into_owned());
    let mut on_its_way = restarted.poll_transmit(now).expect("room").expect("a report");
    let append = |robot: &mut RobotSession, event| {
        let items = items(event, event);
        robot.append(
            RUN,
            EventBlockRef { first_sequence: event, count: 1, time_before: 0, bytes: &items },
        );
    };
    (2_001..=2_020).for_each(|event| append(&mut robot, event));
    for _ in 0..200 {
        now += Duration::from_millis(10);
        go_on(&mut robot, &mut restarted, false, now);
    }
    let received = |station: &StationSession| station.progress(RUN).map(|it| it.contiguous);
    assert_eq!(received(&restarted), Some(2_000), "without the context, nothing can be read");

    robot.handle_datagram(now, &mut on_its_way, |_| {}).expect("a report");
    now += Duration::from_millis(500);
    go_on(&mut robot, &mut restarted, false, now);
    assert_eq!(received(&restarted), Some(2_020));
}

#[test]
fn a_report_that_waited_in_a_cut_is_no_sign_that_the_station_knows_a_context() {
    let key = PairingKey::from_bytes([7; 32]);
    let (key_id, start) = (KeyId(1), SenderStart::new(1, 0));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    let mut robot = RobotSession::new(&identity, Profile::DELAY_2S);
    let mut station = StationSession::new(&identity, Profile::DELAY_2S);
    robot.begin(RUN, 2_000);
    let (mut now, mut late) = (SessionTime::BEGIN, None);
    for step in 0..2_000 {
        now += Duration::from_millis(10);
        while let Some(mut datagram) = robot.poll_transmit(now, &mut Journal).expect("room") {
            station.handle_datagram(now, &mut datagram, |_| {}).expect("a datagram");
        }
        while let Some(mut report) = station.poll_transmit(now).expect("room") {
            if step > 1_500 {
                late = Some(report);
            } else {
                robot.handle_datagram(now, &mut report, |_| {}).expect("a report");
            }
        }
    }
    now += Duration::from_mins(12);
    robot.handle_datagram(now, &mut late.expect("a report"), |_| {}).expect("a report");
    robot.advance(RUN, 2_100);
    let mut restarted = StationSession::new(
        &Identity { start: SenderStart::new(2, 0), heard: station.horizon(), ..identity },
        Profile::DELAY_2S,
    );
    let events = station.received(RUN).expect("a run");
    restarted.restore(RUN, events.into_owned());
    for _ in 0..100 {
        now += Duration::from_millis(10);
        while let Some(mut datagram) = robot.poll_transmit(now, &mut Journal).expect("room") {
            restarted.handle_datagram(now, &mut datagram, |_| {}).expect("a datagram");
        }
    }
    assert_eq!(restarted.progress(RUN).map(|it| it.contiguous), Some(2_100));
}

/// A run of which there is a snapshot like those of the servers.
struct Standing(u64);

impl Standing {
    fn bytes(&self) -> Vec<u8> {
        let state = |depth: u64| {
            let (id, since) = (depth * 7_919 % 977, depth * 1_013);
            format!(
                r#"{{"path":"ROOT01/EXPLORE/SECTOR{id:03}","name":"Sector {id}","phase":"running","since_ms":{since},"held":[]}}"#
            )
        };
        let active: Vec<String> = (0..20).map(|depth| state(depth + self.0 / 10)).collect();
        format!(r#"{{"status":"running","active":[{}],"sequence":{}}}"#, active.join(","), self.0)
            .into_bytes()
    }
}

impl RunSource for Standing {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBlock> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        Some((self.0, self.bytes()))
    }
}

/// Both sides for 20 s in which the snapshot changes each 100 ms, and the way takes a second. The station begins again after ten.
/// Answers the bytes of snapshots in each of four parts of the time, and how many arrived.
fn twenty_seconds(profile: &Profile) -> ([u64; 4], u32) {
    let key = PairingKey::from_bytes([7; 32]);
    let identity = |start| Identity {
        key_id: KeyId(1),
        key: &key,
        robot: "scout",
        start: SenderStart::new(start, 0),
        heard: None,
    };
    let mut robot = RobotSession::new(&identity(1), profile.clone());
    let mut station = StationSession::new(&identity(1), profile.clone());
    robot.begin(RUN, 0);
    let (mut down, mut up) = (Vec::new(), Vec::new());
    let (mut bytes, mut shown, delay) = ([0; 4], 0, Duration::from_secs(1));
    for step in 1..=2_000_u64 {
        let now = SessionTime::from_millis(step * 10);
        let mut source = Standing(step / 10 + 1);
        if step % 10 == 0 {
            robot.set_snapshot_changed(RUN);
        }
        if step == 1_000 {
            station = StationSession::new(&identity(2), profile.clone());
        }
        while let Some(datagram) = robot.poll_transmit(now, &mut source).expect("room") {
            down.push((now + delay, datagram));
        }
        for (_, mut datagram) in down.extract_if(.., |(at, _)| *at <= now) {
            let show = |from: FromRobot<'_>| {
                if let FromRobot::Snapshot { sequence, bytes, .. } = from {
                    assert_eq!(bytes, Standing(sequence).bytes());
                    shown += 1;
                }
            };
            // Without the start of the robot, which comes with each status, a short header says nothing.
            let _unreadable = station.handle_datagram(now, &mut datagram, show);
        }
        while let Some(report) = station.poll_transmit(now).expect("room") {
            up.push((now + delay, report));
        }
        for (_, mut report) in up.extract_if(.., |(at, _)| *at <= now) {
            robot.handle_datagram(now, &mut report, |_| {}).expect("a report");
        }
        let sent = robot.traffic().0.by_kind.get("snapshots").copied().unwrap_or_default();
        let part = usize::try_from((step - 1) / 500).expect("four parts");
        bytes[part] = sent - bytes[..part].iter().sum::<u64>();
    }
    (bytes, shown)
}

#[test]
fn a_snapshot_is_coded_from_one_that_the_station_has() {
    let plain = Profile { compression: Compression::Nothing, ..Profile::DELAY_2S };
    let all = [plain, Profile::DELAY_2S].map(|profile| format!("{:?}", twenty_seconds(&profile)));
    expect![[r"
        ([4478, 1772, 1776, 1764], 26)
        ([3899, 292, 1189, 307], 24)"]]
    .assert_eq(&all.join("\n"));
}

const NEEDED: StreamId = StreamId(6);
const AHEAD: StreamId = StreamId(2);

/// A robot that has begun to send a run, what the run needs, and what may be needed some day: the one that is first by its number is the
/// least urgent.
fn with_ranks(key: &PairingKey) -> RobotSession {
    let (key_id, start) = (KeyId(1), SenderStart::new(1, 0));
    let identity = Identity { key_id, key, robot: "scout", start, heard: None };
    let mut robot = RobotSession::new(&identity, Profile::DELAY_2S);
    for (stream, rank) in [(RUN, Rank::Events), (NEEDED, Rank::Needed), (AHEAD, Rank::Ahead)] {
        robot.begin(stream, 40);
        robot.set_rank(stream, rank);
    }
    robot
}

/// The streams of the events that a station receives, until `is_enough`; it answers if `is_heard`.
fn order(
    mut robot: RobotSession,
    key: &PairingKey,
    is_heard: bool,
    is_enough: impl Fn(&[StreamId], SessionTime) -> bool,
) -> Vec<StreamId> {
    let (key_id, start) = (KeyId(1), SenderStart::new(1, 0));
    let identity = Identity { key_id, key, robot: "scout", start, heard: None };
    let mut station = StationSession::new(&identity, Profile::DELAY_2S);
    let (mut now, mut order) = (SessionTime::BEGIN, Vec::new());
    while !is_enough(&order, now) {
        if let Some(mut datagram) = robot.poll_transmit(now, &mut LongHistory).unwrap() {
            let note = |shown: FromRobot<'_>| {
                if let FromRobot::Events { stream, .. } = shown {
                    order.push(stream);
                }
            };
            station.handle_datagram(now, &mut datagram, note).unwrap();
        }
        if let Some(mut answer) = station.poll_transmit(now).unwrap().filter(|_| is_heard) {
            robot.handle_datagram(now, &mut answer, |_| {}).unwrap();
        }
        now += Duration::from_millis(1);
    }
    order
}

#[test]
fn what_may_be_needed_some_day_waits_for_everything_else() {
    let key = PairingKey::from_bytes([7; 32]);
    let all = |order: &[StreamId], _| order.len() == 120;
    let heard = order(with_ranks(&key), &key, true, all);
    let mut wanted = heard.clone();
    wanted.sort_by_key(|stream| [RUN, NEEDED, AHEAD].iter().position(|it| it == stream));
    assert_eq!(heard, wanted);
    // Nobody is heard: rounds of the history leave a part of the rate.
    let unheard = order(with_ranks(&key), &key, false, all);
    let last = |wanted| unheard.iter().rposition(|stream| *stream == wanted);
    assert!(last(RUN) < last(NEEDED) && last(NEEDED) < last(AHEAD), "{unheard:?}");
}

#[test]
fn no_run_waits_for_the_history_of_another() {
    const RUNS: u32 = 4;
    let key = PairingKey::from_bytes([7; 32]);
    let mut robot = with_ranks(&key);
    for stream in [RUN, NEEDED, AHEAD] {
        robot.end(stream);
    }
    for run in 0..RUNS {
        let (events, about) = (StreamId(run * 4 + 1), StreamId(run * 4));
        robot.begin(events, 1_000);
        robot.begin(about, 2);
        robot.set_rank(about, Rank::Description);
    }
    let order = order(robot, &key, true, |order, _| order.len() >= 200);
    let is_about = |stream: &&StreamId| stream.0.is_multiple_of(4);
    let last_about = order.iter().rposition(|stream| is_about(&stream));
    assert!(last_about < Some(4 * RUNS as usize), "{order:?}");
    let counts = (0..RUNS)
        .map(|run| order.iter().filter(|stream| **stream == StreamId(run * 4 + 1)).count());
    let (least, most) = (counts.clone().min(), counts.max());
    assert!(least >= most.map(|most| most / 2), "{least:?} to {most:?}");
}

#[test]
fn a_station_is_asked_for_what_it_may_have_from_before() {
    let key = PairingKey::from_bytes([7; 32]);
    let mut robot = with_ranks(&key);
    robot.end(RUN);
    robot.end(NEEDED);
    robot.ask_first(AHEAD);
    let silence = Profile::DELAY_2S.silence();
    assert_eq!(order(robot, &key, false, |_, now| now >= SessionTime::after(silence)), []);
    let mut robot = with_ranks(&key);
    robot.ask_first(AHEAD);
    let all = |order: &[StreamId], _| order.len() == 120;
    assert_eq!(order(robot, &key, true, all).len(), 120);
}

/// The hash of the events of `RUN` that a datagram tells.
fn told_chain(station: &mut StationSession, now: SessionTime, datagram: &mut [u8]) -> Option<u64> {
    let mut told = None;
    let show = |shown: FromRobot<'_>| {
        if let FromRobot::Status { stream: RUN, chain, .. } = shown {
            told = chain.map(|chain| chain.hash);
        }
    };
    station.handle_datagram(now, datagram, show).expect("a datagram");
    told
}

#[test]
fn a_run_is_complete_once_the_hash_of_its_events_was_heard() {
    let key = PairingKey::from_bytes([7; 32]);
    let (key_id, start) = (KeyId(1), SenderStart::new(1, 0));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    let mut robot = RobotSession::new(&identity, Profile::LAN);
    let mut station = StationSession::new(&identity, Profile::LAN);
    robot.begin(RUN, 0);
    robot.append(
        RUN,
        EventBlockRef { first_sequence: 1, count: 1, time_before: 0, bytes: b"an event" },
    );
    robot.set_state(RUN, b"ended", true);
    let (mut now, mut told, mut sent) = (SessionTime::BEGIN, Vec::new(), 0);
    let mut wait_until_complete = |robot: &mut RobotSession| {
        while !robot.is_complete(RUN) && now < SessionTime::after(Duration::from_mins(1)) {
            now += Duration::from_millis(10);
            while let Some(mut datagram) =
                robot.poll_transmit(now, &mut NoJournal).expect("a number")
            {
                sent += 1;
                // The first one after the hash was set is lost.
                if sent != 2 {
                    told.extend(told_chain(&mut station, now, &mut datagram));
                }
            }
            while let Some(mut report) = station.poll_transmit(now).expect("a number") {
                robot.handle_datagram(now, &mut report, |_| {}).expect("a report");
            }
        }
        told.clone()
    };
    assert_eq!(wait_until_complete(&mut robot), [0; 0]);
    robot.set_chain(RUN, EventHash { last: 1, hash: 9 });
    assert!(!robot.is_complete(RUN));
    assert_eq!(wait_until_complete(&mut robot), [9]);
    assert!(robot.is_complete(RUN));
}
