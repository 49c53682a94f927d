//! The robot's side of the link: sends what happens, then what the station lacks; receives commands.
//!
//! It sends in this order: what became of commands, new events and the status, values that are watched, a snapshot, then events that
//! the station lacks, oldest first, what the runs need besides, large values that it asked for, and what may be needed some day. Without reports from the station it sends the unreported events round and round, so that a station without an up-link has
//! everything in the end. Events wait, but are never given up: what left the memory is read again from the journal.

mod bulk;
mod coded;
mod large;
mod outgoing;
mod parts;
mod receive;
mod scheduled_commands;
mod snapshots;
mod source;
mod tail;
mod transmit;
mod values;
mod watched;

pub use bulk::Rank;
pub(crate) use scheduled_commands::SCHEDULED_MAX;
pub use source::RunSource;
pub(crate) use watched::WATCH_BYTES_MAX;
pub use watched::{NewestValue, VALUE_BYTES_MAX, WatchSubscription};

use crate::endpoint::{Endpoint, Identity};
use crate::frame::{CommandId, CommandState, EventHash, StreamId};
use crate::profile::Profile;
use crate::seal::{Direction, Generation, Horizon, KeyId, OVERHEAD, PairingKey};
use crate::send_rate::SendRate;
use crate::session_time::SessionTime;
use crate::traffic::Traffic;
use bulk::Bulk;
use outgoing::Outgoing;
use parts::IncompleteCommands;
use rafcon_events::EventBlockRef;
use scheduled_commands::ScheduledCommands;
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;
use values::Values;
use watched::{Behind, WatchedValues};

/// Capacity of the list queue.
const SUBSCRIPTIONS_MAX: usize = 64;
/// Number of times that a fate is sent, unless the command is repeated.
const STATE_SENDS: u8 = 3;
/// Limit of other bytes in a datagram with urgent events.
const URGENT_MAX: usize = 64;
/// Longest reason of a refusal, in bytes.
const REASON_MAX: usize = 240;
/// Capacity of the command history.
const COMMANDS_MAX: usize = 1_024;

/// A command of a station. Its id may come again after a restart of either side: the receiver has to know the ids that it has carried out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReceivedCommand {
    /// Its id.
    pub id: CommandId,
    /// The epoch of authority under which it was given.
    pub epoch: u64,
    /// The last moment at which it may be carried out, in ms of this session.
    pub not_after_ms: u64,
    /// Earliest time of effect on the same clock, or 0.
    pub not_before_ms: u64,
    /// It came too late, or was for an earlier start: it must not be carried out, and only its fate is asked for.
    pub is_late: bool,
    /// The command.
    pub body: Vec<u8>,
}

/// The robot's side: a state machine without sockets and clocks, which its owner polls.
///
/// Received datagrams enter through `handle_datagram`. `poll_transmit` returns datagrams to send, `poll_command` scheduled commands,
/// and `poll_timeout` the time of the next poll. Received commands are passed to the closure of `handle_datagram`, so the session
/// has no event queue that needs a bound.
#[derive(Debug)]
pub struct RobotSession {
    profile: Profile,
    end: Endpoint,
    rate: SendRate,
    sent_at: Option<SessionTime>,
    /// Smallest age of the newest time in a report at its arrival: a round trip plus the delay of the station.
    report_age: Option<Duration>,
    streams: BTreeMap<StreamId, Outgoing>,
    /// In which order what the station lacks of them is sent.
    bulk: Bulk,
    /// Start of this session by the present calendar: ms since 1970, UTC.
    calendar_ms: Option<u64>,
    states: BTreeMap<CommandId, SentState>,
    /// Next key of the station, with the time of the next offer.
    offered: Option<(KeyId, PairingKey, SessionTime)>,
    /// Commands whose time has not come.
    scheduled: ScheduledCommands,
    incomplete: IncompleteCommands,
    /// The ids in `states`, oldest first.
    ids: VecDeque<CommandId>,
    watched: WatchedValues,
    subscriptions: VecDeque<WatchSubscription>,
    values: Values,
}

#[derive(Debug)]
struct SentState {
    state: CommandState,
    reason: Vec<u8>,
    sends: u8,
    due: SessionTime,
}

impl RobotSession {
    /// A session that begins now.
    pub fn new(identity: &Identity<'_>, profile: Profile) -> Self {
        Self {
            end: Endpoint::new(identity, Direction::Down, &profile),
            rate: SendRate::new(&profile),
            sent_at: None,
            report_age: None,
            streams: BTreeMap::new(),
            bulk: Bulk::default(),
            calendar_ms: None,
            states: BTreeMap::new(),
            offered: None,
            scheduled: ScheduledCommands::default(),
            incomplete: IncompleteCommands::default(),
            ids: VecDeque::new(),
            watched: WatchedValues::new(&profile),
            subscriptions: VecDeque::new(),
            values: Values::default(),
            profile,
        }
    }

    /// A run that has events up to `head` in its journal.
    pub fn begin(&mut self, stream: StreamId, head: u64) {
        let first_report_at = SessionTime::after(self.profile.round_trip);
        let begun = || Outgoing::new(stream, head).repeated_from(first_report_at);
        self.streams.entry(stream).or_insert_with(begun);
    }

    /// When what the station lacks of this stream is sent, beside that of others.
    pub fn set_rank(&mut self, stream: StreamId, rank: Rank) {
        self.bulk.set_rank(stream, rank);
        if let (Rank::Description, Some(stream)) = (rank, self.streams.get_mut(&stream)) {
            stream.set_description();
        }
    }

    /// The station may have all of this stream from earlier starts: it is asked before anything is sent.
    pub fn ask_first(&mut self, stream: StreamId) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.ask_first();
        }
    }

    /// Nothing more of this stream is sent.
    pub fn end(&mut self, stream: StreamId) {
        self.streams.remove(&stream);
        self.bulk.forget(stream);
        self.watched.forget(stream);
    }

    /// True if the station has reported a stream as over and complete, and has received the hash of its events if one is set.
    pub fn is_complete(&self, stream: StreamId) -> bool {
        self.streams.get(&stream).is_some_and(Outgoing::is_complete)
    }

    /// True if the station has reported a stream as over.
    pub fn is_end_known(&self, stream: StreamId) -> bool {
        self.streams.get(&stream).is_some_and(Outgoing::is_end_known)
    }

    /// Number of the station's newest known start.
    pub fn station_start(&self) -> Option<Generation> {
        self.end.horizon().map(|heard| heard.start.generation)
    }

    /// New events of a run, which are on the disk. Best one at a time: those that are together too long for one datagram do not go
    /// ahead of the older ones.
    pub fn append(&mut self, stream: StreamId, block: EventBlockRef<'_>) {
        let room = self.end.path.max() - OVERHEAD - URGENT_MAX;
        let outgoing = self.streams.entry(stream);
        outgoing.or_insert_with(|| Outgoing::new(stream, 0)).append(block, room);
    }

    /// The run has events up to `head` in its journal; those that are new go in their turn.
    pub fn advance(&mut self, stream: StreamId, head: u64) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.advance(head);
        }
    }

    /// Sets the snapshot of a run, and if it is over.
    pub fn set_state(&mut self, stream: StreamId, state: &[u8], is_over: bool) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.set_state(state, is_over);
        }
    }

    /// All events of a run up to one of the newest have this hash.
    pub fn set_chain(&mut self, stream: StreamId, chain: EventHash) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.set_chain(chain);
        }
    }

    /// The source has a newer snapshot of a run: it is sent when the rate allows it.
    pub fn set_snapshot_changed(&mut self, stream: StreamId) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.set_snapshot_changed();
        }
    }

    /// Sets the present time of the robot's calendar, in ms since 1970, UTC. It may jump.
    pub fn set_calendar(&mut self, now: SessionTime, since_1970_ms: u64) {
        self.calendar_ms = Some(since_1970_ms.saturating_sub(now.as_millis()));
    }

    /// Sets the fate of a command, with the reason of a refusal.
    pub fn set_command_state(
        &mut self,
        now: SessionTime,
        id: CommandId,
        state: CommandState,
        reason: &str,
    ) {
        let end = reason.floor_char_boundary(REASON_MAX);
        let reason = reason.as_bytes()[..end].to_vec();
        if self.states.insert(id, SentState { state, reason, sends: 0, due: now }).is_none() {
            self.ids.push_back(id);
            while self.ids.len() > COMMANDS_MAX
                && let Some(oldest) = self.ids.pop_front()
            {
                if self.scheduled.has(oldest) {
                    self.ids.push_back(oldest);
                } else {
                    self.states.remove(&oldest);
                }
            }
        }
    }

    /// Offers a stored key to the station. Both sides use the previous one until the station switches.
    pub fn offer_key(&mut self, id: KeyId, key: &PairingKey) {
        self.end.add_key(id, key);
        self.offered = Some((id, key.clone(), SessionTime::BEGIN));
    }

    /// True if the station uses the offered key.
    pub fn is_offer_taken(&self) -> bool {
        let offered = self.offered.as_ref().map(|(id, ..)| *id);
        offered.is_some() && offered == self.end.heard_key()
    }

    /// Uses the key that was offered, which is this side's own on the disk now.
    pub fn use_offered(&mut self) {
        if let Some((id, ..)) = self.offered.take() {
            self.end.use_key(id);
        }
    }

    /// The key with which this side seals.
    pub fn key_id(&self) -> KeyId {
        self.end.key_id()
    }

    /// Returns the next complete list of watched values.
    pub fn take_subscription(&mut self) -> Option<WatchSubscription> {
        self.subscriptions.pop_front()
    }

    /// Confirms the list in force, so that its values can be set.
    pub fn set_subscription(&mut self, stream: StreamId, number: u64) {
        if self.streams.contains_key(&stream) {
            self.watched.count(stream, number);
        }
    }

    /// Sets the newest of a watched value. `key` identifies it within its run.
    pub fn set_watched(&mut self, stream: StreamId, key: u32, value: NewestValue) {
        self.watched.set(stream, key, value);
    }

    /// True if values of a run are sent in addition to its events, so that a search for them is useful.
    pub fn needs_watched(&self, now: SessionTime, stream: StreamId) -> bool {
        let behind = self.behind(stream, self.is_heard(now));
        !behind.is_heard || behind.from.is_some()
    }

    fn behind(&self, stream: StreamId, is_heard: bool) -> Behind {
        let from = self.streams.get(&stream).and_then(Outgoing::lacks_from);
        Behind { is_heard, from }
    }

    /// Latest state of the station, for the disk.
    pub fn horizon(&self) -> Option<Horizon> {
        self.end.horizon()
    }

    /// Time since the last datagram of the station.
    pub fn heard_before(&self, now: SessionTime) -> Option<Duration> {
        self.end.heard.before(now)
    }

    /// Limit of datagrams in bytes, if the path drops some that are as long as the profile allows.
    pub fn shortened_datagrams(&self) -> Option<usize> {
        self.end.path.shortened()
    }

    /// Send rate in bits per second: at most that of the profile, less on a link that carries less by the station's reports.
    pub fn send_rate(&self) -> u64 {
        self.rate.bits_per_s()
    }

    /// Datagrams and bytes sent and received.
    pub fn traffic(&self) -> (&Traffic, &Traffic) {
        self.end.traffic()
    }

    /// The number of the last event of a run, and how many of all the station did not report.
    pub fn progress(&self, stream: StreamId) -> Option<(u64, u64)> {
        self.streams.get(&stream).map(Outgoing::progress)
    }

    /// True if reports of the station arrive.
    pub fn is_heard(&self, now: SessionTime) -> bool {
        self.end.heard.before(now).is_some_and(|before| before < self.profile.silence())
    }
}

#[cfg(test)]
mod bound_tests;
#[cfg(test)]
mod tests;
