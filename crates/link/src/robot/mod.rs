//! The robot's side of the link: sends what happens, then what the station lacks; receives commands.
//!
//! It sends in this order: what became of commands, new events and the status, a snapshot, then events that the station lacks, oldest
//! first. Without reports from the station it sends the unreported events round and round, so that a station without an up-link has
//! everything in the end. Events wait, but are never given up: what left the memory is read again from the journal.

mod outgoing;
mod source;
mod tail;

pub use source::{EventBuffer, RunSource};

use crate::bytes::write_number;
use crate::endpoint::{Arrived, Endpoint, Identity, Unusable};
use crate::frame::{CommandId, CommandState, Frame, Received, StreamId};
use crate::profile::Profile;
use crate::seal::{Direction, Horizon, OVERHEAD, SealError};
use crate::traffic::Traffic;
use outgoing::{Outgoing, Turn};
use std::collections::BTreeMap;
use std::time::Duration;

/// What became of a command is sent this often, unless the command comes again.
const STATE_SENDS: u8 = 3;
/// So many bytes besides events are in a datagram at most, if it has events that are urgent.
const URGENT_MAX: usize = 64;
/// So many bytes of the reason of a refusal are sent.
const REASON_MAX: usize = 240;
/// So many commands are remembered.
const COMMANDS_MAX: usize = 1_024;

/// A command that is to be carried out now. Its id may come again after a restart: whoever carries it out knows the ids.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReceivedCommand {
    /// Its id.
    pub id: CommandId,
    /// The epoch of authority under which it was given.
    pub epoch: u64,
    /// The last moment at which it may be carried out, in ms of this session.
    pub not_after_ms: u64,
    /// The command.
    pub body: Vec<u8>,
}

/// The robot's side.
#[derive(Debug)]
pub struct RobotSession {
    profile: Profile,
    end: Endpoint,
    streams: BTreeMap<StreamId, Outgoing>,
    /// What the calendar said when this session began, as it is set now: ms since 1970, UTC.
    calendar_ms: Option<u64>,
    states: BTreeMap<CommandId, SentState>,
    /// The ids in `states`, oldest first.
    ids: std::collections::VecDeque<CommandId>,
}

#[derive(Debug)]
struct SentState {
    state: CommandState,
    reason: Vec<u8>,
    sends: u8,
    due: Duration,
}

impl RobotSession {
    /// A session from now on. Times are those since its begin, by a clock that never goes back.
    pub fn new(identity: &Identity<'_>, profile: Profile) -> Self {
        Self {
            end: Endpoint::new(identity, Direction::Down, profile.down_bits_per_s),
            streams: BTreeMap::new(),
            calendar_ms: None,
            states: BTreeMap::new(),
            ids: std::collections::VecDeque::new(),
            profile,
        }
    }

    /// A run that has events up to `head` in its journal.
    pub fn begin(&mut self, stream: StreamId, head: u64) {
        self.streams.entry(stream).or_insert_with(|| Outgoing::new(stream, head));
    }

    /// New events of a run, which are on the disk. Best one at a time: those that are together too long for one datagram do not go
    /// ahead of the older ones.
    pub fn append(&mut self, events: &crate::frame::Events<'_>) {
        let room = self.profile.down_bytes_max - OVERHEAD - URGENT_MAX;
        let stream = self.streams.entry(events.stream);
        stream.or_insert_with(|| Outgoing::new(events.stream, 0)).append(events, room);
    }

    /// The run has events up to `head` in its journal; those that are new go in their turn.
    pub fn advance(&mut self, stream: StreamId, head: u64) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.advance(head);
        }
    }

    /// What of a run is to be known at a glance, and whether it is over.
    pub fn set_state(&mut self, stream: StreamId, state: &[u8], is_over: bool) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.set_state(state, is_over);
        }
    }

    /// The source has a newer snapshot of a run: it is sent when the rate allows it.
    pub fn set_snapshot_changed(&mut self, stream: StreamId) {
        if let Some(stream) = self.streams.get_mut(&stream) {
            stream.set_snapshot_changed();
        }
    }

    /// The robot's calendar says this now, in ms since 1970, UTC. It may jump.
    pub fn set_calendar(&mut self, now: Duration, since_1970_ms: u64) {
        self.calendar_ms = Some(since_1970_ms.saturating_sub(now_ms(now)));
    }

    /// What became of a command; why, if it was refused.
    pub fn set_command_state(
        &mut self,
        now: Duration,
        id: CommandId,
        state: CommandState,
        reason: &str,
    ) {
        let end = reason.floor_char_boundary(REASON_MAX);
        let reason = reason.as_bytes()[..end].to_vec();
        if self.states.insert(id, SentState { state, reason, sends: 0, due: now }).is_none() {
            self.ids.push_back(id);
            if self.ids.len() > COMMANDS_MAX
                && let Some(oldest) = self.ids.pop_front()
            {
                self.states.remove(&oldest);
            }
        }
    }

    /// What was heard of the station last, for the disk.
    pub fn horizon(&self) -> Option<Horizon> {
        self.end.horizon()
    }

    /// How long ago the station was heard.
    pub fn heard_before(&self, now: Duration) -> Option<Duration> {
        self.end.heard.before(now)
    }

    /// What was sent and received.
    pub fn traffic(&self) -> (&Traffic, &Traffic) {
        self.end.traffic()
    }

    /// The number of the last event of a run, and how many of all the station did not report.
    pub fn progress(&self, stream: StreamId) -> Option<(u64, u64)> {
        self.streams.get(&stream).map(Outgoing::progress)
    }

    /// Takes a datagram; passes on each command that is to be carried out, once in this start.
    pub fn receive(
        &mut self,
        now: Duration,
        datagram: &mut [u8],
        mut carry_out: impl FnMut(ReceivedCommand),
    ) -> Result<(), Unusable> {
        let Arrived { frames, .. } = self.end.open(now, datagram)?;
        let (mut echo, mut reports) = (None, Vec::new());
        for frame in frames {
            match frame? {
                Frame::Heard { start, newest_ms, late_ms, .. } if start == self.end.start => {
                    echo = Some((newest_ms, late_ms));
                }
                Frame::Received(received) => reports.push(received),
                Frame::Command(command) => {
                    if let Some(state) = self.states.get_mut(&command.id) {
                        (state.sends, state.due) = (0, now);
                        continue;
                    }
                    let is_late = command.robot_start != self.end.start
                        || now.as_millis() > u128::from(command.not_after_ms);
                    let state =
                        if is_late { CommandState::Expired } else { CommandState::Received };
                    let (id, epoch, not_after_ms) =
                        (command.id, command.epoch, command.not_after_ms);
                    if !is_late {
                        let body = command.body.to_vec();
                        carry_out(ReceivedCommand { id, epoch, not_after_ms, body });
                    }
                    self.set_command_state(now, id, state, "");
                }
                _ => {}
            }
        }
        self.report(now, echo, reports);
        Ok(())
    }

    fn report(&mut self, now: Duration, echo: Option<(u64, u64)>, reports: Vec<Received>) {
        for received in reports {
            if let Some(stream) = self.streams.get_mut(&received.stream) {
                stream.report(now, received, echo, &self.profile);
            }
        }
    }

    /// The next datagram, if one is due.
    pub fn transmit(
        &mut self,
        now: Duration,
        source: &mut impl RunSource,
    ) -> Result<Option<Vec<u8>>, SealError> {
        let is_heard = self.is_heard(now);
        let is_urgent = self.urgent_at(is_heard) <= now;
        // An urgent datagram may leave somewhat before its turn, so that it does not wait behind bulk.
        let may_send =
            self.end.pacer.free_at() <= now + if is_urgent { self.slack() } else { Duration::ZERO };
        if !may_send {
            return Ok(None);
        }
        let room = self.profile.down_bytes_max - OVERHEAD;
        let mut payload = Vec::with_capacity(room);
        write_number(now_ms(now), &mut payload);
        let empty = payload.len();
        self.write_states(now, room, &mut payload);
        let turn = Turn { now, profile: &self.profile, is_heard, room };
        let mut shows_status = false;
        for stream in self.streams.values_mut() {
            shows_status |= stream.write_urgent(turn, &mut payload);
        }
        if shows_status {
            let calendar = self.calendar_ms.map(|began_ms| Frame::Calendar { began_ms });
            for frame in [self.end.heard.frame(now), calendar].into_iter().flatten() {
                frame.write(&mut payload);
            }
        }
        if self.end.pacer.free_at() <= now {
            for stream in self.streams.values_mut() {
                stream.write_bulk(turn, source, &mut payload);
            }
        }
        if payload.len() == empty {
            return Ok(None);
        }
        self.end.seal(now, &payload).map(Some)
    }

    /// When something may be due next; earlier if anything is received or appended.
    pub fn next_transmit(&self, now: Duration) -> Duration {
        let is_heard = self.is_heard(now);
        let free_at = self.end.pacer.free_at();
        let urgent = self.urgent_at(is_heard).max(free_at.saturating_sub(self.slack()));
        let bulk = self.streams.values().map(|stream| stream.bulk_at(is_heard, &self.profile));
        bulk.min().map_or(urgent, |bulk| bulk.max(free_at).min(urgent)).max(now)
    }

    fn urgent_at(&self, is_heard: bool) -> Duration {
        let states = self.states.values().filter(|state| state.sends < STATE_SENDS);
        let states = states.map(|state| state.due).min().unwrap_or(Duration::MAX);
        let streams = self.streams.values().map(|stream| stream.urgent_at(&self.profile, is_heard));
        streams.min().unwrap_or(Duration::MAX).min(states)
    }

    fn is_heard(&self, now: Duration) -> bool {
        self.end.heard.before(now).is_some_and(|before| before < self.profile.silence())
    }

    /// How long two full datagrams take.
    fn slack(&self) -> Duration {
        let bits = self.profile.down_bytes_max as u64 * 2 * 8;
        Duration::from_nanos(bits * 1_000_000_000 / self.profile.down_bits_per_s)
    }

    fn write_states(&mut self, now: Duration, room: usize, payload: &mut Vec<u8>) {
        let due =
            self.states.iter_mut().filter(|(_, sent)| sent.sends < STATE_SENDS && sent.due <= now);
        for (id, sent) in due {
            let length = payload.len();
            let SentState { state, reason, .. } = &*sent;
            Frame::CommandState { id: *id, state: *state, reason }.write(payload);
            if payload.len() > room {
                payload.truncate(length);
                break;
            }
            sent.sends += 1;
            sent.due = now + self.profile.repeat_after;
        }
    }
}

pub(crate) fn now_ms(now: Duration) -> u64 {
    u64::try_from(now.as_millis()).unwrap_or(u64::MAX)
}
