//! Whatever the other side of a link sends, with the key or without: it is used or refused, and the answers keep to the profile.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_link::{
    Direction, EventBlock, For, Identity, KeyId, PairingKey, Profile, RangeSet, RobotSession,
    RunSource, Sealer, SenderStart, SessionTime, StationSession, StreamId, ValueId, ValueName,
};
use std::time::Duration;

struct Journal;

impl RunSource for Journal {
    fn events(&mut self, _: StreamId, first: u64, _: u64, _: usize) -> Option<EventBlock> {
        Some(EventBlock {
            first_sequence: first,
            count: 1,
            time_before: first,
            bytes: first.to_le_bytes().to_vec(),
        })
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        Some((1, vec![5; 3_000]))
    }

    fn value_length(&mut self, _: &ValueName) -> Option<u64> {
        Some(20_000)
    }

    fn value_bytes(&mut self, _: &ValueName, offset: u64, bytes_max: usize) -> Option<Vec<u8>> {
        let left = usize::try_from(20_000_u64.checked_sub(offset)?).ok()?;
        Some(vec![9; bytes_max.min(left)])
    }
}

// Datagrams, each with a byte that says what it is, and its length in fives before it.
fuzz_target!(|bytes: &[u8]| {
    let (id, key, robot, profile) =
        (KeyId(1), PairingKey::from_bytes([7; 32]), "scout", Profile::DELAY_2S);
    let identity =
        Identity { key_id: id, key: &key, robot, start: SenderStart::new(1, 0), heard: None };
    let mut robot_side = RobotSession::new(&identity, profile.clone());
    robot_side.begin(StreamId(1), 100);
    let mut station = StationSession::new(&identity, profile.clone());
    station.watch(StreamId(1), 1, b"the arm".to_vec()).expect("a short list");
    let value = ValueName { stream: StreamId(1), number: 1, id: ValueId([4; 16]) };
    station.fetch(value, 20_000, RangeSet::default(), 40_000);
    let sealer = |direction| Sealer::new(id, &key, robot, direction, SenderStart::new(2, 0));
    let (mut down, mut up) = (sealer(Direction::Down), sealer(Direction::Up));
    let (mut now, mut rest) = (SessionTime::BEGIN, bytes);
    while let [how, length, after @ ..] = rest {
        let (payload, after) = after.split_at((usize::from(*length) * 5).min(after.len()));
        (now, rest) = (now + Duration::from_millis(100), after);
        let (is_down, is_sealed) = (how & 1 == 0, how & 2 == 0);
        let mut datagram = Vec::new();
        if is_sealed {
            let sealer = if is_down { &mut down } else { &mut up };
            sealer.seal(For::Anyone, payload, &mut datagram).expect("a number");
        } else {
            datagram.extend_from_slice(payload);
        }
        let used = match is_down {
            true => station.handle_datagram(now, &mut datagram, |shown| drop(shown)),
            false => robot_side.handle_datagram(now, &mut datagram, drop),
        };
        assert!(is_sealed || used.is_err(), "a datagram that nobody sealed was opened");
        while let Some(subscription) = robot_side.take_subscription() {
            robot_side.set_subscription(subscription.stream, subscription.number);
        }
        while let Some(datagram) = robot_side.poll_transmit(now, &mut Journal).expect("a number") {
            assert!(datagram.len() <= profile.down_bytes_max);
        }
        while let Some(datagram) = station.poll_transmit(now).expect("a number") {
            assert!(datagram.len() <= profile.up_bytes_max);
        }
    }
});
