//! The newest events of a run: sent at once, and again in the next datagrams, so that one loss heals without a round trip.

use super::coded::Coding;
use super::outgoing::TransmitContext;
use super::source::EventBuffer;
use crate::frame::{Events, StreamId};
use crate::profile::Profile;
use std::collections::VecDeque;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Capacity for the newest events, in bytes.
const BYTES_MAX: usize = 4_096;
/// Number of times that new events are sent without reports.
pub(super) const SENDS_UNHEARD: u8 = 3;

/// The newest events, without gaps up to the last one of the run.
#[derive(Debug)]
pub(super) struct Tail {
    stream: StreamId,
    events: VecDeque<TailEvents>,
    bytes: usize,
    /// When any of them were sent, and when any for the first time.
    sent_at: Option<Duration>,
    new_sent_at: Option<Duration>,
    /// More of them are due than fit into the last datagram.
    is_cut: bool,
}

#[derive(Debug)]
struct TailEvents {
    events: EventBuffer,
    sends: u8,
}

/// Events that were written.
pub(super) struct WrittenTail {
    /// Events that were not sent before.
    pub(super) new: Option<RangeInclusive<u64>>,
    pub(super) is_coded: bool,
}

impl Tail {
    pub(super) fn new(stream: StreamId) -> Self {
        let (sent_at, new_sent_at) = (None, None);
        Self { stream, events: VecDeque::new(), bytes: 0, sent_at, new_sent_at, is_cut: false }
    }

    /// The next events of the run, which fit into one datagram.
    pub(super) fn append(&mut self, events: &Events<'_>) {
        let Events { first, count, t_before, items, .. } = *events;
        let events = EventBuffer { first, count, t_before, items: items.to_vec() };
        self.bytes += events.items.len();
        self.events.push_back(TailEvents { events, sends: 0 });
        while self.bytes > BYTES_MAX
            && let Some(oldest) = self.events.pop_front()
        {
            self.bytes -= oldest.events.items.len();
        }
    }

    /// True if the events continue from this one to the last event of the run.
    pub(super) fn continues(&self, sequence: u64, head: u64) -> bool {
        let first = self.events.front().map_or(head + 1, |events| events.events.first);
        first <= sequence + 1
    }

    /// The first event that is still to be sent for the first time.
    pub(super) fn first_unsent(&self) -> Option<u64> {
        let unsent = self.events.iter().find(|events| events.sends == 0);
        unsent.map(|events| events.events.first)
    }

    /// The first event with at least one send and fewer than `sends_max`.
    pub(super) fn unrepeated(&self, sends_max: u8) -> Option<u64> {
        let found = self.events.iter().find(|events| (1..sends_max).contains(&events.sends));
        found.map(|events| events.events.first)
    }

    /// Makes the events after this one due again.
    pub(super) fn send_again_after(&mut self, sequence: u64) {
        for events in self.events.iter_mut().filter(|events| events.events.first > sequence) {
            events.sends = events.sends.min(SENDS_UNHEARD - 1);
        }
    }

    /// Time of the next send. Each event is sent `sends_max` times.
    pub(super) fn due_at(&self, profile: &Profile, sends_max: u8) -> Duration {
        let sends = self.events.iter().map(|events| events.sends).min();
        match sends.filter(|least| *least < sends_max) {
            None => Duration::MAX,
            Some(_) if self.is_cut => Duration::ZERO,
            Some(0) => self.new_sent_at.map_or(Duration::ZERO, |sent| sent + profile.gather),
            Some(_) => self.sent_at.map_or(Duration::ZERO, |sent| sent + profile.repeat_after),
        }
    }

    /// Writes the events with fewer than `sends_max` sends, and those after them, as far as they fit.
    pub(super) fn write(
        &mut self,
        sends_max: u8,
        turn: TransmitContext<'_>,
        coding: &mut Coding,
        payload: &mut Vec<u8>,
    ) -> Option<WrittenTail> {
        let from = self.events.iter().position(|events| events.sends < sends_max)?;
        let head = self.events.back()?.events.last();
        let EventBuffer { first, t_before, .. } = self.events[from].events;
        let left = Events::items_max(turn.room.saturating_sub(payload.len()), head, t_before);
        let (mut items, mut last, mut new) = (Vec::new(), None, None);
        self.is_cut = false;
        for TailEvents { events, sends } in self.events.range_mut(from..) {
            if items.len() + events.items.len() > left {
                self.is_cut = true;
                break;
            }
            items.extend_from_slice(&events.items);
            if *sends == 0 {
                new.get_or_insert(events.first);
            }
            *sends = sends.saturating_add(1);
            last = Some(events.last());
        }
        let last = last?;
        let stream = self.stream;
        let events = Events { stream, first, count: last - first + 1, t_before, items: &items };
        let is_coded = coding.write_uncut(&events, turn, payload);
        self.sent_at = Some(turn.now);
        if new.is_some() {
            self.new_sent_at = Some(turn.now);
        }
        Some(WrittenTail { new: new.map(|new| new..=last), is_coded })
    }
}
