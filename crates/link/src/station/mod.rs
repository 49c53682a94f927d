//! The station's side of the link: receives what happens, reports what it has, sends commands.

mod admission;
mod command_parts;
mod commands;
mod from_robot;
mod incoming;
mod large;
mod receive;
mod report;
mod restored;
mod streams;
mod value_requests;

pub use commands::{COMMANDS_MAX, CommandProgress, NewCommand, NotSent, RobotTimes, TimedCommand};
pub use from_robot::FromRobot;
#[cfg(test)]
pub(crate) use incoming::{GAPS_MAX, PARTS_MAX};
pub(crate) use large::LARGE_MAX;
#[cfg(test)]
pub(crate) use streams::OPEN_MAX;
pub use streams::StreamProgress;
pub use value_requests::{FetchProgress, NotWatched};

use crate::endpoint::{Endpoint, Identity};
use crate::frame::{CommandId, StreamId};
use crate::heard::{ClockBounds, RobotClock};
use crate::payload_writer::PayloadWriter;
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::seal::{Direction, For, Horizon, KeyId, PairingKey, SealError};
use crate::session_time::SessionTime;
use crate::traffic::Traffic;
use commands::Commands;
use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::time::Duration;
use streams::Streams;
use value_requests::ValueRequests;

/// Part of a command's lifetime that no link needs: the time of a runner that is busy.
const COMMAND_TIME: Duration = Duration::from_secs(10);

/// The station's side: a state machine without sockets and clocks, which its owner polls.
///
/// Received datagrams enter through `handle_datagram`. `poll_transmit` returns datagrams to send, and `poll_timeout` the time of the
/// next poll. Received events are passed to the closure of `handle_datagram`: they borrow from the datagram, and a queue for a
/// `poll_event` would copy them.
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
    now: SessionTime,
    streams: Streams,
    /// The stream that begins the next report.
    report_from: StreamId,
    reported_at: Option<SessionTime>,
    has_news: bool,
    commands: Commands,
    value_requests: ValueRequests,
}

impl StationSession {
    /// A session that begins now.
    pub fn new(identity: &Identity<'_>, profile: Profile) -> Self {
        Self {
            end: Endpoint::new(identity, Direction::Up, &profile),
            clock: RobotClock::default(),
            round_trip: None,
            reached_ms: None,
            echo_ms: None,
            calendar_ms: None,
            now: SessionTime::BEGIN,
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
    pub fn is_crowded(&self, now: SessionTime) -> bool {
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
    pub fn heard_before(&self, now: SessionTime) -> Option<Duration> {
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
    pub fn command_lifetime(&self, now: SessionTime) -> Duration {
        let round_trip = self.round_trip.unwrap_or(self.profile.round_trip);
        let clock = self.robot_clock(now).and_then(|clock| {
            Some(Duration::from_millis(clock.latest_ms?.saturating_sub(clock.earliest_ms)))
        });
        round_trip * 2 + clock.unwrap_or(round_trip) + COMMAND_TIME
    }

    /// Age of the last datagram that the robot has acknowledged. `None` without any.
    pub fn reached_before(&self, now: SessionTime) -> Option<Duration> {
        self.reached_ms.map(|at| now.since(SessionTime::from_millis(at)))
    }

    /// The robot's calendar, at least and at most, in ms since 1970, UTC.
    pub fn robot_calendar(&self, now: SessionTime) -> Option<(u64, Option<u64>)> {
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
    pub fn take_overdue(&mut self, now: SessionTime) -> Vec<CommandId> {
        self.commands.take_overdue(self.clock.bounds(now.as_millis()))
    }

    /// Between which times the robot's clock is.
    pub fn robot_clock(&self, now: SessionTime) -> Option<ClockBounds> {
        self.clock.bounds(now.as_millis())
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

    /// The next datagram, if one is due.
    pub fn poll_transmit(&mut self, now: SessionTime) -> Result<Option<Vec<u8>>, SealError> {
        let before = self.end.heard.before(now);
        let is_heard = before.is_some_and(|before| before < self.profile.silence());
        let room = self.end.path.max() - self.end.overhead(is_heard);
        let mut payload = PayloadWriter::new(now, room);
        let is_free = self.end.pacer.free_at() <= now;
        self.commands.write(now, is_free, self.answer_time(), &mut payload);
        if is_free && self.report_at() <= now {
            self.write_report(now, &mut payload);
            self.value_requests.write_fetches(&mut payload);
        }
        if is_free {
            self.value_requests.write_watches(now, self.answer_time(), &mut payload);
            // Nothing else waits for the parts of a long command.
            self.commands.write_parts(now, self.answer_time(), &mut payload);
        }
        if payload.is_empty() {
            return Ok(None);
        }
        let whom = if is_heard { For::Confirmed } else { For::Anyone };
        self.end.seal(now, whom, &payload).map(Some)
    }

    /// When something may be due next; earlier if anything is received. `None` if never.
    pub fn poll_timeout(&self, now: SessionTime) -> Option<SessionTime> {
        let free_at = self.end.pacer.free_at();
        let report = self.report_at().or_earlier([self.value_requests.due_at()]).max(free_at);
        Some(report.or_earlier([self.commands.due_at(free_at)]).max(now))
    }

    /// Earliest time of an answer.
    fn answer_time(&self) -> Duration {
        self.round_trip.unwrap_or_default().max(self.profile.report_every)
    }
}

#[cfg(test)]
mod tests;
