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
/// Longest time between two questions for the fate of an overdue command, unless a round trip takes longer.
const ASK_EVERY_MAX: Duration = Duration::from_mins(2);

/// Capacity. Beyond it, the oldest overdue command is dropped: its fate stays unknown.
pub(super) const COMMANDS_MAX: usize = 256;

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
    /// Too many commands are on their way, all in their time.
    #[error(
        "{COMMANDS_MAX} commands are on their way to the robot already: wait until it has answered some"
    )]
    TooMany,
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
    /// Time of this session at which it was first sent.
    first_sent: Option<Duration>,
    due: Duration,
    /// The robot has it; its fate is not known yet.
    is_received: bool,
    /// Its time is over and its fate is unknown: the robot is asked for it.
    is_overdue: bool,
}

impl Commands {
    pub(super) fn has(&self, id: CommandId) -> bool {
        self.sent.contains_key(&id)
    }

    /// Adds a command. One that is on its way already stays as it is.
    pub(super) fn add(
        &mut self,
        now: Duration,
        NewCommand { id, epoch, body, .. }: NewCommand,
        times: RobotTimes,
    ) -> Result<(), NotSent> {
        if self.sent.len() >= COMMANDS_MAX && !self.has(id) {
            let overdue = self.sent.iter().filter(|(_, sent)| sent.is_overdue);
            let oldest = overdue.min_by_key(|(_, sent)| sent.first_sent).map(|(id, _)| *id);
            self.sent.remove(&oldest.ok_or(NotSent::TooMany)?);
        }
        self.sent.entry(id).or_insert(SentCommand {
            epoch,
            body,
            times,
            sends: 0,
            first_sent: None,
            due: now,
            is_received: false,
            is_overdue: false,
        });
        Ok(())
    }

    /// Takes the robot's answer. A command that it only has is asked for again: the fate may be lost on the way.
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

    /// When the next one is to be sent. The link is free from `free_at` on.
    pub(super) fn due_at(&self, free_at: Duration) -> Duration {
        let due = |sent: &SentCommand| {
            if sent.is_overdue { sent.due.max(free_at) } else { sent.due }
        };
        self.sent.values().map(due).min().unwrap_or(Duration::MAX)
    }

    /// Commands that have just become overdue: expired by the robot's clock, without an answer of the robot.
    pub(super) fn take_overdue(&mut self, clock: Option<ClockBounds>) -> Vec<CommandId> {
        let Some(clock) = clock else { return Vec::new() };
        let mut overdue = Vec::new();
        for (id, sent) in &mut self.sent {
            let is_over = clock.start != sent.times.start
                || clock.earliest_ms > sent.times.not_after && sent.sends >= FIRST_SENDS;
            if is_over && !sent.is_overdue {
                sent.is_overdue = true;
                overdue.push(*id);
            }
        }
        overdue
    }

    /// Removes and returns the commands that expired without reaching the robot: by a report that it made after their expiry, it had
    /// received nothing since before they were sent.
    ///
    /// `start` and `at_ms` are the robot's start and time of the report; `heard` is the session time at which the newest datagram that
    /// it had received was sent.
    pub(super) fn take_unheard(
        &mut self,
        start: Generation,
        at_ms: u64,
        heard: Duration,
    ) -> Vec<CommandId> {
        let is_unheard = |_: &CommandId, sent: &mut SentCommand| {
            let RobotTimes { start: of, not_after, .. } = sent.times;
            of == start && at_ms > not_after && sent.first_sent.is_some_and(|first| heard < first)
        };
        self.sent.extract_if(.., is_unheard).map(|(id, _)| id).collect()
    }

    /// Makes all overdue commands due, after a silence of the robot.
    pub(super) fn ask_again(&mut self, now: Duration) {
        for sent in self.sent.values_mut().filter(|sent| sent.is_overdue) {
            (sent.due, sent.sends) = (now, sent.sends.min(FIRST_SENDS));
        }
    }

    /// Writes those that are due, as far as they fit; overdue ones only if the link is free. `round_trip` is how long an answer takes.
    pub(super) fn write(
        &mut self,
        now: Duration,
        is_free: bool,
        round_trip: Duration,
        (room, payload): (usize, &mut Vec<u8>),
    ) {
        let is_due = |sent: &SentCommand| sent.due <= now && (is_free || !sent.is_overdue);
        for (id, sent) in self.sent.iter_mut().filter(|(_, sent)| is_due(sent)) {
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
            sent.first_sent.get_or_insert(now);
            sent.sends += 1;
            sent.due = now + sent.next_after(round_trip);
        }
    }
}

impl SentCommand {
    /// Time from a send to the next one.
    fn next_after(&self, round_trip: Duration) -> Duration {
        if self.sends < FIRST_SENDS && !self.is_received {
            return FIRST_EVERY;
        }
        if self.is_overdue {
            // Each time later: the robot may be silent for hours.
            let doublings = self.sends.saturating_sub(FIRST_SENDS).min(16);
            let longer = round_trip.saturating_mul(1 << doublings);
            return longer.clamp(round_trip, ASK_EVERY_MAX.max(round_trip));
        }
        if self.is_received { round_trip * ASK_AFTER } else { round_trip }
    }
}
