//! Snapshots that both sides have: the next one is much like them, so a coder that has learnt from one of them needs few bytes for it.

use super::offers::Offers;
use super::{CONTEXT_MAX, ContextId, ContextName, LastCoder};
use crate::session_time::SessionTime;
use std::collections::VecDeque;
use std::time::Duration;

/// Kept offers. The robot names those that were offered in the last round trip.
const OFFERS: usize = 16;
/// Offers in a round trip, at most: half of those that are kept, because some are late.
const OFFERS_IN_ROUND_TRIP: u32 = 8;
/// Capacity for snapshots that the robot sent, in bytes. The station may offer one of them.
const SENT_MAX: usize = 256 << 10;

/// True if a snapshot is short enough for the coder.
fn is_short(bytes: &[u8]) -> bool {
    bytes.len() <= CONTEXT_MAX
}

/// The snapshots that a station has at hand, some of which it offers.
#[derive(Debug, Default)]
pub(crate) struct OfferedSnapshots {
    newest: Option<(ContextName, Vec<u8>)>,
    offered_at: Option<SessionTime>,
    offers: Offers<OFFERS>,
    coder: LastCoder,
}

impl OfferedSnapshots {
    /// A snapshot was received.
    pub(crate) fn note(&mut self, sequence: u64, bytes: &[u8]) {
        if sequence > 0 && is_short(bytes) {
            let name = ContextName::of(sequence, sequence, bytes);
            self.newest = Some((name, bytes.to_vec()));
        }
    }

    /// Decodes a snapshot of this length that was coded from another one. `None` without the other one, which a restart loses.
    /// Another one follows.
    pub(crate) fn decode(&mut self, id: ContextId, coded: &[u8], length: usize) -> Option<Vec<u8>> {
        let known = self.offers.find(id)?;
        self.coder.with(id, known).decode(coded, length)
    }

    /// The one from which the robot may code: the newest, unless too many would be offered in a round trip.
    pub(crate) fn offer(&mut self, now: SessionTime, round_trip: Duration) -> Option<ContextName> {
        let every = round_trip / OFFERS_IN_ROUND_TRIP;
        let is_due = self.offered_at.is_none_or(|at| now >= at + every);
        if is_due && let Some((name, bytes)) = self.newest.take() {
            self.offered_at = Some(now);
            self.offers.push(name, bytes);
        }
        self.offers.newest()
    }
}

/// The snapshots that the robot sent, and the one that the station offers.
#[derive(Debug, Default)]
pub(crate) struct SentSnapshots {
    /// The newest is the last one.
    sent: VecDeque<(ContextName, Vec<u8>)>,
    bytes: usize,
    offered: Option<ContextName>,
    coder: LastCoder,
}

impl SentSnapshots {
    /// A snapshot was sent.
    pub(crate) fn note(&mut self, sequence: u64, bytes: Vec<u8>) {
        if sequence == 0 || !is_short(&bytes) {
            return;
        }
        self.bytes += bytes.len();
        self.sent.push_back((ContextName::of(sequence, sequence, &bytes), bytes));
        while self.bytes > SENT_MAX
            && let Some((_, oldest)) = self.sent.pop_front()
        {
            self.bytes -= oldest.len();
        }
    }

    /// The station has this one, or none.
    pub(crate) fn offer(&mut self, offered: Option<ContextName>) {
        self.offered = offered;
    }

    /// A snapshot in fewer bytes, and from which one it was coded.
    pub(crate) fn encode(&mut self, bytes: &[u8]) -> Option<(ContextId, Vec<u8>)> {
        let offered = self.offered.filter(|_| is_short(bytes))?;
        let (_, known) = self.sent.iter().find(|(name, _)| *name == offered)?;
        Some((offered.id(), self.coder.with(offered.id(), known).encode(bytes)))
    }
}
