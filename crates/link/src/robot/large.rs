//! An event that does not fit into one datagram: packed, sent in parts, and repaired by the parts that the station lacks.

use super::coded::Coding;
use super::outgoing::{TransmitContext, next_part, small};
use crate::deflate::deflate;
use crate::frame::{Frame, Packing, PartialEvent, StreamId};
use crate::payload_writer::PayloadWriter;
use crate::range_set::RangeSet;
use rafcon_events::EventBlock;

/// An event that is sent in parts, until the station reports it.
#[derive(Debug)]
pub(super) struct LargeEvent {
    first: u64,
    time_before: u64,
    packing: Packing,
    /// The packed items.
    bytes: Vec<u8>,
    /// Bytes at the station by its last report, numbered from 1.
    here: RangeSet,
    /// Progress of the present transfer, in bytes.
    sent: usize,
}

impl LargeEvent {
    pub(super) fn new(event: EventBlock, coding: &mut Coding, turn: TransmitContext<'_>) -> Self {
        let EventBlock { first_sequence: first, time_before, bytes: items, .. } = event;
        let deflated = || {
            let deflated = deflate(&items);
            (deflated.len() < items.len()).then_some((Packing::Deflated, deflated))
        };
        let packed = coding.pack(&items, turn).or_else(deflated);
        let (packing, bytes) = packed.unwrap_or((Packing::Plain, items));
        Self { first, time_before, packing, bytes, here: RangeSet::default(), sent: 0 }
    }

    /// The number of the event.
    pub(super) fn number(&self) -> u64 {
        self.first
    }

    /// Length of the packed items, in bytes.
    pub(super) fn length(&self) -> usize {
        self.bytes.len()
    }

    /// True if the event can be decoded only with a context.
    pub(super) fn is_coded(&self) -> bool {
        matches!(self.packing, Packing::Coded { .. })
    }

    pub(super) fn is_sending(&self) -> bool {
        self.sent < self.bytes.len()
    }

    /// Applies a report. Without the event in it, no part is assumed at the station.
    pub(super) fn report(&mut self, partial: &[PartialEvent]) {
        let is_this = |partial: &&PartialEvent| {
            partial.first == self.first && partial.length as usize == self.bytes.len()
        };
        self.here = partial.iter().find(is_this).map(|it| it.here.clone()).unwrap_or_default();
    }

    /// Starts a transfer of the parts that the station lacks. `None` if the event has to be packed again: the station cannot decode it, or
    /// could not although it had all parts.
    pub(super) fn repair(mut self, coding: &Coding, turn: TransmitContext<'_>) -> Option<Self> {
        let is_whole = self.here.contiguous() >= self.bytes.len() as u64;
        let is_readable = match self.packing {
            Packing::Coded { context, .. } => coding.context(turn) == Some(context),
            Packing::Plain | Packing::Deflated => true,
        };
        self.sent = 0;
        (!is_whole && is_readable).then_some(self)
    }

    /// Writes the next part that the station lacks, if it has room. Returns true after the last part.
    pub(super) fn write(&mut self, stream: StreamId, payload: &mut PayloadWriter) -> bool {
        let length = self.bytes.len();
        let all = RangeSet::default();
        let lacking = self.here.first_gap(&all, self.sent as u64 + 1, length as u64);
        let Some(lacking) = lacking else {
            self.sent = length;
            return true;
        };
        let place = |number: u64| usize::try_from(number).unwrap_or(length).min(length);
        let (start, end) = (place(lacking.start() - 1), place(*lacking.end()));
        let (offset, part) = next_part(&self.bytes[..end], start, payload.left());
        if part.is_empty() {
            return false;
        }
        let Self { first, time_before, packing, .. } = *self;
        let length = small(length);
        payload.fitting_frame(&Frame::Large {
            stream,
            first,
            time_before,
            packing,
            length,
            offset,
            bytes: part,
        });
        self.sent = start + part.len();
        !self.is_sending()
    }
}
