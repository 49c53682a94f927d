//! The newest events of a run: sent at once, and again in the next datagrams, so that one loss heals without a round trip.

use super::coded::Coding;
use super::outgoing::TransmitContext;
use crate::frame::{StreamId, block_bytes_max};
use crate::payload_writer::PayloadWriter;
use crate::profile::Profile;
use crate::session_time::SessionTime;
use rafcon_events::{EventBlock, EventBlockRef};
use std::collections::VecDeque;
use std::ops::RangeInclusive;

/// Capacity for the newest events, in bytes.
const BYTES_MAX: usize = 4_096;
/// Number of times that new events are sent without reports.
pub(super) const SENDS_UNHEARD: u8 = 3;

/// The newest events, without gaps up to the last one of the run.
#[derive(Debug)]
pub(super) struct Tail {
    stream: StreamId,
    blocks: VecDeque<SentBlock>,
    bytes: usize,
    /// When any of them were sent, and when any for the first time.
    sent_at: Option<SessionTime>,
    new_sent_at: Option<SessionTime>,
    /// More of them are due than fit into the last datagram.
    is_cut: bool,
}

/// A block with the number of its sends.
#[derive(Debug)]
struct SentBlock {
    block: EventBlock,
    sends: u8,
}

impl SentBlock {
    fn first_sequence(&self) -> u64 {
        self.block.first_sequence
    }
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
        Self { stream, blocks: VecDeque::new(), bytes: 0, sent_at, new_sent_at, is_cut: false }
    }

    /// The next events of the run, which fit into one datagram.
    pub(super) fn append(&mut self, block: EventBlockRef<'_>) {
        self.bytes += block.bytes.len();
        self.blocks.push_back(SentBlock { block: block.to_block(), sends: 0 });
        while self.bytes > BYTES_MAX
            && let Some(oldest) = self.blocks.pop_front()
        {
            self.bytes -= oldest.block.bytes.len();
        }
    }

    /// True if the events continue from this one to the last event of the run.
    pub(super) fn continues(&self, sequence: u64, head: u64) -> bool {
        self.blocks.front().map_or(head + 1, SentBlock::first_sequence) <= sequence + 1
    }

    /// The first event that is still to be sent for the first time.
    pub(super) fn first_unsent(&self) -> Option<u64> {
        self.blocks.iter().find(|sent| sent.sends == 0).map(SentBlock::first_sequence)
    }

    /// The first event with at least one send and fewer than `sends_max`.
    pub(super) fn unrepeated(&self, sends_max: u8) -> Option<u64> {
        let found = self.blocks.iter().find(|sent| (1..sends_max).contains(&sent.sends));
        found.map(SentBlock::first_sequence)
    }

    /// Makes the events after this one due again.
    pub(super) fn send_again_after(&mut self, sequence: u64) {
        for sent in self.blocks.iter_mut().filter(|sent| sent.first_sequence() > sequence) {
            sent.sends = sent.sends.min(SENDS_UNHEARD - 1);
        }
    }

    /// Time of the next send. Each event is sent `sends_max` times.
    pub(super) fn due_at(&self, profile: &Profile, sends_max: u8) -> Option<SessionTime> {
        let sends = self.blocks.iter().map(|sent| sent.sends).min();
        let after = match sends.filter(|least| *least < sends_max)? {
            _ if self.is_cut => None,
            0 => self.new_sent_at.map(|sent| sent + profile.gather),
            _ => self.sent_at.map(|sent| sent + profile.repeat_after),
        };
        Some(after.unwrap_or(SessionTime::BEGIN))
    }

    /// Writes the events with fewer than `sends_max` sends, and those after them, as far as they fit.
    pub(super) fn write(
        &mut self,
        sends_max: u8,
        turn: TransmitContext<'_>,
        coding: &mut Coding,
        payload: &mut PayloadWriter,
    ) -> Option<WrittenTail> {
        let from = self.blocks.iter().position(|sent| sent.sends < sends_max)?;
        let head = self.blocks.back()?.block.last_sequence();
        let EventBlock { first_sequence, time_before, .. } = self.blocks[from].block;
        let left = block_bytes_max(payload.left(), head, time_before);
        let (mut bytes, mut last, mut new) = (Vec::new(), None, None);
        self.is_cut = false;
        for SentBlock { block, sends } in self.blocks.range_mut(from..) {
            if bytes.len() + block.bytes.len() > left {
                self.is_cut = true;
                break;
            }
            bytes.extend_from_slice(&block.bytes);
            if *sends == 0 {
                new.get_or_insert(block.first_sequence);
            }
            *sends = sends.saturating_add(1);
            last = Some(block.last_sequence());
        }
        let last = last?;
        let count = last - first_sequence + 1;
        let block = EventBlockRef { first_sequence, count, time_before, bytes: &bytes };
        let is_coded = coding.write_uncut(self.stream, block, turn, payload);
        self.sent_at = Some(turn.now);
        if new.is_some() {
            self.new_sent_at = Some(turn.now);
        }
        Some(WrittenTail { new: new.map(|new| new..=last), is_coded })
    }
}
