//! Commands on their way to the robot: each is sent until it is known what became of it, or its time is over.

use crate::frame::{Command, CommandId, CommandState, Frame};
use crate::heard::{ClockBounds, drift};
use crate::robot::now_ms;
use crate::seal::Generation;
use std::collections::BTreeMap;
use std::time::Duration;

/// A command is sent this often at first, so that it arrives although datagrams are lost.
const FIRST_SENDS: u32 = 4;
/// The time between these.
const FIRST_EVERY: Duration = Duration::from_millis(50);
/// The robot is asked what became of a command that it has after so many round trips.
const ASK_AFTER: u32 = 2;

/// A command that is to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewCommand {
    /// Its id.
    pub id: CommandId,
    /// How long it is valid from now on. What has not arrived by then is not carried out.
    pub valid: Duration,
    /// It is not carried out before this time from now on; at once without one.
    pub wait: Option<Duration>,
    /// The epoch of authority under which it is given.
    pub epoch: u64,
    /// The command; at most 200 bytes.
    pub body: Vec<u8>,
}

/// Why a command cannot be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotSent {
    /// The robot's clock, by which the command would expire, is unknown.
    #[error(
        "the robot was never heard, so no time can be named until which the command is valid: wait until it is heard"
    )]
    Unheard,
    /// It is for later, and it is unknown how far the robot's clock is ahead at most.
    #[error(
        "the robot never said that it hears this station, so no time can be named before which the command is not carried out: give it \
         without a time, or wait until there is an up-link"
    )]
    OneWay,
    /// The time is shorter than the clocks are known.
    #[error(
        "the command is valid for less time than the robot's clock is uncertain by: let it expire later"
    )]
    Uncertain,
    /// It does not fit into one datagram.
    #[error("the command has {0} bytes, and at most {1} fit: give it in a shorter form")]
    TooLong(usize, usize),
}

/// Between which times of the clock of this start of the robot a command may be carried out, in ms.
#[derive(Debug, Clone, Copy)]
pub(super) struct RobotTimes {
    start: Generation,
    not_before: u64,
    not_after: u64,
}

impl RobotTimes {
    /// However the robot's clock goes between its bounds: not before `wait` is over here, and not after `valid` is.
    pub(super) fn new(
        clock: ClockBounds,
        wait: Option<Duration>,
        valid: Duration,
    ) -> Result<Self, NotSent> {
        let not_after =
            clock.earliest_ms.saturating_add(now_ms(valid.saturating_sub(drift(valid))));
        let not_before = match wait.map(|wait| now_ms(wait + drift(wait))) {
            None => 0,
            Some(wait_ms) => clock.latest_ms.ok_or(NotSent::OneWay)?.saturating_add(wait_ms).max(1),
        };
        if not_before > not_after {
            return Err(NotSent::Uncertain);
        }
        Ok(Self { start: clock.start, not_before, not_after })
    }
}

/// The commands whose fate is open.
#[derive(Debug, Default)]
pub(super) struct Commands {
    sent: BTreeMap<CommandId, SentCommand>,
}

#[derive(Debug)]
struct SentCommand {
    epoch: u64,
    body: Vec<u8>,
    times: RobotTimes,
    sends: u32,
    due: Duration,
    /// The robot has it; its fate is not known yet.
    is_received: bool,
}

impl Commands {
    pub(super) fn has(&self, id: CommandId) -> bool {
        self.sent.contains_key(&id)
    }

    /// Adds a command.
    pub(super) fn add(
        &mut self,
        now: Duration,
        NewCommand { id, epoch, body, .. }: NewCommand,
        times: RobotTimes,
    ) {
        let (sends, due, is_received) = (0, now, false);
        let sent = SentCommand { epoch, body, times, sends, due, is_received };
        self.sent.insert(id, sent);
    }

    /// The robot says what became of a command. One that it only has is asked for again: its fate may be lost on the way.
    pub(super) fn answered(
        &mut self,
        now: Duration,
        id: CommandId,
        state: CommandState,
        round_trip: Duration,
    ) {
        match state {
            CommandState::Received | CommandState::Started => {
                if let Some(sent) = self.sent.get_mut(&id) {
                    (sent.is_received, sent.due) = (true, now + round_trip * ASK_AFTER);
                }
            }
            CommandState::Done | CommandState::Refused | CommandState::Expired => {
                self.sent.remove(&id);
            }
        }
    }

    /// When the next one is to be sent.
    pub(super) fn due_at(&self) -> Duration {
        self.sent.values().map(|sent| sent.due).min().unwrap_or(Duration::MAX)
    }

    /// Forgets those whose time is over, by the robot's clock. A command that the robot has is over with the robot's start only.
    pub(super) fn forget(&mut self, clock: Option<ClockBounds>) {
        self.sent.retain(|_, sent| {
            let Some(clock) = clock else { return sent.sends < FIRST_SENDS };
            let is_void = clock.start != sent.times.start;
            let is_late = clock.earliest_ms > sent.times.not_after && !sent.is_received;
            // The robot answers that it is expired, if it is heard; until then it is sent once more at least.
            !(is_void || is_late) || sent.sends < FIRST_SENDS
        });
    }

    /// Writes those that are due, as far as they fit. `round_trip` is how long an answer takes.
    pub(super) fn write(
        &mut self,
        now: Duration,
        round_trip: Duration,
        (room, payload): (usize, &mut Vec<u8>),
    ) {
        for (id, sent) in self.sent.iter_mut().filter(|(_, sent)| sent.due <= now) {
            let length = payload.len();
            let SentCommand { epoch, body, times, .. } = &*sent;
            let RobotTimes { start: robot_start, not_before, not_after } = *times;
            let (not_before_ms, not_after_ms, epoch) = (not_before, not_after, *epoch);
            let (id, body) = (*id, body.as_slice());
            Frame::Command(Command { id, robot_start, not_after_ms, not_before_ms, epoch, body })
                .write(payload);
            if payload.len() > room {
                payload.truncate(length);
                break;
            }
            sent.sends += 1;
            sent.due = now
                + match sent.is_received {
                    true => round_trip * ASK_AFTER,
                    false if sent.sends < FIRST_SENDS => FIRST_EVERY,
                    false => round_trip,
                };
        }
    }
}
