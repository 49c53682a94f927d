//! Outgoing events of one run, with the robot's view of the station's copy.

use super::coded::Coding;
use super::snapshots::Snapshots;
use super::source::{EventBuffer, RunSource};
use super::tail::{self, Tail};
use crate::assembly::PART_MIN;
use crate::frame::{EventHash, Events, Frame, Received, StreamId};
use crate::loss_rate::LossRate;
use crate::profile::Profile;
use crate::range_set::RangeSet;
use std::collections::VecDeque;
use std::ops::RangeInclusive;
use std::time::Duration;

/// The status is sent this often beside events, from which the station knows the head, in status intervals.
const STATUS_BESIDE: u32 = 8;
/// Number of lost events from which a snapshot arrives sooner than they do.
const SNAPSHOT_LOST: u64 = 64;
/// The beginning of a description, in parts: the station may have lost it and be unable to report that.
const DESCRIPTION_PARTS: RangeInclusive<u64> = 1..=16;
/// Without reports, the beginning of a description is sent once in this many report intervals.
const DESCRIPTION_EVERY: u32 = 16;
/// Older events are repeated after this part of the interval in which new ones are.
const REPEAT_PART: u32 = 4;
/// Retry interval for events that could not be read.
const READ_AGAIN: Duration = Duration::from_secs(1);

/// Events that were sent and are not reported.
#[derive(Debug)]
struct SentEvents {
    at: Duration,
    range: RangeInclusive<u64>,
    /// Number of repetitions before a report shows a loss.
    repeats: u8,
    /// They are of use only to a station that knows the context by which they are coded.
    is_coded: bool,
}

impl SentEvents {
    /// Earliest time of the repetition. It is in another datagram than the events, which a burst of losses may drop.
    fn repeat_at(&self, profile: &Profile) -> Duration {
        self.at + profile.repeat_after / REPEAT_PART
    }
}

/// Conditions under which a datagram is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct TransmitContext<'p> {
    pub(super) now: Duration,
    pub(super) profile: &'p Profile,
    /// True if the station sends reports.
    pub(super) is_heard: bool,
    /// The longest payload.
    pub(super) room: usize,
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
    shown_at: Option<Duration>,
    status_at: Option<Duration>,
    /// Events at the station, by its last report.
    received: RangeSet,
    /// The station knows that the run has ended.
    knows_end: bool,
    /// Sent events without a report, by time.
    sent: VecDeque<SentEvents>,
    sent_set: RangeSet,
    /// When the unreported events are sent again, for a station that cannot report.
    round_due: Duration,
    /// The source could not read events: it is asked again then.
    read_again_at: Duration,
    snapshots: Snapshots,
    large: Option<(EventBuffer, usize)>,
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
    Sent(Duration),
    Yes,
}

/// True if a report is requested before the first events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Asks {
    No,
    Yes,
    /// It has not answered since.
    Since(Duration),
}

/// Older events in this datagram.
enum Written {
    /// Those up to this one, and whether they are coded.
    UpTo(u64, bool),
    /// The first is too long for a datagram, and goes in parts.
    Nothing,
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
            round_due: Duration::ZERO,
            read_again_at: Duration::ZERO,
            snapshots: Snapshots::new(),
            large: None,
            coding: Coding::default(),
            sends: LossRate::default().sends(),
            asks: Asks::No,
        }
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
    fn waits_until(&self, profile: &Profile) -> Duration {
        match self.asks {
            Asks::No | Asks::Yes => Duration::ZERO,
            Asks::Since(at) => at + profile.silence(),
        }
    }

    pub(super) fn advance(&mut self, head: u64) {
        if head > self.head {
            (self.head, self.tail) = (head, Tail::new(self.id));
        }
    }

    pub(super) fn append(&mut self, events: &Events<'_>, room: usize) {
        let continues = events.first == self.head + 1;
        self.head = self.head.max(events.last());
        let fits = events.items.len() <= Events::items_max(room, events.first, events.t_before);
        if continues && fits {
            self.tail.append(events);
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
        self.sent.retain(|sent| !sent.is_coded);
        self.renew_sent_set();
    }

    /// Applies a report of the station. `echo` is the newest time that it received, with the delay of reordered datagrams.
    pub(super) fn report(
        &mut self,
        now: Duration,
        received: Received,
        echo: Option<(u64, u64)>,
        profile: &Profile,
    ) {
        self.received = received.events;
        self.coding.offer(received.context);
        self.snapshots.offer(received.snapshot);
        self.knows_end = received.is_over;
        self.asks = Asks::No;
        let Some((newest_ms, late_ms)) = echo else { return };
        if matches!(self.chain_told, ChainTold::Sent(at) if at.as_millis() <= newest_ms.into()) {
            self.chain_told = ChainTold::Yes;
        }
        // Earlier events without a report are lost. A repetition may still repair the newest of them.
        let late = Duration::from_millis(late_ms) + profile.repeat_after * u32::from(self.sends);
        let lost_before = Duration::from_millis(newest_ms).saturating_sub(late);
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
    pub(super) fn urgent_at(&self, profile: &Profile, is_heard: bool) -> Duration {
        let status = match (self.shown_at, self.status_at) {
            _ if self.is_state_new => Duration::ZERO,
            // The station reports that it has all: nothing is new ever after.
            _ if self.is_complete() => Duration::MAX,
            _ if self.has_all() && self.chain_told == ChainTold::No => Duration::ZERO,
            // There is nothing to see of files.
            (Some(shown), Some(_)) if self.id.is_files() => {
                shown + profile.status_every * STATUS_BESIDE
            }
            (Some(shown), Some(status)) => {
                (shown + profile.status_every).min(status + profile.status_every * STATUS_BESIDE)
            }
            _ => Duration::ZERO,
        };
        self.tail.due_at(profile, self.tail_sends(is_heard)).min(status)
    }

    /// Writes the status and the newest events if they are due. Returns whether it wrote the status.
    pub(super) fn write_urgent(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut Vec<u8>,
    ) -> bool {
        let TransmitContext { now, profile, is_heard, room } = turn;
        if self.urgent_at(profile, is_heard) > now {
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
        let length = payload.len();
        frame.write(payload);
        if payload.len() > room {
            payload.truncate(length);
            return false;
        }
        (self.status_at, self.shown_at, self.is_state_new) = (Some(now), Some(now), false);
        if self.chain.is_some() && self.chain_told == ChainTold::No {
            self.chain_told = ChainTold::Sent(now);
        }
        true
    }

    fn write_tail(&mut self, turn: TransmitContext<'_>, payload: &mut Vec<u8>) {
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

    /// When something of the lower queues is due.
    pub(super) fn bulk_at(&self, is_heard: bool, profile: &Profile) -> Duration {
        let is_lacking = self.large.is_some() || self.gap().is_some();
        let lacking = if is_lacking { Duration::ZERO } else { Duration::MAX };
        let repeated = if is_heard { self.repeated_at(profile) } else { Duration::MAX };
        let events = lacking.min(repeated).max(self.read_again_at);
        let round = if self.has_rounds(is_heard) { self.round_due } else { Duration::MAX };
        let snapshot = self.snapshots.alone_at(is_heard, profile);
        let snapshot = if self.has_all() { Duration::MAX } else { snapshot };
        let bulk = round.max(self.read_again_at).min(events).max(self.waits_until(profile));
        bulk.min(snapshot)
    }

    /// Fills the rest of the datagram with events that the station lacks.
    pub(super) fn write_bulk(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut Vec<u8>,
    ) {
        let TransmitContext { now, profile, is_heard, .. } = turn;
        if self.asks == Asks::Yes {
            self.asks = Asks::Since(now);
        }
        if now < self.waits_until(profile) {
            return;
        }
        self.coding.renew(self.id, self.head, source);
        while self.read_again_at <= now && self.write_large(turn, payload) {
            let is_round_due = self.has_rounds(is_heard) && self.round_due <= now;
            if is_round_due && self.gap().is_none() {
                self.begin_round(turn);
            }
            let repeated = || self.repeated(now, profile).filter(|_| is_heard);
            // Files are never urgent.
            let sends = if self.id.is_files() { 1 } else { self.sends };
            let gap = self.gap().map(|gap| (gap, sends));
            let Some((range, repeats)) = gap.or_else(repeated) else { return };
            let Some(written) = self.write_old(turn, &range, source, payload) else { return };
            if let Written::UpTo(last, is_coded) = written {
                let range = *range.start()..=last;
                self.take_sent(*range.start(), last);
                self.note_sent(SentEvents { at: now, range, repeats: repeats - 1, is_coded });
            }
        }
    }

    /// True if sent events are sent again, because the station cannot report.
    fn has_rounds(&self, is_heard: bool) -> bool {
        !is_heard && (self.content == Content::Description || !self.sent.is_empty())
    }

    fn begin_round(&mut self, turn: TransmitContext<'_>) {
        self.sent.clear();
        self.sent_set = RangeSet::default();
        let mut intervals = 2;
        if self.content == Content::Description {
            self.received.remove(DESCRIPTION_PARTS);
            intervals = DESCRIPTION_EVERY;
        }
        self.round_due = turn.now + turn.profile.report_every * intervals;
    }

    /// Writes the first of these events that fit. `None` if the datagram is full, or if they cannot be read now.
    fn write_old(
        &mut self,
        turn: TransmitContext<'_>,
        range: &RangeInclusive<u64>,
        source: &mut impl RunSource,
        payload: &mut Vec<u8>,
    ) -> Option<Written> {
        let TransmitContext { now, room, .. } = turn;
        let left = room.saturating_sub(payload.len());
        let coded_max = Events::items_max(left, *range.end(), u64::MAX >> 8);
        if coded_max < PART_MIN {
            return None;
        }
        let is_coded = self.coding.is_used_for_backfill(turn);
        let mut items_max = if is_coded { self.coding.items_max(coded_max) } else { coded_max };
        loop {
            let Some(buffer) = source.events(self.id, *range.start(), *range.end(), items_max)
            else {
                self.read_again_at = now + READ_AGAIN;
                return None;
            };
            if buffer.items.len() > items_max.max(coded_max) {
                self.large = Some((buffer, 0));
                return Some(Written::Nothing);
            }
            let EventBuffer { first, count, t_before, items } = &buffer;
            let (first, count, t_before) = (*first, *count, *t_before);
            let events = Events { stream: self.id, first, count, t_before, items };
            if !is_coded {
                Frame::Events(events).write(payload);
                return Some(Written::UpTo(buffer.last(), false));
            }
            match self.coding.write(&events, coded_max, payload) {
                Ok(is_coded) => return Some(Written::UpTo(buffer.last(), is_coded)),
                Err(_) if items_max == coded_max => {
                    self.large = Some((buffer, 0));
                    return Some(Written::Nothing);
                }
                Err(coded) => {
                    let fewer = items.len() * coded_max / coded;
                    items_max = (fewer - fewer / 16).max(coded_max).min(items_max - 1);
                }
            }
        }
    }

    /// When events are repeated without a report.
    fn repeated_at(&self, profile: &Profile) -> Duration {
        let repeated = self.sent.iter().filter(|sent| sent.repeats > 0);
        repeated.map(|sent| sent.repeat_at(profile)).min().unwrap_or(Duration::MAX)
    }

    /// Next events to repeat without a report: the least repeated, and the newest of these, because the oldest are reported
    /// first.
    fn repeated(&self, now: Duration, profile: &Profile) -> Option<(RangeInclusive<u64>, u8)> {
        let is_due = |sent: &SentEvents| sent.repeats > 0 && sent.repeat_at(profile) <= now;
        let sent = self.sent.iter().enumerate().filter(|(_, sent)| is_due(sent));
        let (_, sent) = sent.max_by_key(|(place, sent)| (sent.repeats, *place))?;
        Some((sent.range.clone(), sent.repeats))
    }

    /// Events are sent again: what was noted of them, from this one to that one, is void.
    fn take_sent(&mut self, first: u64, last: u64) {
        let place = self.sent.iter().position(|sent| *sent.range.start() == first);
        let Some(sent) = place.and_then(|place| self.sent.get_mut(place)) else { return };
        if *sent.range.end() > last {
            sent.range = last + 1..=*sent.range.end();
        } else if let Some(place) = place {
            self.sent.remove(place);
        }
    }

    /// Writes the next part of a snapshot, if one is due.
    pub(super) fn write_snapshot(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut Vec<u8>,
    ) {
        if !self.has_all() {
            let run = (self.id, self.head, &mut self.tail);
            self.snapshots.write(run, turn, source, payload);
        }
    }

    /// Writes the next part of an event that is too long for a datagram. Returns whether it is the last part.
    fn write_large(&mut self, turn: TransmitContext<'_>, payload: &mut Vec<u8>) -> bool {
        let Some((events, sent)) = &mut self.large else { return true };
        let (offset, part) =
            next_part(&events.items, *sent, turn.room.saturating_sub(payload.len()));
        if part.is_empty() {
            return false;
        }
        let (first, t_before, length) = (events.first, events.t_before, small(events.items.len()));
        Frame::Large { stream: self.id, first, t_before, length, offset, bytes: part }
            .write(payload);
        *sent += part.len();
        if *sent < events.items.len() {
            return false;
        }
        let range = events.first..=events.last();
        self.large = None;
        self.note_sent(SentEvents { at: turn.now, range, repeats: 0, is_coded: false });
        true
    }
}

/// The next part that fits into a frame of `room` bytes, and its offset.
pub(super) fn next_part(bytes: &[u8], sent: usize, room: usize) -> (u32, &[u8]) {
    const HEAD_MAX: usize = 1 + 5 + 10 + 10 + 5 + 5 + 3;
    let room = room.saturating_sub(HEAD_MAX);
    let rest = bytes.get(sent..).unwrap_or_default();
    let part = if room < PART_MIN.min(rest.len()) { &[] } else { &rest[..rest.len().min(room)] };
    (small(sent), part)
}

/// A length that is at most that of an assembly.
pub(super) fn small(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}
