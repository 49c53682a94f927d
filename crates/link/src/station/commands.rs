//! Commands on their way to the robot: each is sent until it is known what became of it, or its time is over.

use super::command_parts::CommandParts;
use crate::frame::{
    Body, COMMAND_LENGTH_MAX, Command, CommandId, CommandState, Frame, PartsHere, Terms,
};
use crate::heard::{ClockBounds, drift};
use crate::payload_writer::PayloadWriter;
use crate::robot::SCHEDULED_MAX;
use crate::seal::Generation;
use crate::session_time::{SessionTime, millis};
use std::collections::BTreeMap;
use std::time::Duration;

/// A command is sent this often at first, so that it arrives although datagrams are lost.
const FIRST_SENDS: u32 = 4;
/// The time between these.
const FIRST_EVERY: Duration = Duration::from_millis(50);
/// Round trips after which the fate of a received command is requested.
const ASK_AFTER: u32 = 2;
/// Longest time between two questions for the fate of an overdue command, unless a round trip takes longer.
const ASK_EVERY_MAX: Duration = Duration::from_mins(2);

/// Limit of commands that a station sends at a time. Beyond it, the oldest overdue command is dropped: its fate stays unknown.
pub const COMMANDS_MAX: usize = 256;

/// A command that is to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewCommand {
    /// Its id.
    pub id: CommandId,
    /// Lifetime from now on. A later arrival is not carried out.
    pub valid: Duration,
    /// It is not carried out before this time from now on; at once without one.
    pub wait: Option<Duration>,
    /// The epoch of authority under which it is given.
    pub epoch: u64,
    /// The command: 1 to [`COMMAND_LENGTH_MAX`] bytes. What does not fit into one datagram is sent in parts.
    pub body: Vec<u8>,
}

impl NewCommand {
    /// The command with its times on the robot's clock.
    pub fn at(self, times: RobotTimes) -> TimedCommand {
        let Self { id, epoch, body, .. } = self;
        TimedCommand { id, times, epoch, body, is_restored: false }
    }
}

/// Progress of a command that is sent in parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CommandProgress {
    /// Bytes that the robot has reported.
    pub arrived: u64,
    /// Length of the command in bytes.
    pub length: u64,
}

/// Reason why a command cannot be sent.
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
    /// Too many commands of a list are for later.
    #[error(
        "the robot keeps {SCHEDULED_MAX} commands for later at a time: give some without a time, or in another list after their time has come"
    )]
    TooManyScheduled,
    /// It is empty or longer than the link carries.
    #[error("the command has {0} bytes, and the link carries 1 to {COMMAND_LENGTH_MAX}")]
    TooLong(usize),
    /// It expires before all of it can have arrived.
    #[error(
        "the command has {bytes} bytes, which need {} s over this link, and it is valid for {} s: let it expire later",
        takes.as_secs_f32().ceil(),
        valid.as_secs()
    )]
    TooSlow {
        /// Length of the command in bytes.
        bytes: usize,
        /// Time until the robot has all of it, without losses.
        takes: Duration,
        /// Its lifetime.
        valid: Duration,
    },
}

/// Between which times of the clock of one start of the robot a command may be carried out, in ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RobotTimes {
    /// Start of the robot. A later start does not carry out the command.
    pub start: Generation,
    /// Earliest time; 0 without one.
    pub not_before: u64,
    /// Latest time of effect.
    pub not_after: u64,
}

/// A command with its times on the robot's clock. They stay valid over a restart of the station.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimedCommand {
    /// Id of the command.
    pub id: CommandId,
    /// Times of the robot's clock.
    pub times: RobotTimes,
    /// The epoch of authority under which it is given.
    pub epoch: u64,
    /// Bytes of the command.
    pub body: Vec<u8>,
    /// An earlier start of the station may have sent it.
    pub is_restored: bool,
}

impl RobotTimes {
    /// However the robot's clock goes between its bounds: not before `wait` is over here, and not after `valid` is.
    pub(super) fn new(
        clock: ClockBounds,
        wait: Option<Duration>,
        valid: Duration,
    ) -> Result<Self, NotSent> {
        let not_after =
            clock.earliest_ms.saturating_add(millis(valid.saturating_sub(drift(valid))));
        let not_before = match wait.map(|wait| millis(wait + drift(wait))) {
            None => 0,
            Some(wait_ms) => clock.latest_ms.ok_or(NotSent::OneWay)?.saturating_add(wait_ms).max(1),
        };
        if not_before > not_after {
            return Err(NotSent::Uncertain);
        }
        Ok(Self { start: clock.start, not_before, not_after })
    }

    /// True if the robot may keep the command for later.
    pub(super) fn is_later(&self, clock: ClockBounds) -> bool {
        self.not_before > clock.earliest_ms
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
    /// Set if it does not fit into one datagram.
    parts: Option<CommandParts>,
    times: RobotTimes,
    sends: u32,
    /// Time of this session at which it was first sent.
    first_sent: Option<SessionTime>,
    due: SessionTime,
    /// The robot has it; its fate is not known yet.
    is_received: bool,
    /// An earlier start of this side may have sent it.
    is_restored: bool,
    /// Its time is over and its fate is unknown: the robot is asked for it.
    is_overdue: bool,
}

impl Commands {
    pub(super) fn has(&self, id: CommandId) -> bool {
        self.sent.contains_key(&id)
    }

    pub(super) fn sent(&self, id: CommandId) -> Option<TimedCommand> {
        let SentCommand { epoch, body, times, is_restored, .. } = self.sent.get(&id)?;
        let (times, epoch, is_restored) = (*times, *epoch, *is_restored);
        Some(TimedCommand { id, times, epoch, body: body.clone(), is_restored })
    }

    /// Number of commands that the robot may keep for later.
    pub(super) fn later(&self, clock: ClockBounds) -> usize {
        self.sent.values().filter(|sent| sent.times.is_later(clock)).count()
    }

    /// Number of further commands that have room: overdue ones make room for them.
    pub(super) fn room(&self) -> usize {
        let overdue = self.sent.values().filter(|sent| sent.is_overdue).count();
        (COMMANDS_MAX + overdue).saturating_sub(self.sent.len())
    }

    /// Makes room for this number of commands: drops the oldest overdue ones. If they are too few, none is dropped.
    pub(super) fn make_room(&mut self, count: usize) -> Result<(), NotSent> {
        if count > self.room() {
            return Err(NotSent::TooMany);
        }
        let surplus = (self.sent.len() + count).saturating_sub(COMMANDS_MAX);
        let overdue = self.sent.iter().filter(|(_, sent)| sent.is_overdue);
        let mut overdue: Vec<_> = overdue.map(|(id, sent)| (sent.first_sent, *id)).collect();
        overdue.sort_unstable();
        for (_, id) in overdue.iter().take(surplus) {
            self.sent.remove(id);
        }
        Ok(())
    }

    /// Adds a command for which room was made; one with more than `whole_max` bytes is sent in parts. One that is on its way already
    /// stays as it is.
    pub(super) fn add(&mut self, now: SessionTime, command: TimedCommand, whole_max: usize) {
        let TimedCommand { id, times, epoch, body, is_restored } = command;
        let parts = (body.len() > whole_max).then(CommandParts::default);
        self.sent.entry(id).or_insert(SentCommand {
            epoch,
            body,
            parts,
            times,
            sends: 0,
            first_sent: None,
            due: now,
            is_received: false,
            is_restored,
            is_overdue: false,
        });
    }

    /// Datagrams have become shorter: commands that do not fit into one any more are sent in parts.
    pub(super) fn shorten(&mut self, whole_max: usize) {
        for sent in self.sent.values_mut().filter(|sent| sent.body.len() > whole_max) {
            sent.parts.get_or_insert_default();
        }
    }

    /// Takes the robot's answer. A command that it only has is asked for again: the fate may be lost on the way.
    pub(super) fn answered(
        &mut self,
        now: SessionTime,
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

    /// Takes the robot's report on the parts of a command.
    pub(super) fn parts_here(&mut self, now: SessionTime, here: &PartsHere, round_trip: Duration) {
        let Some(sent) = self.sent.get_mut(&here.id) else { return };
        let (Some(parts), length) = (&mut sent.parts, sent.body.len() as u64) else { return };
        if parts.report(now, here, length, round_trip) {
            // The head is due again after the parts.
            sent.due = now;
        }
    }

    /// The robot has started again, without any parts.
    pub(super) fn robot_started(&mut self) {
        for parts in self.sent.values_mut().filter_map(|sent| sent.parts.as_mut()) {
            parts.robot_started();
        }
    }

    /// Bytes that are not known to have arrived, of all commands in parts.
    pub(super) fn missing_bytes(&self) -> u64 {
        self.sent.values().filter_map(SentCommand::progress).map(|it| it.length - it.arrived).sum()
    }

    /// Progress of a command that is sent in parts.
    pub(super) fn progress(&self, id: CommandId) -> Option<CommandProgress> {
        self.sent.get(&id)?.progress()
    }

    /// When the next one is to be sent. The link is free from `free_at` on.
    pub(super) fn due_at(&self, free_at: SessionTime) -> Option<SessionTime> {
        let due = |sent: &SentCommand| {
            if sent.is_overdue || sent.parts.is_some() { sent.due.max(free_at) } else { sent.due }
        };
        self.sent.values().map(due).min()
    }

    /// Commands that have just become overdue: expired by the robot's clock, without an answer of the robot.
    pub(super) fn take_overdue(&mut self, clock: Option<ClockBounds>) -> Vec<CommandId> {
        let Some(clock) = clock else { return Vec::new() };
        let mut overdue = Vec::new();
        for (id, sent) in &mut self.sent {
            let is_sent = sent.sends >= FIRST_SENDS || sent.parts.is_some();
            let is_over = clock.start != sent.times.start
                || clock.earliest_ms > sent.times.not_after && is_sent;
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
        heard: SessionTime,
    ) -> Vec<CommandId> {
        let is_unheard = |_: &CommandId, sent: &mut SentCommand| {
            let RobotTimes { start: of, not_after, .. } = sent.times;
            // The robot may have received a restored command from an earlier start of this side.
            let is_unheard = sent.first_sent.is_some_and(|first| heard < first);
            of == start && at_ms > not_after && is_unheard && !sent.is_restored
        };
        self.sent.extract_if(.., is_unheard).map(|(id, _)| id).collect()
    }

    /// Makes all overdue commands due, after a silence of the robot.
    pub(super) fn ask_again(&mut self, now: SessionTime) {
        for sent in self.sent.values_mut().filter(|sent| sent.is_overdue) {
            (sent.due, sent.sends) = (now, sent.sends.min(FIRST_SENDS));
        }
    }

    /// Writes those that are due and fit into one datagram, as far as there is room; overdue ones only if the link is free.
    /// `round_trip` is how long an answer takes.
    pub(super) fn write(
        &mut self,
        now: SessionTime,
        is_free: bool,
        round_trip: Duration,
        payload: &mut PayloadWriter,
    ) {
        let is_due = |sent: &SentCommand| sent.due <= now && (is_free || !sent.is_overdue);
        let whole = self.sent.iter_mut().filter(|(_, sent)| sent.parts.is_none() && is_due(sent));
        for (id, sent) in whole {
            if !sent.write(*id, payload) {
                return;
            }
            sent.note_sent(now, round_trip);
        }
    }

    /// Writes the parts of longer ones, and their heads after them, as far as there is room.
    pub(super) fn write_parts(
        &mut self,
        now: SessionTime,
        round_trip: Duration,
        payload: &mut PayloadWriter,
    ) {
        let parted = self.sent.iter_mut().filter(|(_, sent)| sent.parts.is_some());
        for (id, sent) in parted.filter(|(_, sent)| sent.due <= now) {
            let is_unanswered = !sent.is_received && !sent.is_overdue;
            let is_blind_round = sent.sends >= FIRST_SENDS && is_unanswered;
            let SentCommand { parts: Some(parts), body, .. } = sent else { continue };
            if is_blind_round && parts.is_round_over() {
                parts.begin_round();
                sent.sends = 0;
            }
            let begun = payload.len();
            let are_sent = parts.write(*id, body, payload);
            if payload.len() > begun {
                sent.first_sent.get_or_insert(now);
            }
            if !are_sent || !sent.write(*id, payload) {
                return;
            }
            sent.note_sent(now, round_trip);
        }
    }
}

impl SentCommand {
    /// Writes the command, or the head of one in parts; false if there is no room.
    fn write(&self, id: CommandId, payload: &mut PayloadWriter) -> bool {
        let Self { epoch, body, parts, times, .. } = self;
        let RobotTimes { start: robot_start, not_before, not_after } = *times;
        let (not_before_ms, not_after_ms, epoch) = (not_before, not_after, *epoch);
        let terms = Terms { robot_start, not_after_ms, not_before_ms, epoch };
        let length = u32::try_from(body.len()).unwrap_or(u32::MAX);
        let body = if parts.is_some() { Body::Parts(length) } else { Body::Whole(body) };
        payload.try_frame(&Frame::Command(Command { id, terms, body }))
    }

    fn note_sent(&mut self, now: SessionTime, round_trip: Duration) {
        self.first_sent.get_or_insert(now);
        self.sends += 1;
        self.due = now + self.next_after(round_trip);
    }

    fn progress(&self) -> Option<CommandProgress> {
        let (parts, length) = (self.parts.as_ref()?, self.body.len() as u64);
        Some(CommandProgress { arrived: parts.arrived().min(length), length })
    }

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
