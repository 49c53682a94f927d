//! Commands whose times on the robot's clock are known before they are sent, such as those of an earlier start of the station.

use super::StationSession;
use super::commands::{NewCommand, NotSent, RobotTimes, TimedCommand};
use crate::frame::CommandId;
use crate::session_time::SessionTime;

impl StationSession {
    /// Times on the robot's clock of a command that can be sent now, besides `others` that are not sent yet.
    pub fn times_for(
        &self,
        now: SessionTime,
        command: &NewCommand,
        others: usize,
    ) -> Result<RobotTimes, NotSent> {
        let times = self.times_of(now, command, self.commands.missing_bytes())?;
        if !self.commands.has(command.id) && self.commands.room() <= others {
            return Err(NotSent::TooMany);
        }
        Ok(times)
    }

    /// A command that is sent until its fate is known, with its times.
    pub fn sent(&self, id: CommandId) -> Option<TimedCommand> {
        self.commands.sent(id)
    }

    /// Sends a command with these times until its fate is known. It needs no signal of the robot: a start of the robot that the times
    /// are not of reports the fate, and does not carry it out.
    pub fn command_at(&mut self, now: SessionTime, command: TimedCommand) -> Result<(), NotSent> {
        if !self.commands.has(command.id) {
            self.commands.make_room(1)?;
        }
        self.commands.add(now, command, self.command_bytes_max());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::commands::COMMANDS_MAX;
    use super::super::tests::Pair;
    use super::*;
    use crate::frame::CommandState;
    use std::time::Duration;

    const ID: CommandId = CommandId([3; 16]);

    /// A command that was accepted, and the station died before or after the robot had it.
    fn accepted(pair: &mut Pair, is_sent: bool) -> TimedCommand {
        pair.go_on(500, true);
        let (valid, body) = (Duration::from_secs(2), b"resume".to_vec());
        let command = NewCommand { id: ID, valid, wait: None, epoch: 7, body };
        let times = pair.station.times_for(pair.now, &command, 0).expect("a clock");
        let command = command.at(times);
        if is_sent {
            pair.station.command_at(pair.now, command.clone()).expect("room");
            assert_eq!(pair.station.sent(ID).as_ref(), Some(&command));
            pair.go_on(1, true);
            assert_eq!(pair.carried_out, [ID]);
        }
        pair.restart_station();
        TimedCommand { is_restored: true, ..command }
    }

    #[test]
    fn a_restored_command_is_carried_out_once_whether_the_robot_had_it_or_not() {
        for is_sent in [false, true] {
            let mut pair = Pair::new();
            let command = accepted(&mut pair, is_sent);
            pair.station.command_at(pair.now, command).expect("room");
            pair.go_on(500, true);
            pair.robot.set_command_state(pair.now, ID, CommandState::Done, "");
            pair.go_on(500, true);
            assert_eq!(pair.carried_out, [ID]);
            assert_eq!(pair.told.last(), Some(&CommandState::Done));
            assert!(!pair.station.is_open(ID));
        }
    }

    #[test]
    fn a_restored_command_expires_at_its_time_and_with_its_start_of_the_robot() {
        let mut pair = Pair::new();
        let command = accepted(&mut pair, false);
        pair.now += Duration::from_secs(3);
        pair.station.command_at(pair.now, command.clone()).expect("room");
        pair.go_on(500, true);
        assert_eq!((pair.carried_out.len(), pair.told.last()), (0, Some(&CommandState::Expired)));
        let mut pair = Pair::new();
        accepted(&mut pair, false);
        pair.restart_robot();
        pair.station.command_at(pair.now, command).expect("room");
        pair.go_on(500, true);
        assert_eq!((pair.carried_out.len(), pair.told.last()), (0, Some(&CommandState::Expired)));
    }

    #[test]
    fn a_restored_command_is_not_expired_because_this_start_did_not_reach_the_robot() {
        let mut pair = Pair::new();
        let command = accepted(&mut pair, true);
        pair.told.clear();
        pair.station.command_at(pair.now, command).expect("room");
        // The robot is received, and receives nothing.
        pair.go_one_way(5_000);
        assert_eq!(pair.station.take_overdue(pair.now), [ID]);
        assert!(pair.told.is_empty() && pair.station.is_open(ID));
    }

    #[test]
    fn a_command_has_room_beside_those_that_are_accepted() {
        let mut pair = Pair::new();
        pair.go_on(500, true);
        let valid = Duration::from_secs(2);
        let command = NewCommand { id: ID, valid, wait: None, epoch: 0, body: b"stop".to_vec() };
        let times = |others| pair.station.times_for(pair.now, &command, others);
        assert!(times(COMMANDS_MAX - 1).is_ok());
        assert_eq!(times(COMMANDS_MAX), Err(NotSent::TooMany));
    }
}
