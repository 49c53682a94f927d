//! A robot's session at each of its bounds, and after it.

use super::outgoing::next_part;
use super::scheduled_commands::{SCHEDULED_MAX, TOO_MANY};
use super::tail::Tail;
use super::{COMMANDS_MAX, RobotSession, RunSource, SUBSCRIPTIONS_MAX, URGENT_MAX};
use crate::bytes::write_number;
use crate::coding::ContextId;
use crate::endpoint::Identity;
use crate::frame::{
    CommandId, CommandState, Frame, Packing, StreamId, Terms, ValueFrame, ValueId, ValuePart,
    WatchPart, block_bytes_max,
};
use crate::profile::{Compression, Profile};
use crate::seal::{KeyId, OVERHEAD, PairingKey, SenderStart};
use crate::session_time::SessionTime;
use crate::station::StationSession;
use rafcon_events::{EventBlock, EventBlockRef};
use std::time::Duration;

const RUN: StreamId = StreamId(1);
const SECOND: SessionTime = SessionTime::from_millis(1_000);

fn identity(key: &PairingKey) -> Identity<'_> {
    let start = SenderStart::new(1, 0);
    Identity { key_id: KeyId(1), key, robot: "scout", start, heard: None }
}

fn session() -> RobotSession {
    RobotSession::new(&identity(&PairingKey::from_bytes([7; 32])), Profile::LAN)
}

fn id(number: u64) -> CommandId {
    CommandId(u128::from(number).to_be_bytes())
}

/// Takes a command that may be carried out from this second on; answers whether it is passed on at once.
fn takes(robot: &mut RobotSession, number: u64, seconds: u64) -> bool {
    let robot_start = robot.end.start.generation;
    let (not_after_ms, not_before_ms) = (1_000_000, seconds * 1_000);
    let terms = Terms { robot_start, not_after_ms, not_before_ms, epoch: 0 };
    robot.take_command(SECOND, id(number), terms, vec![1]).is_some()
}

/// The state of a command and why, if the session knows it.
fn state(robot: &RobotSession, number: u64) -> Option<(CommandState, &str)> {
    let sent = robot.states.get(&id(number))?;
    Some((sent.state, std::str::from_utf8(&sent.reason).unwrap()))
}

#[test]
fn commands_for_later_are_kept_up_to_the_bound_and_again_once_a_time_has_come() {
    let mut robot = session();
    let most = SCHEDULED_MAX as u64;
    for number in 0..=most {
        assert!(!takes(&mut robot, number, 10 + number));
    }
    assert!(TOO_MANY.contains(&SCHEDULED_MAX.to_string()));
    assert_eq!(state(&robot, most - 1), Some((CommandState::Received, "")));
    assert_eq!(state(&robot, most), Some((CommandState::Refused, TOO_MANY)));
    let due = std::iter::from_fn(|| robot.poll_command(SessionTime::from_millis(10_000)));
    assert_eq!(due.map(|command| command.id).collect::<Vec<_>>(), [id(0)]);
    takes(&mut robot, most + 1, 10);
    assert_eq!(state(&robot, most + 1), Some((CommandState::Received, "")));
}

#[test]
fn of_more_commands_than_are_remembered_the_oldest_is_forgotten_unless_its_time_is_to_come() {
    let mut robot = session();
    takes(&mut robot, 0, 10);
    let most = COMMANDS_MAX as u64;
    let is_known = |robot: &RobotSession| [0, 1, 2, most].map(|it| state(robot, it).is_some());
    for number in 1..most {
        assert!(takes(&mut robot, number, 0));
    }
    assert_eq!(is_known(&robot), [true, true, true, false]);
    assert!(takes(&mut robot, most, 0));
    assert_eq!(is_known(&robot), [true, false, true, true]);
    for number in most + 1..10 * most {
        assert!(takes(&mut robot, number, 0));
    }
    assert_eq!((robot.states.len(), robot.ids.len()), (COMMANDS_MAX, COMMANDS_MAX));
    assert!(is_known(&robot)[0]);
}

#[test]
fn a_long_reason_of_a_refusal_is_cut_between_characters() {
    let (whole, part) = ("ä".repeat(120), "ä".repeat(119));
    for (reason, sent) in [
        (whole.clone(), whole.clone()),
        (format!("{whole}x"), whole),
        (format!("x{part}ä"), format!("x{part}")),
    ] {
        let mut robot = session();
        robot.set_command_state(SECOND, id(1), CommandState::Refused, &reason);
        assert_eq!(state(&robot, 1), Some((CommandState::Refused, sent.as_str())));
    }
}

#[test]
fn wishes_beyond_the_bound_do_not_count_and_come_again() {
    let mut robot = session();
    let most = u32::try_from(SUBSCRIPTIONS_MAX).unwrap();
    let watch = |robot: &mut RobotSession, run: u32| {
        robot.begin(StreamId(run), 0);
        let (number, length, offset) = (1, 0, 0);
        let part = WatchPart { stream: StreamId(run), number, length, offset, bytes: &[] };
        robot.take(ValueFrame::Watch(part), &mut Vec::new());
    };
    for run in 0..=most {
        watch(&mut robot, run);
    }
    let take = |robot: &mut RobotSession| {
        std::iter::from_fn(|| robot.take_subscription()).map(|it| it.stream.0).collect::<Vec<_>>()
    };
    assert_eq!(take(&mut robot), (0..most).collect::<Vec<_>>());
    for run in 0..=most {
        watch(&mut robot, run);
    }
    assert_eq!(take(&mut robot), [most]);
}

#[test]
fn the_newest_events_are_at_hand_up_to_so_many_bytes() {
    let mut tail = Tail::new(RUN);
    let mut append = |first, bytes: usize| {
        let items = vec![7; bytes];
        tail.append(EventBlockRef {
            first_sequence: first,
            count: 1,
            time_before: 0,
            bytes: &items,
        });
        tail.first_unsent()
    };
    assert_eq!(append(1, 4_000), Some(1));
    assert_eq!(append(2, 96), Some(1));
    assert_eq!(append(3, 1), Some(2));
    assert_eq!(append(4, 4_096), Some(4));
    assert_eq!(append(5, 5_000), None);
    assert_eq!(append(6, 10), Some(6));
}

/// The journal of a run whose events have so many bytes each.
struct LongEvents(usize);

impl RunSource for LongEvents {
    fn events(&mut self, _: StreamId, first: u64, _: u64, _: usize) -> Option<EventBlock> {
        Some(EventBlock { first_sequence: first, count: 1, time_before: 0, bytes: vec![7; self.0] })
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

#[test]
fn events_of_any_length_arrive_whether_they_are_at_hand_or_in_the_journal() {
    let key = PairingKey::from_bytes([7; 32]);
    let profile = Profile { compression: Compression::Nothing, ..Profile::LAN };
    let room = profile.down_bytes_max - OVERHEAD - URGENT_MAX;
    let most = block_bytes_max(room, 1, 0);
    // The second sum is more than is kept at hand.
    for (length, count, is_at_hand) in
        [(most, 1, true), (most + 1, 1, false), (most + URGENT_MAX, 1, false), (400, 30, false)]
    {
        let mut robot = RobotSession::new(&identity(&key), profile.clone());
        let mut station = StationSession::new(&identity(&key), profile.clone());
        robot.begin(RUN, 0);
        for first in 1..=count {
            let items = vec![7; length];
            robot.append(
                RUN,
                EventBlockRef { first_sequence: first, count: 1, time_before: 0, bytes: &items },
            );
        }
        assert_eq!(robot.streams[&RUN].tail_holds(1), is_at_hand, "{length} bytes");
        let mut now = SessionTime::BEGIN;
        for _ in 0..200 {
            now += Duration::from_millis(10);
            while let Some(mut datagram) =
                robot.poll_transmit(now, &mut LongEvents(length)).unwrap()
            {
                assert!(datagram.len() <= profile.down_bytes_max);
                station.handle_datagram(now, &mut datagram, |_| {}).unwrap();
            }
            while let Some(mut report) = station.poll_transmit(now).unwrap() {
                robot.handle_datagram(now, &mut report, |_| {}).unwrap();
            }
        }
        assert_eq!(robot.progress(RUN), Some((count, 0)), "{length} bytes");
    }
}

#[test]
fn parts_fill_a_datagram_and_never_more() {
    let bytes = vec![7; 100_000];
    let large = u64::MAX;
    for room in [200, 1_200, 20_000] {
        let (_, part) = next_part(&bytes, 0, room);
        let (stream, length, offset) = (StreamId(u32::MAX), u32::MAX, u32::MAX);
        let packing = Packing::Coded { context: ContextId([7; 3]), length };
        let mut written = Vec::new();
        Frame::Large {
            stream,
            first: large,
            time_before: large,
            packing,
            length,
            offset,
            bytes: part,
        }
        .write(&mut written);
        // The length of the part itself has one byte to three.
        assert!((room - 2..=room).contains(&written.len()), "{} of {room}", written.len());
    }
    for profile in [Profile::LAN, Profile::DELAY_2S] {
        let count = usize::try_from(profile.value_part_bytes()).unwrap();
        let (id, offset) = (ValueId([9; 16]), large >> 1);
        let mut written = Vec::new();
        // More than a year.
        write_number((1 << 35) - 1, &mut written);
        Frame::Value(ValueFrame::ValuePart(ValuePart { id, offset, bytes: &bytes[..count] }))
            .write(&mut written);
        let room = profile.down_bytes_max - OVERHEAD;
        assert!((room - 3..=room).contains(&written.len()), "{} of {room}", written.len());
    }
}
