//! Events in fewer bytes, by a context that the station offers.

use super::outgoing::TransmitContext;
use super::source::RunSource;
use crate::coding::{CONTEXT_MAX, ContextId, ContextName, LastCoder, PLAIN_MAX};
use crate::frame::{Frame, Packing, StreamId};
use crate::payload_writer::PayloadWriter;
use crate::profile::Compression;
use rafcon_events::EventBlockRef;

/// Assumed compression ratio before the first measurement, in 16ths.
const FIRST_RATIO: usize = 24;

/// Context that the station has confirmed.
#[derive(Debug)]
pub(super) struct Coding {
    /// Last context offered by the station.
    offered: Option<ContextName>,
    /// Last offer that was read.
    seen: Option<ContextName>,
    /// The context that is used, and its items.
    used: Option<(ContextName, Vec<u8>)>,
    coder: LastCoder,
    /// Measured compression ratio, in 16ths.
    ratio: usize,
}

impl Default for Coding {
    fn default() -> Self {
        let coder = LastCoder::default();
        Self { offered: None, seen: None, used: None, coder, ratio: FIRST_RATIO }
    }
}

impl Coding {
    /// The station has this context, or none.
    pub(super) fn offer(&mut self, context: Option<ContextName>) {
        self.offered = context;
        if context.is_none() {
            (self.seen, self.used) = (None, None);
        }
    }

    /// Reads the offered context if it is new. It is used only if both sides have the same bytes, because the journal may have
    /// dropped values.
    pub(super) fn renew(&mut self, stream: StreamId, head: u64, source: &mut impl RunSource) {
        let Some(name) = self.offered.take() else { return };
        if name.last > head || self.seen.replace(name) == Some(name) {
            return;
        }
        let block = source.events(stream, name.first, name.last, CONTEXT_MAX);
        if let Some(block) = block.filter(|block| block.last_sequence() == name.last)
            && ContextName::of(name.first, name.last, &block.bytes) == name
        {
            self.used = Some((name, block.bytes));
        }
    }

    /// True if back-fill is compressed.
    pub(super) fn is_used_for_backfill(&self, turn: TransmitContext<'_>) -> bool {
        turn.profile.compression == Compression::All && self.is_used(turn)
    }

    /// True if new events are compressed. A station without reports may have restarted and lost its contexts.
    fn is_used(&self, turn: TransmitContext<'_>) -> bool {
        turn.is_heard && turn.profile.codes_new() && self.used.is_some()
    }

    /// Estimates the bytes of events that fit into this many coded bytes.
    pub(super) fn bytes_max(&self, coded_max: usize) -> usize {
        (coded_max * self.ratio / 16).clamp(coded_max, PLAIN_MAX)
    }

    /// The context by which new events are compressed.
    pub(super) fn context(&self, turn: TransmitContext<'_>) -> Option<ContextId> {
        self.used.as_ref().filter(|_| self.is_used(turn)).map(|(name, _)| name.id())
    }

    /// Compresses the items of an event that is sent in parts. `None` without a context, or if that saves nothing.
    pub(super) fn pack(
        &mut self,
        items: &[u8],
        turn: TransmitContext<'_>,
    ) -> Option<(Packing, Vec<u8>)> {
        let is_possible = self.is_used(turn) && items.len() <= PLAIN_MAX;
        let (name, known) = self.used.as_ref().filter(|_| is_possible)?;
        let coded = self.coder.with(name.id(), known).encode(items);
        let length = u32::try_from(items.len()).unwrap_or(u32::MAX);
        let packing = Packing::Coded { context: name.id(), length };
        (coded.len() < items.len()).then_some((packing, coded))
    }

    /// Writes the frame of events that fit uncompressed. Returns whether they are compressed.
    pub(super) fn write_uncut(
        &mut self,
        stream: StreamId,
        block: EventBlockRef<'_>,
        turn: TransmitContext<'_>,
        payload: &mut PayloadWriter,
    ) -> bool {
        let written = self.is_used(turn).then(|| self.write(stream, block, usize::MAX, payload));
        if let Some(Ok(is_coded)) = written {
            return is_coded;
        }
        payload.fitting_frame(&Frame::Events { stream, block });
        false
    }

    /// Writes the frame of these events if its bytes have at most `coded_max` bytes, and returns whether they are compressed.
    /// Otherwise returns the number of bytes.
    pub(super) fn write(
        &mut self,
        stream: StreamId,
        block: EventBlockRef<'_>,
        coded_max: usize,
        payload: &mut PayloadWriter,
    ) -> Result<bool, usize> {
        let plain = block.bytes.len();
        let Some((name, items)) = self.used.as_ref().filter(|_| plain <= PLAIN_MAX) else {
            return Err(plain);
        };
        let coded = self.coder.with(name.id(), items).encode(block.bytes);
        self.ratio = (self.ratio * 3 + plain * 16 / coded.len().max(1)) / 4;
        if coded.len().min(plain) > coded_max {
            return Err(coded.len().min(plain));
        }
        let is_coded = coded.len() < plain;
        if is_coded {
            let length = u32::try_from(plain).unwrap_or(u32::MAX);
            let block = EventBlockRef { bytes: &coded, ..block };
            payload.fitting_frame(&Frame::Coded { context: name.id(), length, stream, block });
        } else {
            payload.fitting_frame(&Frame::Events { stream, block });
        }
        Ok(is_coded)
    }
}
