//! A robot and a station, with a path between them that a test decides about.

use super::{FromRobot, NewCommand, StationSession};
use crate::endpoint::Identity;
use crate::frame::{CommandId, CommandState, StreamId};
use crate::profile::Profile;
use crate::robot::{EventBuffer, RobotSession, RunSource};
use crate::seal::{Generation, KeyId, PairingKey};
use std::time::Duration;

/// A robot without runs.
struct NoRuns;

impl RunSource for NoRuns {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBuffer> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

struct Pair {
    now: Duration,
    robot: RobotSession,
    station: StationSession,
    carried_out: Vec<CommandId>,
    told: Vec<CommandState>,
}

impl Pair {
    fn new() -> Self {
        let key = PairingKey::from_bytes([7; 32]);
        let identity = Identity {
            key_id: KeyId(1),
            key: &key,
            robot: "scout",
            start: Generation(1),
            heard: None,
        };
        let mut robot = RobotSession::new(&identity, Profile::LAN);
        robot.begin(StreamId(1), 0);
        let station = StationSession::new(&identity, Profile::LAN);
        Self { now: Duration::ZERO, robot, station, carried_out: Vec::new(), told: Vec::new() }
    }

    /// Carries datagrams for this time, those from the robot only if `is_heard`.
    fn go_on(&mut self, ms: u64, is_heard: bool) {
        for _ in 0..ms {
            self.now += Duration::from_millis(1);
            while let Some(mut datagram) = self.robot.transmit(self.now, &mut NoRuns).expect("room")
            {
                if !is_heard {
                    continue;
                }
                let told = &mut self.told;
                let show = |shown: FromRobot<'_>| told.extend(state(&shown));
                self.station.receive(self.now, &mut datagram, show).expect("a datagram");
            }
            while let Some(mut datagram) = self.station.transmit(self.now).expect("room") {
                let carry_out = |command: crate::ReceivedCommand| self.carried_out.push(command.id);
                self.robot.receive(self.now, &mut datagram, carry_out).expect("a datagram");
            }
        }
    }
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
    let command = NewCommand { id, valid, epoch: 0, body: b"stop".to_vec() };
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
