//! Back-fill of one run: events that the station lacks, repetitions, and long events in parts.

use super::{Asks, Content, Outgoing, SentEvents, Served, TransmitContext};
use crate::assembly::PART_MIN;
use crate::frame::{Frame, block_bytes_max};
use crate::payload_writer::PayloadWriter;
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::robot::large::LargeEvent;
use crate::robot::source::RunSource;
use crate::session_time::SessionTime;
use crate::station::LARGE_MAX;
use rafcon_events::EventBlock;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Older events are repeated after this part of the interval in which new ones are.
const REPEAT_PART: u32 = 16;
/// Number of missing events from which they are a backlog, as after a blackout.
const BACKLOG_EVENTS: u64 = 64;
/// Sends of a backlog while the rate allows it. One datagram that is lost each time costs the station a round trip.
const BACKLOG_SENDS: u8 = 4;
/// Retry interval for events that could not be read.
const READ_AGAIN: Duration = Duration::from_secs(1);
/// Capacity for packed events in bytes, from `LARGE_MAX` events on. A report of the oldest finds them here.
const LARGE_BYTES_MAX: usize = 1 << 20;
/// Datagrams in a row with too little room for an event until it is sent in parts. Urgent data is in each of them.
const WAITS: u8 = 8;
/// Capacity for the time of the sender, at the beginning of a datagram, in bytes.
const TIME_BYTES: usize = 10;
/// The beginning of a description, in parts: the station may have lost it and be unable to report that.
const DESCRIPTION_PARTS: RangeInclusive<u64> = 1..=16;
/// Without reports, the beginning of a description is sent once in this many report intervals.
const DESCRIPTION_EVERY: u32 = 16;

/// Older events in this datagram.
enum Written {
    /// Those up to this one, and whether they are coded.
    UpTo(u64, bool),
    /// The first is too long for a datagram, and goes in parts.
    Nothing,
}

impl SentEvents {
    /// Earliest time of the repetition. It is in another datagram than the events, which a burst of losses may drop.
    fn repeat_at(&self, profile: &Profile) -> SessionTime {
        self.at + profile.repeat_after / REPEAT_PART
    }
}

impl Outgoing {
    /// When something of the lower queues is due.
    pub(in crate::robot) fn bulk_at(
        &self,
        is_heard: bool,
        profile: &Profile,
    ) -> Option<SessionTime> {
        let is_lacking = self.sending_in_parts().is_some() || self.gap().is_some();
        let lacking = is_lacking.then_some(SessionTime::BEGIN);
        let repeated = self.repeated_at(profile).filter(|_| is_heard);
        let round = self.has_rounds(is_heard).then_some(self.round_due);
        let not_before = self.read_again_at.max(self.waits_until(profile));
        let events = SessionTime::earliest([lacking, repeated, round]);
        let snapshot = (!self.has_all()).then(|| self.snapshots.alone_at(is_heard, profile));
        SessionTime::earliest([events.map(|at| at.max(not_before)), snapshot])
    }

    /// Fills the rest of the datagram with events that the station lacks.
    pub(in crate::robot) fn write_bulk(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) {
        let TransmitContext { now, profile, .. } = turn;
        (self.waited_before, self.waited) = (self.waited, 0);
        if self.asks == Asks::Yes {
            self.asks = Asks::Since(now);
        }
        if now < self.waits_until(profile) {
            return;
        }
        self.coding.renew(self.id, self.head, source);
        if self.read_again_at > now {
            return;
        }
        // Other events do not wait for all parts of a long one, nor it for them.
        match self.served_first {
            Served::Events => {
                self.served_first = Served::Parts;
                self.write_large(turn, payload);
                self.write_events(turn, source, payload);
            }
            Served::Parts => {
                self.served_first = Served::Events;
                self.write_events(turn, source, payload);
                self.write_large(turn, payload);
            }
        }
    }

    /// True if its next event waits for a datagram with more room.
    pub(in crate::robot) fn waits(&self) -> bool {
        self.waited > 0
    }

    fn write_events(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) {
        let TransmitContext { now, profile, is_heard } = turn;
        while self.read_again_at <= now {
            let is_round_due = self.has_rounds(is_heard) && self.round_due <= now;
            if is_round_due && self.gap().is_none() && self.sending_in_parts().is_none() {
                self.begin_round(turn);
            }
            let gap = self.gap().map(|gap| self.backfill_sends(gap));
            let repeated = || self.repeated(now, profile).filter(|_| is_heard);
            let Some((range, repeats)) = gap.or_else(repeated) else { return };
            let Some(written) = self.write_old(turn, &range, source, payload) else { return };
            if let Written::UpTo(last, is_coded) = written {
                let range = *range.start()..=last;
                self.waited_before = 0;
                self.take_sent(*range.start(), last);
                self.note_sent(SentEvents { at: now, range, repeats: repeats - 1, is_coded });
            }
        }
    }

    /// Events that the station lacks, with the number of their sends.
    fn backfill_sends(&mut self, gap: RangeInclusive<u64>) -> (RangeInclusive<u64>, u8) {
        if gap.end() - gap.start() >= BACKLOG_EVENTS {
            self.backlog = *gap.end();
        }
        let sends = if self.id.is_files() {
            // Files are never urgent.
            1
        } else if *gap.start() <= self.backlog {
            self.sends.max(BACKLOG_SENDS)
        } else {
            self.sends
        };
        (gap, sends)
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
        payload: &mut PayloadWriter,
    ) -> Option<Written> {
        let bytes_max = |room| block_bytes_max(room, *range.end(), u64::MAX >> 8);
        // A datagram begins with the time of its sender.
        let (coded_max, datagram_max) =
            (bytes_max(payload.left()), bytes_max(payload.bytes_max() - TIME_BYTES));
        if coded_max < PART_MIN {
            return None;
        }
        let is_coded = self.coding.is_used_for_backfill(turn);
        let mut bytes_max = if is_coded { self.coding.bytes_max(coded_max) } else { coded_max };
        loop {
            let Some(block) = source.events(self.id, *range.start(), *range.end(), bytes_max)
            else {
                self.read_again_at = turn.now + READ_AGAIN;
                return None;
            };
            if block.bytes.len() > bytes_max.max(coded_max) {
                let fits_alone = block.bytes.len() <= datagram_max;
                return self.begin_large(block, fits_alone, turn);
            }
            if !is_coded {
                payload.fitting_frame(&Frame::Events { stream: self.id, block: block.view() });
                return Some(Written::UpTo(block.last_sequence(), false));
            }
            match self.coding.write(self.id, block.view(), coded_max, payload) {
                Ok(is_coded) => return Some(Written::UpTo(block.last_sequence(), is_coded)),
                Err(coded) if block.count == 1 => {
                    return self.begin_large(block, coded <= datagram_max, turn);
                }
                Err(coded) => {
                    let fewer = block.bytes.len() * coded_max / coded;
                    bytes_max = (fewer - fewer / 16).max(coded_max).min(bytes_max - 1);
                }
            }
        }
    }

    /// Sends an event in parts once no other is, or repairs it. `None` if it has to wait, as it does for a datagram into which it fits.
    fn begin_large(
        &mut self,
        event: EventBlock,
        fits_alone: bool,
        turn: TransmitContext<'_>,
    ) -> Option<Written> {
        if fits_alone && self.waited_before + 1 < WAITS {
            self.waited = self.waited_before + 1;
            return None;
        }
        if self.sending_in_parts().is_some() {
            return None;
        }
        let number = event.first_sequence;
        let known = self.large.iter().position(|known| known.number() == number);
        let known = known.and_then(|place| self.large.remove(place));
        let repaired = known.and_then(|known| known.repair(&self.coding, turn));
        let mut bytes: usize = self.large.iter().map(LargeEvent::length).sum();
        while self.large.len() >= LARGE_MAX
            && bytes > LARGE_BYTES_MAX
            && let Some(oldest) = self.large.pop_front()
        {
            bytes -= oldest.length();
        }
        let event = repaired.unwrap_or_else(|| LargeEvent::new(event, &mut self.coding, turn));
        self.large.push_back(event);
        self.sent_set.insert(number..=number);
        Some(Written::Nothing)
    }

    /// When events are repeated without a report.
    fn repeated_at(&self, profile: &Profile) -> Option<SessionTime> {
        let repeated = self.sent.iter().filter(|sent| sent.repeats > 0);
        repeated.map(|sent| sent.repeat_at(profile)).min()
    }

    /// Next events to repeat without a report: the least repeated, and the newest of these, because the oldest are reported
    /// first.
    fn repeated(&self, now: SessionTime, profile: &Profile) -> Option<(RangeInclusive<u64>, u8)> {
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

    /// Writes the next part of the event that is sent in parts.
    fn write_large(&mut self, turn: TransmitContext<'_>, payload: &mut PayloadWriter) {
        let Some(event) = self.large.back_mut().filter(|event| event.is_sending()) else { return };
        if event.write(self.id, payload) {
            let (number, is_coded) = (event.number(), event.is_coded());
            let range = number..=number;
            self.note_sent(SentEvents { at: turn.now, range, repeats: 0, is_coded });
        }
    }
}
