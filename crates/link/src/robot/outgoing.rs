//! Outgoing events of one run, with the robot's view of the station's copy.

mod backfill;

use super::coded::Coding;
use super::large::LargeEvent;
use super::snapshots::Snapshots;
use super::source::RunSource;
use super::tail::{self, Tail};
use crate::assembly::PART_MIN;
use crate::frame::{EventHash, Frame, Received, StreamId, block_bytes_max};
use crate::loss_rate::LossRate;
use crate::payload_writer::PayloadWriter;
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::session_time::SessionTime;
use rafcon_events::EventBlockRef;
use std::collections::VecDeque;
use std::ops::RangeInclusive;
use std::time::Duration;

/// The status is sent this often beside events, from which the station knows the head, in status intervals.
const STATUS_BESIDE: u32 = 8;
/// Number of lost events from which a snapshot arrives sooner than they do.
const SNAPSHOT_LOST: u64 = 64;

/// Events that were sent and are not reported.
#[derive(Debug)]
struct SentEvents {
    at: SessionTime,
    range: RangeInclusive<u64>,
    /// Number of repetitions before a report shows a loss.
    repeats: u8,
    /// They are of use only to a station that knows the context by which they are coded.
    is_coded: bool,
}

/// Conditions under which a datagram is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct TransmitContext<'p> {
    pub(super) now: SessionTime,
    pub(super) profile: &'p Profile,
    /// True if the station sends reports.
    pub(super) is_heard: bool,
}

/// A run on its way to the station.
#[derive(Debug)]
pub(super) struct Outgoing {
    id: StreamId,
    head: u64,
    is_over: bool,
    content: Content,
    state: Vec<u8>,
    is_state_new: bool,
    /// Hash of the events up to a recent one.
    chain: Option<EventHash>,
    chain_told: ChainTold,
    tail: Tail,
    /// When anything was sent from which the station knows the head.
    shown_at: Option<SessionTime>,
    status_at: Option<SessionTime>,
    /// Events at the station, by its last report.
    received: RangeSet,
    /// The station knows that the run has ended.
    knows_end: bool,
    /// Sent events without a report, by time.
    sent: VecDeque<SentEvents>,
    sent_set: RangeSet,
    /// When the unreported events are sent again, for a station that cannot report.
    round_due: SessionTime,
    /// The source could not read events: it is asked again then.
    read_again_at: SessionTime,
    snapshots: Snapshots,
    /// Events that were sent in parts, the last one at the end, until the station reports them.
    large: VecDeque<LargeEvent>,
    /// Events up to this one are sent more often, because they were missing in large numbers.
    backlog: u64,
    /// Datagrams in a row that had too little room for the next event: up to the present one, and up to the one before.
    waited: u8,
    waited_before: u8,
    /// The queue that the last datagram began with.
    served_first: Served,
    coding: Coding,
    /// Number of times that events are sent to repair losses without a round trip.
    sends: u8,
    /// True if a report is requested before the first events.
    asks: Asks,
}

/// Content of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Content {
    Events,
    /// Its beginning is repeated while the station cannot report that it has lost it.
    Description,
}

/// Progress of the newest hash to the station.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ChainTold {
    No,
    /// First sent at this time, not reported yet.
    Sent(SessionTime),
    Yes,
}

/// True if a report is requested before the first events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Asks {
    No,
    Yes,
    /// It has not answered since.
    Since(SessionTime),
}

/// Events of the lower queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Served {
    Events,
    /// Parts of one event.
    Parts,
}

impl Outgoing {
    pub(super) fn new(id: StreamId, head: u64) -> Self {
        Self {
            id,
            head,
            is_over: false,
            content: Content::Events,
            state: Vec::new(),
            is_state_new: false,
            chain: None,
            chain_told: ChainTold::No,
            tail: Tail::new(id),
            shown_at: None,
            status_at: None,
            received: RangeSet::default(),
            knows_end: false,
            sent: VecDeque::new(),
            sent_set: RangeSet::default(),
            round_due: SessionTime::BEGIN,
            read_again_at: SessionTime::BEGIN,
            snapshots: Snapshots::new(),
            large: VecDeque::new(),
            backlog: 0,
            waited: 0,
            waited_before: 0,
            served_first: Served::Parts,
            coding: Coding::default(),
            sends: LossRate::default().sends(),
            asks: Asks::No,
        }
    }

    /// Repeats files without a report only after the first report should have arrived: they are long and never urgent.
    pub(super) fn repeated_from(mut self, first_report_at: SessionTime) -> Self {
        if self.id.is_files() {
            self.round_due = first_report_at;
        }
        self
    }

    /// The station may have all of it: it is asked before anything is sent.
    pub(super) fn ask_first(&mut self) {
        self.asks = Asks::Yes;
    }

    /// Datagrams have become shorter: events that do not fit into one are sent in parts, from the journal.
    pub(super) fn datagrams_shortened(&mut self) {
        self.tail = Tail::new(self.id);
    }

    pub(super) fn set_description(&mut self) {
        self.content = Content::Description;
    }

    /// The losses need this number of sends.
    pub(super) fn set_sends(&mut self, sends: u8) {
        self.sends = sends;
    }

    /// Number of times that new events are sent.
    fn tail_sends(&self, is_heard: bool) -> u8 {
        if is_heard { self.sends } else { self.sends.max(tail::SENDS_UNHEARD) }
    }

    /// Until when the answer is waited for.
    fn waits_until(&self, profile: &Profile) -> SessionTime {
        match self.asks {
            Asks::No | Asks::Yes => SessionTime::BEGIN,
            Asks::Since(at) => at + profile.silence(),
        }
    }

    pub(super) fn advance(&mut self, head: u64) {
        if head > self.head {
            (self.head, self.tail) = (head, Tail::new(self.id));
        }
    }

    pub(super) fn append(&mut self, block: EventBlockRef<'_>, room: usize) {
        let EventBlockRef { first_sequence, time_before, bytes, .. } = block;
        let continues = first_sequence == self.head + 1;
        self.head = self.head.max(block.last_sequence());
        let fits = bytes.len() <= block_bytes_max(room, first_sequence, time_before);
        if continues && fits {
            self.tail.append(block);
        } else {
            // Events that are missing here or too long are read from the journal, and those before them are repeated from there.
            let unrepeated = self.tail.unrepeated(self.sends);
            for sent in &mut self.sent {
                let is_among = unrepeated.is_some_and(|first| *sent.range.end() >= first);
                sent.repeats = sent.repeats.max(u8::from(is_among));
            }
            self.tail = Tail::new(self.id);
        }
    }

    #[cfg(test)]
    pub(super) fn tail_holds(&self, sequence: u64) -> bool {
        self.tail.continues(sequence - 1, self.head)
    }

    /// The source has a newer snapshot than before.
    pub(super) fn set_snapshot_changed(&mut self) {
        self.snapshots.set_changed();
    }

    pub(super) fn set_state(&mut self, state: &[u8], is_over: bool) {
        if self.state != state || self.is_over != is_over {
            (self.state, self.is_over) = (state.to_vec(), is_over);
            self.is_state_new = true;
        }
    }

    /// Sets the hash of the events up to here, for the next status.
    pub(super) fn set_chain(&mut self, chain: EventHash) {
        (self.chain, self.chain_told) = (Some(chain), ChainTold::No);
    }

    /// True if a run is over and its hash is not known to have arrived.
    fn is_chain_due(&self) -> bool {
        self.is_over && self.chain.is_some() && self.chain_told != ChainTold::Yes
    }

    /// The station has started again: it may have less than it reported, and is asked by the status. It knows no context of the start
    /// before, so what is on its way by one of them is lost.
    pub(super) fn station_started(&mut self) {
        (self.knows_end, self.is_state_new) = (false, true);
        self.chain_told = ChainTold::No;
        self.coding.offer(None);
        self.snapshots.offer(None);
        self.large.clear();
        self.sent.retain(|sent| !sent.is_coded);
        self.renew_sent_set();
    }

    /// Applies a report of the station. `echo` is the newest time that it received, with the delay of reordered datagrams.
    pub(super) fn report(
        &mut self,
        now: SessionTime,
        received: Received,
        echo: Option<(u64, u64)>,
        profile: &Profile,
    ) {
        self.received = received.events;
        let is_here = |number: u64| self.received.contains(&(number..=number));
        self.large.retain(|event| !is_here(event.number()));
        self.large.iter_mut().for_each(|event| event.report(&received.partial));
        self.coding.offer(received.context);
        self.snapshots.offer(received.snapshot);
        self.knows_end = received.is_over;
        self.asks = Asks::No;
        let Some((newest_ms, late_ms)) = echo else { return };
        if matches!(self.chain_told, ChainTold::Sent(at) if at.as_millis() <= newest_ms) {
            self.chain_told = ChainTold::Yes;
        }
        // Earlier events without a report are lost. A repetition may still repair the newest of them.
        let late = Duration::from_millis(late_ms) + profile.repeat_after * u32::from(self.sends);
        let lost_before = SessionTime::from_millis(newest_ms) - late;
        let (before, unreported) = (self.sent.len(), &self.received);
        self.sent.retain(|sent| !unreported.contains(&sent.range));
        let mut lost = 0;
        self.sent.retain(|sent| {
            let is_lost = sent.at < lost_before;
            lost += if is_lost { sent.range.end() - sent.range.start() + 1 } else { 0 };
            !is_lost
        });
        if lost > SNAPSHOT_LOST {
            self.snapshots.need_now();
        }
        if self.sent.len() < before {
            self.renew_sent_set();
        }
        self.round_due = now;
    }

    fn renew_sent_set(&mut self) {
        self.sent_set = self.sent.iter().map(|sent| sent.range.clone()).collect();
        if let Some(number) = self.sending_in_parts() {
            self.sent_set.insert(number..=number);
        }
    }

    /// The event that is being sent in parts.
    fn sending_in_parts(&self) -> Option<u64> {
        self.large.back().filter(|event| event.is_sending()).map(LargeEvent::number)
    }

    pub(super) fn has_all(&self) -> bool {
        self.is_over && self.knows_end && self.received.contiguous() >= self.head
    }

    /// True if the station has all, and the hash if there is one.
    pub(super) fn is_complete(&self) -> bool {
        self.has_all() && !self.is_chain_due()
    }

    pub(super) fn is_end_known(&self) -> bool {
        self.is_over && self.knows_end
    }

    /// When the status or new events are due.
    pub(super) fn urgent_at(&self, profile: &Profile, is_heard: bool) -> Option<SessionTime> {
        let status = match (self.shown_at, self.status_at) {
            _ if self.is_state_new => Some(SessionTime::BEGIN),
            // The station reports that it has all: nothing is new ever after.
            _ if self.is_complete() => None,
            _ if self.has_all() && self.chain_told == ChainTold::No => Some(SessionTime::BEGIN),
            // There is nothing to see of files.
            (Some(shown), Some(_)) if self.id.is_files() => {
                Some(shown + profile.status_every * STATUS_BESIDE)
            }
            (Some(shown), Some(status)) => {
                let beside_at = status + profile.status_every * STATUS_BESIDE;
                Some(beside_at.min(shown + profile.status_every))
            }
            _ => Some(SessionTime::BEGIN),
        };
        SessionTime::earliest([self.tail.due_at(profile, self.tail_sends(is_heard)), status])
    }

    /// Writes the status and the newest events if they are due. Returns whether it wrote the status.
    pub(super) fn write_urgent(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) -> bool {
        let TransmitContext { now, profile, is_heard } = turn;
        if self.urgent_at(profile, is_heard).is_none_or(|at| at > now) {
            return false;
        }
        self.coding.renew(self.id, self.head, source);
        self.write_tail(turn, payload);
        let status_due =
            self.status_at.is_none_or(|at| at + profile.status_every * STATUS_BESIDE <= now);
        let head_known = self.shown_at == Some(now);
        if head_known && !status_due && !self.is_state_new {
            return false;
        }
        let frame = Frame::Status {
            stream: self.id,
            head: self.head,
            is_over: self.is_over,
            state: &self.state,
            chain: self.chain,
        };
        if !payload.try_frame(&frame) {
            return false;
        }
        (self.status_at, self.shown_at, self.is_state_new) = (Some(now), Some(now), false);
        if self.chain.is_some() && self.chain_told == ChainTold::No {
            self.chain_told = ChainTold::Sent(now);
        }
        true
    }

    fn write_tail(&mut self, turn: TransmitContext<'_>, payload: &mut PayloadWriter) {
        let sends_max = self.tail_sends(turn.is_heard);
        let written = self.tail.write(sends_max, turn, &mut self.coding, payload);
        let Some(written) = written else {
            return;
        };
        self.shown_at = Some(turn.now);
        if let Some(new) = written.new {
            let (at, is_coded) = (turn.now, written.is_coded);
            self.note_sent(SentEvents { at, range: new, repeats: 0, is_coded });
        }
    }

    fn note_sent(&mut self, events: SentEvents) {
        self.sent_set.insert(events.range.clone());
        match self.sent.back_mut() {
            Some(last)
                if (last.at, last.repeats, last.is_coded)
                    == (events.at, events.repeats, events.is_coded)
                    && last.range.end() + 1 == *events.range.start() =>
            {
                last.range = *last.range.start()..=*events.range.end();
            }
            _ => self.sent.push_back(events),
        }
    }

    /// The oldest events that neither are with the station nor on their way.
    fn gap(&self) -> Option<RangeInclusive<u64>> {
        // New events go with the next urgent datagram.
        let last = self.tail.first_unsent().map_or(self.head, |first| first - 1);
        self.received.first_gap(&self.sent_set, 1, last)
    }

    /// The first event that neither is with the station nor on its way.
    pub(super) fn lacks_from(&self) -> Option<u64> {
        self.gap().map(|gap| *gap.start())
    }

    /// The number of the last event, and how many of all the station did not report.
    pub(super) fn progress(&self) -> (u64, u64) {
        (self.head, self.head.saturating_sub(self.received.count()))
    }

    /// Writes the next part of a snapshot, if one is due.
    pub(super) fn write_snapshot(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) {
        if !self.has_all() {
            let run = (self.id, self.head, &mut self.tail);
            self.snapshots.write(run, turn, source, payload);
        }
    }
}

/// The next part that fits into a frame of `room` bytes, and its offset.
pub(super) fn next_part(bytes: &[u8], sent: usize, room: usize) -> (u32, &[u8]) {
    /// Bytes of the frame besides the part: kind, stream, event, its time, packing, length and offset.
    const HEAD_MAX: usize = 48;
    let room = room.saturating_sub(HEAD_MAX);
    let rest = bytes.get(sent..).unwrap_or_default();
    let part = if room < PART_MIN.min(rest.len()) { &[] } else { &rest[..rest.len().min(room)] };
    (small(sent), part)
}

/// A length that is at most that of an assembly.
pub(super) fn small(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}
