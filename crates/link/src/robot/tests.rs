//! What a robot sends first.

use super::{EventBuffer, RobotSession, RunSource};
use crate::endpoint::Identity;
use crate::frame::StreamId;
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
