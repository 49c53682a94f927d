//! A robot and a station, with a path between them that a test decides about.

use super::commands::COMMANDS_MAX;
use super::{FromRobot, NewCommand, NotSent, StationSession};
use crate::endpoint::{Identity, Unusable};
use crate::frame::{COMMAND_LENGTH_MAX, CommandId, CommandState, StreamId};
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::robot::{RobotSession, RunSource, SCHEDULED_MAX};
use crate::seal::{KeyId, PairingKey, Rejected, SenderStart};
use crate::session_time::SessionTime;
use rafcon_events::EventBlock;
use std::time::Duration;

/// A robot without runs.
struct NoRuns;

impl RunSource for NoRuns {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBlock> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

pub(super) struct Pair {
    offered: Option<KeyId>,
    pub(super) now: SessionTime,
    pub(super) robot: RobotSession,
    pub(super) station: StationSession,
    pub(super) carried_out: Vec<CommandId>,
    pub(super) told: Vec<CommandState>,
}

impl Pair {
    pub(super) fn new() -> Self {
        let (robot, station) = (robot(1), station(1));
        Self {
            offered: None,
            now: SessionTime::BEGIN,
            robot,
            station,
            carried_out: Vec::new(),
            told: Vec::new(),
        }
    }

    pub(super) fn restart_robot(&mut self) {
        self.robot = robot(2);
    }

    pub(super) fn restart_station(&mut self) {
        self.station = station(2);
    }

    /// Carries only the datagrams of the robot for this time.
    pub(super) fn go_one_way(&mut self, ms: u64) {
        for _ in 0..ms {
            self.now += Duration::from_millis(1);
            while let Some(mut datagram) =
                self.robot.poll_transmit(self.now, &mut NoRuns).expect("room")
            {
                let show = |shown: FromRobot<'_>| self.told.extend(state(&shown));
                check_received(self.station.handle_datagram(self.now, &mut datagram, show));
            }
            while self.station.poll_transmit(self.now).expect("room").is_some() {}
        }
    }

    /// Carries datagrams for this time, those from the robot only if `is_heard`.
    pub(super) fn go_on(&mut self, ms: u64, is_heard: bool) {
        for _ in 0..ms {
            self.now += Duration::from_millis(1);
            while let Some(mut datagram) =
                self.robot.poll_transmit(self.now, &mut NoRuns).expect("room")
            {
                if !is_heard {
                    continue;
                }
                let (told, offered) = (&mut self.told, &mut self.offered);
                let show = |shown: FromRobot<'_>| match shown {
                    FromRobot::NewKey { id, .. } => *offered = Some(id),
                    shown => told.extend(state(&shown)),
                };
                check_received(self.station.handle_datagram(self.now, &mut datagram, show));
            }
            while let Some(mut datagram) = self.station.poll_transmit(self.now).expect("room") {
                let carry_out = |command: crate::ReceivedCommand| {
                    self.carried_out.extend((!command.is_late).then_some(command.id));
                };
                check_received(self.robot.handle_datagram(self.now, &mut datagram, carry_out));
            }
            while let Some(command) = self.robot.poll_command(self.now) {
                self.carried_out.push(command.id);
            }
        }
    }
}

/// A start of one side cannot open short headers before a full one.
fn check_received(received: Result<(), Unusable>) {
    let is_usable = matches!(received, Ok(()) | Err(Unusable::Rejected(Rejected::UnknownStart)));
    assert!(is_usable, "{received:?}");
}

/// A start of one side. Sessions count from the begin of the test.
fn robot(start: u32) -> RobotSession {
    let key = PairingKey::from_bytes([7; 32]);
    let mut robot = RobotSession::new(&identity(&key, start), Profile::LAN);
    robot.begin(StreamId(1), 0);
    robot
}

fn station(start: u32) -> StationSession {
    let key = PairingKey::from_bytes([7; 32]);
    StationSession::new(&identity(&key, start), Profile::LAN)
}

fn identity(key: &PairingKey, start: u32) -> Identity<'_> {
    let start = SenderStart::new(start, 0);
    Identity { key_id: KeyId(1), key, robot: "scout", start, heard: None }
}

fn state(shown: &FromRobot<'_>) -> Option<CommandState> {
    match shown {
        FromRobot::CommandState { state, .. } => Some(*state),
        _ => None,
    }
}

#[test]
fn the_fate_of_a_command_is_told_although_every_word_of_it_was_lost_at_first() {
    let mut pair = Pair::new();
    pair.go_on(500, true);
    let id = CommandId([3; 16]);
    let valid = Duration::from_secs(1);
    let command = NewCommand { id, valid, wait: None, epoch: 0, body: b"stop".to_vec() };
    pair.station.command(pair.now, command).expect("a clock");
    pair.go_on(100, true);
    assert_eq!(pair.told.first(), Some(&CommandState::Received));
    pair.robot.set_command_state(pair.now, id, CommandState::Done, "");
    pair.go_on(3_000, false);
    pair.go_on(500, true);
    assert_eq!(pair.told.last(), Some(&CommandState::Done));
    assert_eq!(pair.carried_out, [id]);
    assert!(!pair.station.is_open(id));
}

#[test]
fn a_command_has_at_most_so_many_bytes() {
    let mut pair = Pair::new();
    pair.go_on(500, true);
    let valid = Duration::from_hours(1);
    let mut give = |nth, length: usize| {
        let (id, body) = (CommandId([nth; 16]), vec![nth; length]);
        pair.station.command(pair.now, NewCommand { id, valid, wait: None, epoch: 0, body })
    };
    let most = COMMAND_LENGTH_MAX as usize;
    assert_eq!(give(1, 0), Err(NotSent::TooLong(0)));
    assert_eq!(give(2, most + 1), Err(NotSent::TooLong(most + 1)));
    assert_eq!(give(3, most), Ok(()));
}

#[test]
fn a_command_for_later_waits_at_the_robot_and_is_carried_out_once() {
    let mut pair = Pair::new();
    let (first, second) = (CommandId([4; 16]), CommandId([5; 16]));
    let command = |id, wait, valid| {
        let (wait, valid) = (Some(Duration::from_millis(wait)), Duration::from_millis(valid));
        NewCommand { id, valid, wait, epoch: 0, body: b"resume".to_vec() }
    };
    pair.go_on(1, true);
    assert_eq!(pair.station.command(pair.now, command(first, 10, 20)), Err(NotSent::OneWay));
    pair.go_on(500, true);
    assert_eq!(pair.station.command(pair.now, command(first, 10, 5)), Err(NotSent::Uncertain));
    pair.station.command(pair.now, command(first, 2_000, 2_100)).expect("both bounds");
    pair.station.command(pair.now, command(second, 1_000, 9_000)).expect("both bounds");
    pair.go_on(1_000, true);
    assert_eq!((pair.told.last(), pair.carried_out.len()), (Some(&CommandState::Received), 0));
    pair.go_on(900, false);
    assert_eq!(pair.carried_out, [second]);
    pair.go_on(200, true);
    assert_eq!(pair.carried_out, [second, first]);
    // What a robot does not look at in time is too late.
    pair.station.command(pair.now, command(CommandId([6; 16]), 200, 300)).expect("both bounds");
    pair.go_on(100, true);
    pair.now += Duration::from_secs(1);
    pair.go_on(500, true);
    assert!(pair.told.contains(&CommandState::Expired) && pair.carried_out.len() == 2);
}

#[test]
fn a_new_key_is_used_once_both_sides_have_it_and_the_one_before_until_then() {
    let mut pair = Pair::new();
    let (id, key) = (KeyId(2), PairingKey::from_bytes([9; 32]));
    pair.go_on(300, true);
    pair.robot.offer_key(id, &key);
    // One way, the robot stays with what it has.
    pair.go_on(3_000, false);
    assert_eq!((pair.offered, pair.robot.is_offer_taken()), (None, false));
    pair.go_on(2_000, true);
    assert_eq!((pair.offered, pair.robot.is_offer_taken()), (Some(id), false));
    pair.station.use_key(id, &key);
    assert!(!pair.station.is_key_confirmed());
    pair.go_on(100, true);
    assert!(pair.robot.is_offer_taken() && !pair.station.is_key_confirmed());
    assert!(pair.robot.heard_before(pair.now) < Some(Duration::from_millis(100)));
    pair.robot.use_offered();
    pair.go_on(500, true);
    assert!(pair.station.is_key_confirmed());
    assert_eq!([pair.robot.key_id(), pair.station.key_id()], [id; 2]);
    // What a stranger replays under the key before is rejected as ever.
    let before = Identity {
        key_id: KeyId(1),
        key: &PairingKey::from_bytes([7; 32]),
        robot: "scout",
        start: SenderStart::new(1, 0),
        heard: None,
    };
    let mut replayed = StationSession::new(&before, Profile::LAN);
    replayed.restore(StreamId(1), RangeSet::default());
    let mut datagram = replayed.poll_transmit(pair.now).expect("room").expect("a report");
    assert!(pair.robot.handle_datagram(pair.now, &mut datagram, |_| ()).is_err());
}

#[test]
fn of_many_commands_all_are_sent_or_none() {
    let mut pair = Pair::new();
    let command = |nth: u16, bytes: usize, wait_ms: u64| {
        let [low, high] = nth.to_le_bytes();
        let id = CommandId(std::array::from_fn(|at| if at == 0 { low } else { high }));
        let (valid, body) = (Duration::from_mins(1), vec![1; bytes]);
        let wait = (wait_ms > 0).then(|| Duration::from_millis(wait_ms));
        NewCommand { id, valid, wait, epoch: 0, body }
    };
    let list = vec![command(0, 9, 0), command(1, 9, 2_000)];
    let unheard = Err(vec![Err(NotSent::Unheard); 2]);
    assert_eq!(pair.station.command_all(pair.now, list.clone()), unheard);
    pair.go_on(500, true);
    // One that is too long, or expires before its time, is the fault of the whole list.
    let bad = vec![command(0, 9, 0), command(1, 0, 0), command(2, 9, 61_000)];
    let faults = vec![Ok(()), Err(NotSent::TooLong(0)), Err(NotSent::Uncertain)];
    assert_eq!(pair.station.check_all(pair.now, &bad), faults);
    assert_eq!(pair.station.command_all(pair.now, bad), Err(faults));
    pair.go_on(500, true);
    assert_eq!(pair.carried_out, []);
    // The bytes of the commands before count in the time that a long one needs.
    let length = COMMAND_LENGTH_MAX as usize;
    let alone = pair.station.transfer_time(length);
    let brief =
        |nth| NewCommand { valid: alone + Duration::from_nanos(1), ..command(nth, length, 0) };
    let checked = pair.station.check_all(pair.now, &[brief(0), brief(1)]);
    assert!(matches!(checked[..], [Ok(()), Err(NotSent::TooSlow { .. })]), "{checked:?}");
    assert_eq!(pair.station.command_all(pair.now, list.clone()), Ok(()));
    // What is on its way already needs no room and is not sent again.
    assert_eq!(pair.station.command_all(pair.now, list.clone()), Ok(()));
    pair.go_on(3_000, true);
    assert_eq!(pair.carried_out, [list[0].id, list[1].id]);
    for command in list {
        pair.robot.set_command_state(pair.now, command.id, CommandState::Done, "");
    }
    pair.go_on(500, true);
    // The robot keeps a limited number for later.
    let many: Vec<_> = (10..75).map(|nth| command(nth, 9, 9_000)).collect();
    let refused = pair.station.command_all(pair.now, many.clone()).expect_err("too many for later");
    assert_eq!(refused.iter().filter(|it| it.is_err()).count(), many.len() - SCHEDULED_MAX);
    assert_eq!(refused.last(), Some(&Err(NotSent::TooManyScheduled)));
    // Without room for all, none is sent.
    let most = u16::try_from(COMMANDS_MAX).expect("a small number");
    let many: Vec<_> = (10..most + 11).map(|nth| command(nth, 9, 0)).collect();
    let refused = pair.station.command_all(pair.now, many.clone()).expect_err("no room");
    let full = refused.iter().filter(|it| **it == Err(NotSent::TooMany)).count();
    assert_eq!((full, refused.last()), (1, Some(&Err(NotSent::TooMany))));
    assert!(many.iter().all(|command| !pair.station.is_open(command.id)));
    assert_eq!(pair.station.command_all(pair.now, many[1..].to_vec()), Ok(()));
}

#[test]
fn commands_beyond_the_bound_are_refused_unless_some_are_overdue() {
    let mut pair = Pair::new();
    pair.go_on(500, true);
    let command = |nth: usize| {
        let id =
            CommandId(std::array::from_fn(|at| nth.to_le_bytes().get(at).copied().unwrap_or(0)));
        let valid = Duration::from_secs(1);
        NewCommand { id, valid, wait: None, epoch: 0, body: b"pause".to_vec() }
    };
    for nth in 0..COMMANDS_MAX {
        pair.station.command(pair.now, command(nth)).expect("room");
    }
    let more = command(COMMANDS_MAX);
    assert_eq!(pair.station.command(pair.now, more.clone()), Err(NotSent::TooMany));
    // The robot falls silent until all are overdue.
    pair.go_on(2_000, false);
    assert_eq!(pair.station.take_overdue(pair.now).len(), COMMANDS_MAX);
    assert_eq!(pair.station.command(pair.now, more.clone()), Ok(()));
    assert!(pair.station.is_open(more.id));
}
