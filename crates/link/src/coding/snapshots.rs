//! Snapshots that both sides have: the next one is much like them, so a coder that has learnt from one of them needs few bytes for it.

use super::{CONTEXT_MAX, ContextId, ContextName, LastCoder};
use std::collections::VecDeque;

/// Another one is offered after so many snapshots.
const RENEW_AFTER: u32 = 8;
/// And after so many although the one that was offered was never used.
const GIVE_UP_AFTER: u32 = 64;
/// The one that is used, the one before, and the one that is offered.
const KEPT: usize = 3;
/// The robot keeps so many bytes of what it sent: the station may still offer it.
const SENT_MAX: usize = 256 << 10;

/// Whether a snapshot is short enough to learn from it, and to be coded.
fn is_short(bytes: &[u8]) -> bool {
    bytes.len() <= CONTEXT_MAX
}

/// The snapshots that a station has at hand, some of which it offers.
#[derive(Debug, Default)]
pub(crate) struct OfferedSnapshots {
    newest: Option<(ContextName, Vec<u8>)>,
    /// How many came since one was offered.
    fresh: u32,
    /// The newest is the last one.
    kept: VecDeque<Offered>,
}

#[derive(Debug)]
struct Offered {
    name: ContextName,
    bytes: Vec<u8>,
    is_used: bool,
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

    /// The snapshot from which a datagram was coded.
    pub(crate) fn find(&mut self, id: ContextId) -> Option<&[u8]> {
        let found = self.kept.iter_mut().find(|offered| offered.name.id() == id)?;
        found.is_used = true;
        Some(&found.bytes)
    }

    /// The one from which the robot may code; a newer one if there is reason to.
    pub(crate) fn offer(&mut self) -> Option<ContextName> {
        let is_due = self.kept.back().is_none_or(|newest| {
            self.fresh >= if newest.is_used { RENEW_AFTER } else { GIVE_UP_AFTER }
        });
        if is_due && let Some((name, bytes)) = self.newest.take() {
            self.fresh = 0;
            self.kept.push_back(Offered { name, bytes, is_used: false });
            if self.kept.len() > KEPT {
                self.kept.pop_front();
            }
        }
        self.kept.back().map(|newest| newest.name)
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
