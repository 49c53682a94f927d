//! Which commands can be sent: their lengths, their times on the robot's clock, and the room for them.

use super::StationSession;
use super::commands::{CommandProgress, NewCommand, NotSent, RobotTimes};
use crate::frame::{COMMAND_LENGTH_MAX, CommandId};
use crate::profile::CARRIER_OVERHEAD;
use crate::robot::SCHEDULED_MAX;
use crate::seal::OVERHEAD;
use crate::session_time::SessionTime;
use std::time::Duration;

/// Bytes of a datagram besides the body of a command.
const COMMAND_HEAD_MAX: usize = 64;

impl StationSession {
    /// Sends a command until its fate is known or its time is over.
    pub fn command(&mut self, now: SessionTime, command: NewCommand) -> Result<(), NotSent> {
        let times = self.times_of(now, &command, self.commands.missing_bytes())?;
        self.command_at(now, command.at(times))
    }

    /// Sends all of these commands, or none of them: then the result has a place for each, with the reason if it cannot be sent.
    pub fn command_all(
        &mut self,
        now: SessionTime,
        commands: Vec<NewCommand>,
    ) -> Result<(), Vec<Result<(), NotSent>>> {
        let times: Vec<_> = self.times_of_all(now, &commands);
        let is_refused = times.iter().any(Result::is_err);
        let new = commands.iter().filter(|command| !self.commands.has(command.id)).count();
        if is_refused || self.commands.make_room(new).is_err() {
            return Err(times.into_iter().map(|times| times.map(drop)).collect());
        }
        let whole_max = self.command_bytes_max();
        for (command, times) in commands.into_iter().zip(times.into_iter().flatten()) {
            self.commands.add(now, command.at(times), whole_max);
        }
        Ok(())
    }

    /// The reason for each of these commands that could not be sent with the others.
    pub fn check_all(&self, now: SessionTime, commands: &[NewCommand]) -> Vec<Result<(), NotSent>> {
        self.times_of_all(now, commands).into_iter().map(|times| times.map(drop)).collect()
    }

    fn times_of_all(
        &self,
        now: SessionTime,
        commands: &[NewCommand],
    ) -> Vec<Result<RobotTimes, NotSent>> {
        let clock = self.robot_clock(now);
        let mut later = clock.map_or(0, |clock| self.commands.later(clock));
        let (mut missing, mut room) = (self.commands.missing_bytes(), self.commands.room());
        let mut all = Vec::with_capacity(commands.len());
        for command in commands {
            let times = self.times_of(now, command, missing);
            if self.commands.has(command.id) {
                all.push(times);
                continue;
            }
            if command.body.len() > self.command_bytes_max() {
                missing += command.body.len() as u64;
            }
            let is_later = |times: &RobotTimes| clock.is_some_and(|clock| times.is_later(clock));
            later += usize::from(times.as_ref().is_ok_and(is_later));
            all.push(match times {
                Ok(_) if room == 0 => Err(NotSent::TooMany),
                Ok(times) if is_later(&times) && later > SCHEDULED_MAX => {
                    Err(NotSent::TooManyScheduled)
                }
                times => times,
            });
            room = room.saturating_sub(1);
        }
        all
    }

    /// Times of a command on the robot's clock. `missing` counts the unsent bytes of commands in parts before it.
    pub(super) fn times_of(
        &self,
        now: SessionTime,
        NewCommand { valid, wait, body, .. }: &NewCommand,
        missing: u64,
    ) -> Result<RobotTimes, NotSent> {
        let (length, valid) = (body.len(), *valid);
        if length == 0 || length > COMMAND_LENGTH_MAX as usize {
            return Err(NotSent::TooLong(length));
        }
        let takes = self.transfer_time_behind(missing, length);
        if takes > valid {
            return Err(NotSent::TooSlow { bytes: length, takes, valid });
        }
        let clock = self.robot_clock(now).ok_or(NotSent::Unheard)?;
        RobotTimes::new(clock, *wait, valid)
    }

    /// Length of a command that fits into one datagram, in bytes: longer ones are sent in parts.
    pub fn command_bytes_max(&self) -> usize {
        self.end.path.max() - OVERHEAD - COMMAND_HEAD_MAX
    }

    /// Time that the parts of a command of this length need on the up-link, after those of the commands before, and half a round trip;
    /// zero for one that fits into a datagram.
    pub fn transfer_time(&self, length: usize) -> Duration {
        self.transfer_time_behind(self.commands.missing_bytes(), length)
    }

    fn transfer_time_behind(&self, missing: u64, length: usize) -> Duration {
        if length <= self.command_bytes_max() {
            return Duration::ZERO;
        }
        let bytes = length as u64 + missing;
        let datagrams = bytes / self.command_bytes_max() as u64 + 1;
        let bits = datagrams * self.datagram_bits();
        let nanos = bits.saturating_mul(1_000_000_000) / self.profile.up_bits_per_s;
        Duration::from_nanos(nanos) + self.answer_time() / 2
    }

    /// Rate at which the parts of a long command are sent, in bytes of the command per second.
    pub fn command_bytes_per_s(&self) -> u64 {
        (self.command_bytes_max() as u64 * self.profile.up_bits_per_s / self.datagram_bits()).max(1)
    }

    /// Size of the longest datagram on the carrier, in bits.
    fn datagram_bits(&self) -> u64 {
        (self.end.path.max() + CARRIER_OVERHEAD) as u64 * 8
    }

    /// Progress of a command that is sent in parts.
    pub fn command_progress(&self, id: CommandId) -> Option<CommandProgress> {
        self.commands.progress(id)
    }
}
