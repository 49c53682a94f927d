//! Snapshots that both sides have: the next one is much like them, so a coder that has learnt from one of them needs few bytes for it.

use super::offers::Offers;
use super::{CONTEXT_MAX, ContextId, ContextName, LastCoder};
use std::collections::VecDeque;

/// Snapshots between two offers.
const RENEW_AFTER: usize = 8;
/// The same while the last offer is unused.
const GIVE_UP_AFTER: usize = 64;
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
    /// Snapshots since the last offer.
    fresh: usize,
    offers: Offers,
    coder: LastCoder,
}

impl OfferedSnapshots {
    /// A snapshot was received.
    pub(crate) fn note(&mut self, sequence: u64, bytes: &[u8]) {
        if sequence > 0 && is_short(bytes) {
            let name = ContextName::of(sequence, sequence, bytes);
            self.newest = Some((name, bytes.to_vec()));
            self.fresh += 1;
        }
    }

    /// Decodes a snapshot of this length that was coded from another one. `None` without the other one, which a restart loses.
    /// Another one follows.
    pub(crate) fn decode(&mut self, id: ContextId, coded: &[u8], length: usize) -> Option<Vec<u8>> {
        let known = self.offers.find(id)?;
        self.coder.with(id, known).decode(coded, length)
    }

    /// The one from which the robot may code; a newer one if there is reason to.
    pub(crate) fn offer(&mut self) -> Option<ContextName> {
        let is_due = self.offers.is_due(self.fresh, RENEW_AFTER, GIVE_UP_AFTER);
        if is_due && let Some((name, bytes)) = self.newest.take() {
            self.fresh = 0;
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
