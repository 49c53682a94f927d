//! Behaviour towards a faulty or hostile peer that has the key.

use crate::endpoint::Identity;
use crate::frame::{StreamId, ValueId, ValueName};
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::robot::{NewestValue, RobotSession, RunSource};
use crate::seal::{Direction, For, KeyId, OVERHEAD, Opener, PairingKey, Sealer, SenderStart};
use crate::session_time::SessionTime;
use crate::station::{GAPS_MAX, NewCommand, OPEN_MAX, PARTS_MAX, StationSession};
use proptest::prelude::*;
use proptest::sample::Index;
use rafcon_events::{EventBlock, EventBlockRef};
use std::sync::LazyLock;
use std::time::Duration;

const RUN: StreamId = StreamId(1);
const ID: KeyId = KeyId(1);

fn key() -> PairingKey {
    PairingKey::from_bytes([7; 32])
}

/// A journal with an event of a few bytes for each number.
struct Numbers;

fn item(number: u64) -> Vec<u8> {
    [b"entered Waypoint ".as_slice(), number.to_string().as_bytes()].concat()
}

impl RunSource for Numbers {
    fn events(&mut self, _: StreamId, first: u64, last: u64, max: usize) -> Option<EventBlock> {
        let mut buffer =
            EventBlock { first_sequence: first, count: 1, time_before: first, bytes: item(first) };
        while buffer.last_sequence() < last
            && buffer.bytes.len() + item(buffer.last_sequence() + 1).len() <= max
        {
            buffer.bytes.extend(item(buffer.last_sequence() + 1));
            buffer.count += 1;
        }
        Some(buffer)
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        Some((1, vec![5; 3_000]))
    }

    fn value_length(&mut self, _: &ValueName) -> Option<u64> {
        Some(VALUE_BYTES)
    }

    fn value_bytes(&mut self, _: &ValueName, offset: u64, bytes_max: usize) -> Option<Vec<u8>> {
        let left = VALUE_BYTES.checked_sub(offset)?;
        Some(vec![9; bytes_max.min(usize::try_from(left).unwrap_or(usize::MAX))])
    }
}

/// A large value that the station asks for.
const VALUE: ValueName = ValueName { stream: RUN, number: 1, id: ValueId([4; 16]) };
const VALUE_BYTES: u64 = 20_000;

/// The station watches values and fetches one.
fn watch(station: &mut StationSession) {
    station.watch(RUN, 1, b"the arm".to_vec()).expect("a short list");
    station.fetch(VALUE, VALUE_BYTES, RangeSet::default(), 2 * VALUE_BYTES);
}

fn sessions() -> (RobotSession, StationSession) {
    let identity = Identity {
        key_id: ID,
        key: &key(),
        robot: "scout",
        start: SenderStart::new(1, 0),
        heard: None,
    };
    let mut robot = RobotSession::new(&identity, Profile::DELAY_2S);
    robot.begin(RUN, 0);
    (robot, StationSession::new(&identity, Profile::DELAY_2S))
}

fn sealer(direction: Direction) -> Sealer {
    Sealer::new(ID, &key(), "scout", direction, SenderStart::new(2, 0))
}

/// The payloads of ten seconds of a robot and its station, in both directions.
static PAYLOADS: LazyLock<[Vec<Vec<u8>>; 2]> = LazyLock::new(|| {
    let (mut robot, mut station) = sessions();
    let openers = [Direction::Down, Direction::Up];
    let mut openers = openers.map(|direction| Opener::new(ID, &key(), "scout", direction, None));
    let mut payloads = [Vec::new(), Vec::new()];
    for step in 0..1_000_u64 {
        let now = SessionTime::from_millis(10 * step);
        if step % 10 == 0 {
            let (first, items) = (step / 10 + 1, item(step / 10 + 1));
            robot.append(
                RUN,
                EventBlockRef {
                    first_sequence: first,
                    count: 1,
                    time_before: first,
                    bytes: &items,
                },
            );
        }
        if step == 100 {
            watch(&mut station);
        }
        if step > 500 && step % 50 == 0 {
            let (priority, bytes) = (0, step.to_be_bytes().to_vec());
            robot.set_watched(RUN, 0, NewestValue { priority, sequence: step, bytes });
        }
        if step == 500 {
            let id = crate::frame::CommandId([3; 16]);
            let (valid, body) = (Duration::from_secs(3), b"hold".to_vec());
            station
                .command(now, NewCommand { id, valid, wait: None, epoch: 1, body })
                .expect("a clock");
        }
        while let Some(mut datagram) = robot.poll_transmit(now, &mut Numbers).expect("a number") {
            let opened = openers[0].open(&mut datagram.clone()).expect("ours").payload.to_vec();
            payloads[0].push(opened);
            station.handle_datagram(now, &mut datagram, |_| {}).expect("ours");
        }
        while let Some(mut datagram) = station.poll_transmit(now).expect("a number") {
            let opened = openers[1].open(&mut datagram.clone()).expect("ours").payload.to_vec();
            payloads[1].push(opened);
            robot.handle_datagram(now, &mut datagram, |_| {}).expect("ours");
        }
    }
    payloads
});

/// A payload that a side has sent, with bytes changed, left out, or put in.
fn mutated(side: usize) -> impl Strategy<Value = Vec<u8>> {
    let change = (any::<Index>(), 0..4_u8, prop::collection::vec(any::<u8>(), 0..12));
    (any::<Index>(), prop::collection::vec(change, 0..6)).prop_map(move |(which, changes)| {
        let mut payload = which.get(&PAYLOADS[side]).clone();
        for (at, how, bytes) in changes {
            let at = at.index(payload.len() + 1);
            let end = (at + bytes.len()).min(payload.len());
            match how {
                0 => payload.truncate(at),
                1 => drop(payload.splice(at..at, bytes)),
                2 => drop(payload.splice(at..end, bytes)),
                _ => drop(payload.drain(at..end)),
            }
        }
        payload.truncate(1_200);
        payload
    })
}

fn hostile(side: usize) -> impl Strategy<Value = Vec<Vec<u8>>> {
    let noise = prop::collection::vec(any::<u8>(), 0..400);
    prop::collection::vec(prop_oneof![3 => mutated(side), 1 => noise], 0..40)
}

proptest! {
    #[test]
    fn whatever_comes_is_used_or_refused(down in hostile(0), up in hostile(1)) {
        let (mut robot, mut station) = sessions();
        watch(&mut station);
        let (mut from_robot, mut from_station) = (sealer(Direction::Down), sealer(Direction::Up));
        let most = down.len().max(up.len());
        for step in 0..most {
            let now = SessionTime::from_millis(100 * step as u64);
            for (payload, sealer, is_down) in [
                (down.get(step), &mut from_robot, true),
                (up.get(step), &mut from_station, false),
            ] {
                let Some(payload) = payload else { continue };
                let mut datagram = Vec::new();
                sealer.seal(For::Anyone, payload, &mut datagram).expect("a number");
                let _used_or_refused = if is_down {
                    station.handle_datagram(now, &mut datagram, |_| {})
                } else {
                    robot.handle_datagram(now, &mut datagram, |_| {})
                };
            }
            while let Some(datagram) = robot.poll_transmit(now, &mut Numbers).expect("a number") {
                prop_assert!(datagram.len() <= Profile::DELAY_2S.down_bytes_max);
            }
            while let Some(datagram) = station.poll_transmit(now).expect("a number") {
                prop_assert!(datagram.len() <= Profile::DELAY_2S.up_bytes_max);
            }
        }
    }

    #[test]
    fn noise_that_nobody_sealed_is_refused(mut noise in prop::collection::vec(any::<u8>(), 0..1_300)) {
        let (mut robot, mut station) = sessions();
        let opened = [
            station.handle_datagram(SessionTime::BEGIN, &mut noise.clone(), |_| {}).is_ok(),
            robot.handle_datagram(SessionTime::BEGIN, &mut noise, |_| {}).is_ok(),
        ];
        prop_assert_eq!(opened, [false, false]);
    }
}

/// Each run, gap and part that a robot names costs a station memory.
#[test]
fn a_station_keeps_only_so_much_of_what_a_robot_names() {
    let (_, mut station) = sessions();
    let mut sealer = sealer(Direction::Down);
    let mut send = |frames: &mut dyn FnMut(u32, &mut Vec<u8>)| {
        for number in 0..300 {
            let mut payload = vec![0];
            while payload.len() < 1_100 {
                frames(number, &mut payload);
            }
            payload.truncate(Profile::DELAY_2S.down_bytes_max - OVERHEAD);
            let mut datagram = Vec::new();
            sealer.seal(For::Anyone, &payload, &mut datagram).expect("a number");
            let _the_last_frame_is_cut =
                station.handle_datagram(SessionTime::BEGIN, &mut datagram, |_| {});
        }
    };
    let mut next = 0;
    send(&mut |_, payload| {
        use crate::frame::Frame;
        next += 2;
        let (stream, bytes, length) = (StreamId(next), b"part".as_slice(), 1 << 20);
        let sequence = u64::from(next);
        Frame::Snapshot { stream, sequence, length, offset: 0, bytes }.write(payload);
        let first = u64::from(next) + 1;
        let block = EventBlockRef { first_sequence: first, count: 1, time_before: 0, bytes: b"" };
        Frame::Events { stream: RUN, block }.write(payload);
    });
    let (streams, gaps, parts) = station.kept();
    assert!(streams <= OPEN_MAX, "{streams} runs");
    assert!(gaps <= GAPS_MAX + OPEN_MAX, "{gaps} gaps");
    assert!(parts <= PARTS_MAX, "{parts} bytes of parts");
}

/// Each byte of a large value that comes by itself costs a station memory.
#[test]
fn a_station_notes_only_so_many_parts_of_a_large_value() {
    use crate::frame::{Frame, ValueFrame, ValuePart};
    let (_, mut station) = sessions();
    station.fetch(VALUE, 1 << 30, RangeSet::default(), 1 << 30);
    let mut sealer = sealer(Direction::Down);
    let mut offset = 0;
    for _ in 0..300 {
        let mut payload = vec![0];
        while payload.len() < 1_100 {
            let part = ValuePart { id: VALUE.id, offset, bytes: b"x" };
            Frame::Value(ValueFrame::ValuePart(part)).write(&mut payload);
            offset += 2;
        }
        payload.truncate(Profile::DELAY_2S.down_bytes_max - OVERHEAD);
        let mut datagram = Vec::new();
        sealer.seal(For::Anyone, &payload, &mut datagram).expect("a number");
        let _the_last_frame_is_cut =
            station.handle_datagram(SessionTime::BEGIN, &mut datagram, |_| {});
    }
    let progress = station.fetch_progress(VALUE.id).expect("it is asked for");
    assert_eq!(progress.here.ranges_count(), 4_096);
    assert!(offset > 3 * 4_096);
}
