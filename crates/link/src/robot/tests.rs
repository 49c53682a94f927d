//! What is in the robot's datagrams, and what comes first.

use super::{EventBuffer, RobotSession, RunSource};
use crate::endpoint::Identity;
use crate::frame::{Events, StreamId};
use crate::profile::Profile;
use crate::seal::{Generation, KeyId, PairingKey};
use crate::station::{FromRobot, StationSession};
use std::time::Duration;

const MACHINES: StreamId = StreamId(1);
const EVENTS: StreamId = StreamId(2);

/// Much is to be known of a run besides its present state.
struct LongHistory;

impl RunSource for LongHistory {
    fn events(&mut self, _: StreamId, first: u64, _: u64, _: usize) -> Option<EventBuffer> {
        Some(EventBuffer { first, count: 1, t_before: 0, items: vec![7; 400] })
    }

    fn snapshot(&mut self, stream: StreamId) -> Option<(u64, Vec<u8>)> {
        (stream == EVENTS).then(|| (1_000, b"how it stands".to_vec()))
    }
}

#[test]
fn after_a_start_the_present_state_comes_before_any_history() {
    let key = PairingKey::from_bytes([7; 32]);
    let (key_id, start) = (KeyId(1), Generation(1));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    let mut robot = RobotSession::new(&identity, Profile::DELAY_2S);
    let mut station = StationSession::new(&identity, Profile::DELAY_2S);
    robot.begin(MACHINES, 1_000);
    robot.begin(EVENTS, 1_000);
    let (mut now, mut datagrams, mut is_shown) = (Duration::ZERO, 0, false);
    while !is_shown {
        now += Duration::from_millis(1);
        while let Some(mut datagram) = robot.transmit(now, &mut LongHistory).expect("room") {
            datagrams += 1;
            let show = |shown: FromRobot<'_>| {
                is_shown |= matches!(shown, FromRobot::Snapshot { sequence: 1_000, .. });
            };
            station.receive(now, &mut datagram, show).expect("a datagram");
        }
    }
    assert_eq!(datagrams, 1);
}

const RUN: StreamId = StreamId(1);

/// A robot whose run has no snapshot, and nothing to read again.
struct NoJournal;

impl RunSource for NoJournal {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBuffer> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

#[test]
fn no_datagram_is_longer_than_the_profile_says() {
    let key = PairingKey::from_bytes([7; 32]);
    let (key_id, start) = (KeyId(1), Generation(u32::MAX));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    let mut profile = Profile::LAN;
    (profile.down_bytes_max, profile.codes) = (300, false);
    let now = Duration::from_hours(200);
    for length in 0..260 {
        let mut station = StationSession::new(&identity, profile.clone());
        let mut robot = RobotSession::new(&identity, profile.clone());
        robot.begin(RUN, 0);
        let mut first = robot.transmit(now, &mut NoJournal).expect("a number").expect("a status");
        station.receive(now, &mut first, |_| {}).expect("a status");
        let mut report = station.transmit(now).expect("a number").expect("a report");
        robot.receive(now, &mut report, |_| {}).expect("a report");
        let now = now + Duration::from_secs(1);
        robot.set_calendar(now, u64::MAX);
        let items = vec![9; length];
        robot.append(&Events { stream: RUN, first: 1, count: 1, t_before: 1 << 50, items: &items });
        robot.set_state(RUN, &vec![b's'; 260 - length], false);
        while let Some(datagram) = robot.transmit(now, &mut NoJournal).expect("a number") {
            assert!(datagram.len() <= 300, "{} bytes with {length} of items", datagram.len());
        }
    }
}
