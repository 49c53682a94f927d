//! The station's side of the link: receives what happens, reports what it has, sends commands.
//!
//! Long because every kind of frame is taken here.

mod command_parts;
mod commands;
mod large;
mod restored;
mod streams;
mod value_requests;

pub use commands::{CommandProgress, NewCommand, NotSent, RobotTimes, TimedCommand};
pub(crate) use large::LARGE_MAX;
#[cfg(test)]
pub(crate) use streams::OPEN_MAX;
pub use streams::StreamProgress;
pub use value_requests::{FetchProgress, NotWatched};

use crate::assembly::{Assembly, LENGTH_MAX};
use crate::bytes::write_number;
use crate::coding::{Contexts, LastCoder, OfferedSnapshots};
use crate::deflate::inflate;
use crate::endpoint::{Arrived, Endpoint, Identity, Unusable};
use crate::frame::{
    COMMAND_LENGTH_MAX, CommandId, CommandState, EventHash, Frame, NoValue, Packing, Received,
    StreamId, ValueFrame, ValueId,
};
use crate::heard::{ClockBounds, RobotClock};
use crate::profile::{CARRIER_OVERHEAD, Profile};
use crate::range_set::RangeSet;
use crate::robot::{SCHEDULED_MAX, now_ms};
use crate::seal::{Direction, For, Horizon, KeyId, OVERHEAD, PairingKey, SealError};
use crate::traffic::Traffic;
use commands::Commands;
use large::LargeEvents;
use rafcon_events::EventBlockRef;
use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::time::Duration;
use streams::{Settled, Streams};
use value_requests::ValueRequests;

/// A report of a run that is over and complete is sent this often after the last news of it.
const LAST_REPORTS: u8 = 8;
/// Capacity of a run in gaps. Events beyond another gap are treated as lost.
pub(crate) const GAPS_MAX: usize = 4_096;
/// Capacity of incomplete items, in bytes.
pub(crate) const PARTS_MAX: usize = 64 << 20;

/// Bytes of a datagram besides the body of a command.
const COMMAND_HEAD_MAX: usize = 64;
/// Part of a command's lifetime that no link needs: the time of a runner that is busy.
const COMMAND_TIME: Duration = Duration::from_secs(10);

/// Received content.
#[derive(Debug, PartialEq, Eq)]
pub enum FromRobot<'b> {
    /// The robot has restarted, or this is its first datagram. Earlier reports of commands and clocks are void.
    Started,
    /// Events of which at least one is new.
    Events {
        /// The run.
        stream: StreamId,
        /// The events.
        block: EventBlockRef<'b>,
    },
    /// Progress of a run.
    Status {
        /// The run.
        stream: StreamId,
        /// The number of its last event.
        head: u64,
        /// True if the run has ended.
        is_over: bool,
        /// Snapshot of the run.
        state: &'b [u8],
        /// The hash of all events up to one of the newest.
        chain: Option<EventHash>,
        /// When it was so, in ms of the robot's session.
        at_ms: u64,
    },
    /// The state of a run.
    Snapshot {
        /// The run.
        stream: StreamId,
        /// After this event.
        sequence: u64,
        /// The state.
        bytes: Vec<u8>,
    },
    /// The robot offers this key.
    NewKey {
        /// Its number.
        id: KeyId,
        /// The key.
        key: PairingKey,
    },
    /// Fate of a command.
    CommandState {
        /// Its id.
        id: CommandId,
        /// Fate of the command.
        state: CommandState,
        /// Reason of a refusal.
        reason: &'b [u8],
    },
    /// The newest values of those that are watched.
    Watched {
        /// The run.
        stream: StreamId,
        /// Number of the list in force.
        number: u64,
        /// Each with its name, in the words of the servers.
        values: Vec<Vec<u8>>,
    },
    /// Bytes of a large value that were not here.
    ValuePart {
        /// The value.
        id: ValueId,
        /// Offset of the bytes.
        offset: u64,
        /// The bytes.
        bytes: &'b [u8],
    },
    /// A large value, or the rest of it, does not come.
    NoValue {
        /// The value.
        id: ValueId,
        /// Reason of the refusal.
        why: NoValue,
    },
}

/// The station's side.
#[derive(Debug)]
pub struct StationSession {
    profile: Profile,
    end: Endpoint,
    clock: RobotClock,
    /// Last acknowledged datagram of this side, with the round trip.
    round_trip: Option<Duration>,
    /// Newest time of this session that the robot has received.
    reached_ms: Option<u64>,
    /// Time up to which the robot has received all that will arrive, by the datagram that is being read.
    echo_ms: Option<u64>,
    /// Start of the robot's session by its present calendar.
    calendar_ms: Option<u64>,
    /// The time of the datagram that was received last.
    now: Duration,
    streams: Streams,
    /// The stream that begins the next report.
    report_from: StreamId,
    reported_at: Option<Duration>,
    has_news: bool,
    commands: Commands,
    value_requests: ValueRequests,
}

#[derive(Debug, Default)]
struct Incoming {
    received: RangeSet,
    safe: u64,
    head: u64,
    is_over: bool,
    snapshot: Assembly,
    snapshot_sequence: u64,
    large: LargeEvents,
    contexts: Contexts,
    coder: LastCoder,
    snapshots: OfferedSnapshots,
    /// Number of remaining reports.
    reports: u8,
    /// When the robot named it last.
    named_at: Duration,
}

impl Incoming {
    /// Reopens a settled stream.
    fn resumed(Settled { events, is_over }: Settled) -> Self {
        let received = RangeSet::up_to(events);
        let (safe, head, reports) = (events, events, LAST_REPORTS);
        Self { received, safe, head, is_over, reports, ..Self::default() }
    }

    /// The items of an event of which all parts are here. `None` if they cannot be decoded: the robot sends the event again.
    fn unpack(&mut self, packing: Packing, packed: Vec<u8>) -> Option<Vec<u8>> {
        match packing {
            Packing::Plain => Some(packed),
            Packing::Deflated => inflate(&packed, LENGTH_MAX as usize),
            Packing::Coded { context, length } => {
                let known = self.contexts.find(context)?;
                self.coder.with(context, known).decode(&packed, length as usize)
            }
        }
    }

    fn is_complete(&self) -> bool {
        self.is_over && self.received.contiguous() >= self.head
    }
}

impl StationSession {
    /// A session from now on. Times are those since its begin, by a clock that never goes back.
    pub fn new(identity: &Identity<'_>, profile: Profile) -> Self {
        Self {
            end: Endpoint::new(identity, Direction::Up, &profile),
            clock: RobotClock::default(),
            round_trip: None,
            reached_ms: None,
            echo_ms: None,
            calendar_ms: None,
            now: Duration::ZERO,
            streams: Streams::default(),
            report_from: StreamId(0),
            reported_at: None,
            has_news: false,
            commands: Commands::default(),
            value_requests: ValueRequests::default(),
            profile,
        }
    }

    /// Restores the events of an unfinished run that are on the disk.
    pub fn restore(&mut self, stream: StreamId, events: RangeSet) {
        self.streams.restore(stream, events);
        self.has_news = true;
    }

    /// All of a stream, which is over, is on the disk from earlier starts.
    pub fn restore_whole(&mut self, stream: StreamId, events: u64) {
        self.streams.settle(stream, events, true);
    }

    /// Settles a stream whose events up to this one are on the disk. A later event opens it again.
    pub fn settle(&mut self, stream: StreamId, events: u64) {
        self.streams.settle(stream, events, false);
        // One more report, in case all earlier ones were lost.
        self.has_news |= self.streams.touch_settled(stream, 0);
    }

    /// Refuses a stream. It is reported as complete, so that the robot stops sending it.
    pub fn refuse(&mut self, stream: StreamId) {
        self.streams.refuse(stream);
        self.has_news = true;
    }

    /// Nothing of a stream is here any more: if the robot still has it, it comes again.
    pub fn forget(&mut self, stream: StreamId) {
        self.streams.forget(stream);
        self.value_requests.forget(stream);
    }

    /// The events of a run up to this one are on the disk.
    pub fn set_safe(&mut self, stream: StreamId, safe: u64) {
        if let Some(incoming) = self.streams.open.get_mut(&stream) {
            incoming.safe = incoming.safe.max(safe);
        }
    }

    /// These events of a run, which had arrived, were not kept: they are reported as missing, so that the robot sends them again.
    pub fn lose(&mut self, stream: StreamId, events: RangeInclusive<u64>) {
        if let Some(incoming) = self.streams.open.get_mut(&stream) {
            incoming.received.remove(events);
            self.has_news = true;
        }
    }

    /// The last event of an open stream up to which all are on the disk.
    pub fn safe(&self, stream: StreamId) -> u64 {
        self.streams.open.get(&stream).map_or(0, |incoming| incoming.safe)
    }

    /// True while streams are turned away because too many are open.
    pub fn is_crowded(&self, now: Duration) -> bool {
        self.streams.is_crowded(now)
    }

    /// Numbers of open and of settled streams.
    pub fn stream_counts(&self) -> (usize, usize) {
        self.streams.counts()
    }

    /// Uses a key that the robot offers, which is on the disk. What is sealed with the one before is still opened.
    pub fn use_key(&mut self, id: KeyId, key: &PairingKey) {
        self.end.add_key(id, key);
        self.end.use_key(id);
        (self.has_news, self.reported_at) = (true, None);
    }

    /// The key with which this side seals.
    pub fn key_id(&self) -> KeyId {
        self.end.key_id()
    }

    /// True if robot and station seal with one key.
    pub fn is_key_confirmed(&self) -> bool {
        self.end.heard_key() == Some(self.end.key_id())
    }

    /// Latest state of the robot, for the disk.
    pub fn horizon(&self) -> Option<Horizon> {
        self.end.horizon()
    }

    /// Time since the last datagram of the robot.
    pub fn heard_before(&self, now: Duration) -> Option<Duration> {
        self.end.heard.before(now)
    }

    /// Limit of datagrams in bytes, if the path drops some that are as long as the profile allows.
    pub fn shortened_datagrams(&self) -> Option<usize> {
        self.end.path.shortened()
    }

    /// Round trip to the robot. Unknown without an up-link.
    pub fn round_trip(&self) -> Option<Duration> {
        self.round_trip
    }

    /// Lifetime of a command that is given without one: two round trips, the uncertainty of the robot's clock, and 10 s.
    pub fn command_lifetime(&self, now: Duration) -> Duration {
        let round_trip = self.round_trip.unwrap_or(self.profile.round_trip);
        let clock = self.robot_clock(now).and_then(|clock| {
            Some(Duration::from_millis(clock.latest_ms?.saturating_sub(clock.earliest_ms)))
        });
        round_trip * 2 + clock.unwrap_or(round_trip) + COMMAND_TIME
    }

    /// Age of the last datagram that the robot has acknowledged. `None` without any.
    pub fn reached_before(&self, now: Duration) -> Option<Duration> {
        self.reached_ms.map(|at| now.saturating_sub(Duration::from_millis(at)))
    }

    /// The robot's calendar, at least and at most, in ms since 1970, UTC.
    pub fn robot_calendar(&self, now: Duration) -> Option<(u64, Option<u64>)> {
        let (clock, began) = (self.robot_clock(now)?, self.calendar_ms?);
        let at = |clock_ms: u64| began.saturating_add(clock_ms);
        Some((at(clock.earliest_ms), clock.latest_ms.map(at)))
    }

    /// Datagrams and bytes sent and received.
    pub fn traffic(&self) -> (&Traffic, &Traffic) {
        self.end.traffic()
    }

    /// True while the robot is sent a command or asked for its fate.
    pub fn is_open(&self, id: CommandId) -> bool {
        self.commands.has(id)
    }

    /// Commands that expired since the last call with an unknown fate. The session requests their fates until the robot
    /// answers.
    pub fn take_overdue(&mut self, now: Duration) -> Vec<CommandId> {
        self.commands.take_overdue(self.clock.bounds(now_ms(now)))
    }

    /// Between which times the robot's clock is.
    pub fn robot_clock(&self, now: Duration) -> Option<ClockBounds> {
        self.clock.bounds(now_ms(now))
    }

    /// Progress of a stream; `None` if it is unknown.
    pub fn progress(&self, stream: StreamId) -> Option<StreamProgress> {
        self.streams.progress(stream)
    }

    /// Received events of a stream; `None` if it is unknown.
    pub fn received(&self, stream: StreamId) -> Option<Cow<'_, RangeSet>> {
        let open = self.streams.open.get(&stream);
        open.map(|incoming| Cow::Borrowed(&incoming.received)).or_else(|| {
            let progress = self.streams.progress(stream)?;
            Some(Cow::Owned(RangeSet::up_to(progress.contiguous)))
        })
    }

    /// Counts of runs, ranges of their events, and bytes of incomplete items.
    #[cfg(test)]
    pub(crate) fn kept(&self) -> (usize, usize, usize) {
        let open = &self.streams.open;
        let ranges = open.values().map(|it| it.received.ranges_count());
        let parts = open.values().map(|it| it.snapshot.length() + it.large.length());
        (open.len(), ranges.sum(), parts.sum())
    }

    #[cfg(test)]
    pub(crate) fn set_settled_max(&mut self, most: usize) {
        self.streams.set_settled_max(most);
    }

    /// Takes a datagram; passes on what is new in it.
    pub fn receive(
        &mut self,
        now: Duration,
        datagram: &mut [u8],
        mut show: impl FnMut(FromRobot<'_>),
    ) -> Result<(), Unusable> {
        let Arrived { generation, at_ms, is_new_start, silence, frames } =
            self.end.open(now, datagram)?;
        self.now = now;
        if is_new_start {
            (self.round_trip, self.reached_ms, self.calendar_ms) = (None, None, None);
            self.value_requests.repeat();
            self.commands.robot_started();
            // The robot does not have what it sent before.
            let streams = self.streams.open.values_mut();
            streams.for_each(|incoming| incoming.snapshots = OfferedSnapshots::default());
            show(FromRobot::Started);
        }
        if silence.is_none_or(|silence| silence > self.profile.silence()) {
            // After a silence, the robot learns at once what is missing.
            (self.has_news, self.reported_at) = (true, None);
            self.commands.ask_again(now);
        }
        self.clock.receive(generation, at_ms, now_ms(now));
        for frame in frames {
            self.take(now, at_ms, &frame?, &mut show);
        }
        Ok(())
    }

    fn take(
        &mut self,
        now: Duration,
        at_ms: u64,
        frame: &Frame<'_>,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        match *frame {
            Frame::Events { stream, block } => self.take_events(stream, block, show),
            Frame::Coded { .. } => self.take_coded(frame, show),
            Frame::Large { .. } => self.take_large(frame, show),
            Frame::Status { .. } => self.take_status(at_ms, frame, show),
            Frame::Snapshot { .. } => self.take_snapshot_part(frame, show),
            Frame::CodedSnapshot { context, stream, sequence, length, bytes } => {
                if self.touch_settled(stream, sequence) {
                    return;
                }
                let Some(incoming) = self.incoming(stream) else { return };
                let (snapshots, length) = (&mut incoming.snapshots, length as usize);
                let Some(bytes) = snapshots.decode(context, bytes, length) else { return };
                self.take_snapshot(stream, sequence, bytes, show);
            }
            Frame::CommandState { id, state, reason } => {
                self.commands.answered(now, id, state, self.answer_time());
                show(FromRobot::CommandState { id, state, reason });
            }
            Frame::PartsHere(ref here) => {
                self.commands.parts_here(now, here, self.answer_time());
            }
            Frame::Heard { start, number, newest_ms, held_ms, late_ms }
                if start == self.end.start.generation =>
            {
                self.end.confirm(number);
                self.echo_ms = Some(newest_ms.saturating_sub(late_ms));
                let heard_at = at_ms.saturating_sub(held_ms);
                self.clock.robot_heard(heard_at, newest_ms, now_ms(now));
                let since = now_ms(now).saturating_sub(newest_ms).saturating_sub(held_ms);
                self.round_trip = Some(Duration::from_millis(since));
                self.reached_ms = self.reached_ms.max(Some(newest_ms));
                self.expire_unheard(at_ms, Duration::from_millis(newest_ms), show);
            }
            Frame::Arrived { bytes, longest } => {
                let longest = usize::try_from(longest).unwrap_or(usize::MAX);
                if let Some(echo_ms) = self.echo_ms.take()
                    && self.end.path.report(now, longest, bytes, echo_ms)
                {
                    self.commands.shorten(self.command_bytes_max());
                }
            }
            Frame::NewKey { id, ref key } if id != self.end.key_id() => {
                show(FromRobot::NewKey { id, key: key.clone() });
            }
            Frame::Calendar { began_ms } => self.calendar_ms = Some(began_ms),
            Frame::Value(ref frame) => {
                self.has_news |= matches!(frame, ValueFrame::ValuePart(_));
                self.value_requests.answered(frame, show);
            }
            _ => {}
        }
    }

    /// Expires commands that did not reach the robot in time.
    fn expire_unheard(
        &mut self,
        at_ms: u64,
        heard: Duration,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        let Some(clock) = self.robot_clock(self.now) else { return };
        for id in self.commands.take_unheard(clock.start, at_ms, heard) {
            show(FromRobot::CommandState { id, state: CommandState::Expired, reason: b"" });
        }
    }

    /// Takes a part of an event.
    fn take_large(&mut self, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Large { stream, first, time_before, packing, length, offset, bytes } = *frame
        else {
            return;
        };
        self.has_news = true;
        if self.touch_settled(stream, first) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        if incoming.received.contains(&(first..=first)) {
            return;
        }
        if !incoming.large.has(first, length, packing) {
            self.make_room(length);
        }
        let Some(incoming) = self.incoming(stream) else { return };
        let whole = incoming.large.add((first, length, packing), offset, bytes);
        let Some(items) = whole.and_then(|packed| incoming.unpack(packing, packed)) else { return };
        let (first_sequence, time_before) = (first, time_before);
        let block = EventBlockRef { first_sequence, count: 1, time_before, bytes: &items };
        self.take_events(stream, block, show);
    }

    fn take_status(&mut self, at_ms: u64, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Status { stream, head, is_over, state, chain } = *frame else { return };
        if self.touch_settled(stream, head) {
            if is_over {
                self.streams.end_settled(stream);
            }
        } else {
            let Some(incoming) = self.incoming(stream) else { return };
            incoming.reports = LAST_REPORTS;
            incoming.head = incoming.head.max(head);
            incoming.is_over |= is_over;
            self.has_news = true;
        }
        show(FromRobot::Status { stream, head, is_over, state, chain, at_ms });
    }

    /// Takes a part of a snapshot.
    fn take_snapshot_part(&mut self, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Snapshot { stream, sequence, length, offset, bytes } = *frame else { return };
        if self.touch_settled(stream, sequence) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        if sequence < incoming.snapshot_sequence {
            return;
        }
        if !incoming.snapshot.is_of(sequence, length) {
            self.make_room(length);
        }
        let Some(incoming) = self.incoming(stream) else { return };
        let whole = incoming.snapshot.add(sequence, length, offset, bytes);
        if let Some(bytes) = whole.and_then(|whole| inflate(&whole, LENGTH_MAX as usize)) {
            self.take_snapshot(stream, sequence, bytes, show);
        }
    }

    fn take_snapshot(
        &mut self,
        stream: StreamId,
        sequence: u64,
        bytes: Vec<u8>,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        let codes = self.profile.codes_new();
        let Some(incoming) = self.incoming(stream) else { return };
        if sequence < incoming.snapshot_sequence {
            return;
        }
        incoming.snapshot_sequence = sequence;
        if codes {
            incoming.snapshots.note(sequence, &bytes);
        }
        show(FromRobot::Snapshot { stream, sequence, bytes });
    }

    fn take_coded(&mut self, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Coded { context, length, stream, block } = *frame else { return };
        if self.touch_settled(stream, block.last_sequence()) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        if incoming.received.contains(&block.sequences()) {
            return self.take_events(stream, EventBlockRef { bytes: &[], ..block }, show);
        }
        let Incoming { contexts, coder, .. } = incoming;
        // Events that cannot be decoded after a restart of this side are treated as lost.
        let coder = contexts.find(context).map(|known| coder.with(context, known));
        let bytes = coder.and_then(|coder| coder.decode(block.bytes, length as usize));
        if let Some(bytes) = bytes {
            self.take_events(stream, EventBlockRef { bytes: &bytes, ..block }, show);
        }
    }

    /// The open stream of this number; `None` if too many are open.
    fn incoming(&mut self, stream: StreamId) -> Option<&mut Incoming> {
        self.streams.incoming(self.now, stream)
    }

    /// True if a stream is settled and has this event. Then a report of it is due.
    fn touch_settled(&mut self, stream: StreamId, last: u64) -> bool {
        let is_settled = self.streams.touch_settled(stream, last);
        self.has_news |= is_settled;
        is_settled
    }

    /// Parts of another thing begin to arrive: if too many wait already, they are sent again in their turn.
    fn make_room(&mut self, length: u32) {
        if length > LENGTH_MAX {
            return;
        }
        let waiting = self.streams.open.values();
        let waiting = waiting.map(|it| it.snapshot.length() + it.large.length()).sum::<usize>();
        if waiting + length as usize > PARTS_MAX {
            for incoming in self.streams.open.values_mut() {
                incoming.snapshot = Assembly::default();
                incoming.large.clear();
            }
        }
    }

    fn take_events(
        &mut self,
        stream: StreamId,
        block: EventBlockRef<'_>,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        let codes = self.profile.codes_new();
        self.has_news = true;
        if self.touch_settled(stream, block.last_sequence()) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        let is_scattered = incoming.received.ranges_count() >= GAPS_MAX;
        if is_scattered && incoming.received.end_at(block.first_sequence - 1).is_none() {
            return;
        }
        incoming.head = incoming.head.max(block.last_sequence());
        incoming.reports = LAST_REPORTS;
        if codes && !block.bytes.is_empty() {
            incoming.contexts.note(block);
        }
        if !incoming.received.contains(&block.sequences()) {
            incoming.received.insert(block.sequences());
            show(FromRobot::Events { stream, block });
        }
    }

    /// Sends a command until its fate is known or its time is over.
    pub fn command(&mut self, now: Duration, command: NewCommand) -> Result<(), NotSent> {
        let times = self.times_of(now, &command, self.commands.missing_bytes())?;
        self.command_at(now, command.at(times))
    }

    /// Sends all of these commands, or none of them: then the result has a place for each, with the reason if it cannot be sent.
    pub fn command_all(
        &mut self,
        now: Duration,
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
    pub fn check_all(&self, now: Duration, commands: &[NewCommand]) -> Vec<Result<(), NotSent>> {
        self.times_of_all(now, commands).into_iter().map(|times| times.map(drop)).collect()
    }

    fn times_of_all(
        &self,
        now: Duration,
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
    fn times_of(
        &self,
        now: Duration,
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

    /// The next datagram, if one is due.
    pub fn transmit(&mut self, now: Duration) -> Result<Option<Vec<u8>>, SealError> {
        let before = self.end.heard.before(now);
        let is_heard = before.is_some_and(|before| before < self.profile.silence());
        let room = self.end.path.max() - self.end.overhead(is_heard);
        let mut payload = Vec::new();
        write_number(now_ms(now), &mut payload);
        let empty = payload.len();
        let is_free = self.end.pacer.free_at() <= now;
        self.commands.write(now, is_free, self.answer_time(), (room, &mut payload));
        if is_free && self.report_at() <= now {
            self.write_report(now, room, &mut payload);
            self.value_requests.write_fetches(room, &mut payload);
        }
        if is_free {
            self.value_requests.write_watches(now, self.answer_time(), room, &mut payload);
            // Nothing else waits for the parts of a long command.
            self.commands.write_parts(now, self.answer_time(), room, &mut payload);
        }
        if payload.len() == empty {
            return Ok(None);
        }
        let whom = if is_heard { For::Confirmed } else { For::Anyone };
        self.end.seal(now, whom, &payload).map(Some)
    }

    /// When something may be due next; earlier if anything is received.
    pub fn next_transmit(&self, now: Duration) -> Duration {
        let report = self.report_at().min(self.value_requests.due_at());
        let free_at = self.end.pacer.free_at();
        report.max(free_at).min(self.commands.due_at(free_at)).max(now)
    }

    fn report_at(&self) -> Duration {
        let Profile { report_every, .. } = self.profile;
        let every = if self.has_news { report_every } else { self.profile.report_idle_every() };
        self.reported_at.map_or(Duration::ZERO, |at| at + every)
    }

    /// Earliest time of an answer.
    fn answer_time(&self) -> Duration {
        self.round_trip.unwrap_or_default().max(self.profile.report_every)
    }

    fn write_report(&mut self, now: Duration, room: usize, payload: &mut Vec<u8>) {
        let begun = payload.len();
        if let Some(heard) = self.end.heard.frame(now) {
            heard.write(payload);
        }
        if let Some(arrived) = self.end.heard.arrived() {
            arrived.write(payload);
        }
        if payload.len() > room {
            // Commands need all of this datagram; the report is due again with the next one.
            payload.truncate(begun);
            return;
        }
        self.write_settled(payload.len() + (room - payload.len()) / 2, payload);
        let begun = payload.len();
        let (from, codes) = (self.report_from, self.profile.codes_new());
        self.report_from = StreamId(0);
        let round_trip = self.round_trip.unwrap_or(self.profile.round_trip);
        let streams: Vec<_> = self.streams.open.keys().copied().collect();
        let begin = streams.partition_point(|stream| *stream < from);
        for stream in streams[begin..].iter().chain(&streams[..begin]) {
            let Some(incoming) = self.streams.open.get_mut(stream) else { continue };
            let is_complete = incoming.is_complete();
            if is_complete && incoming.reports == 0 {
                (incoming.contexts, incoming.coder) = (Contexts::default(), LastCoder::default());
                incoming.snapshots = OfferedSnapshots::default();
                continue;
            }
            let length = payload.len();
            let events = incoming.received.clone();
            let is_coded = codes && !is_complete;
            let context = if is_coded { incoming.contexts.offer() } else { None };
            let snapshot = is_coded.then(|| incoming.snapshots.offer(now, round_trip)).flatten();
            incoming.large.drop_received(&incoming.received);
            let partial = if is_complete { Vec::new() } else { incoming.large.report() };
            let stream = *stream;
            let Incoming { safe, is_over, .. } = *incoming;
            let mut received =
                Received { stream, is_over, safe, events, context, snapshot, partial };
            // The first stream has no more room in a later report.
            let is_first = length == begun;
            while !received.write_into(room, payload) && is_first && received.shorten() {}
            if payload.len() == length {
                // Streams without room begin the next report.
                self.report_from = stream;
                break;
            }
            incoming.reports = incoming.reports.saturating_sub(1);
        }
        self.streams.settle_complete();
        (self.reported_at, self.has_news) = (Some(now), false);
    }

    /// Reports settled streams that the robot has named, as far as they fit.
    fn write_settled(&mut self, room: usize, payload: &mut Vec<u8>) {
        for (stream, Settled { events: safe, is_over }) in self.streams.asked() {
            let events = RangeSet::up_to(safe);
            let (context, snapshot, partial) = (None, None, Vec::new());
            let received = Received { stream, is_over, safe, events, context, snapshot, partial };
            if !received.write_into(room, payload) {
                return;
            }
            self.streams.reported(stream);
        }
    }
}

#[cfg(test)]
mod tests;
