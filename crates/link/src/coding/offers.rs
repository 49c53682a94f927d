//! What a station keeps for a coder to learn from, and offers the robot: one after the other, as they are used.

use super::{ContextId, ContextName};
use std::collections::VecDeque;

/// The one that is used, the one before, and the one that is offered.
const KEPT: usize = 3;

/// What is offered, the newest last.
#[derive(Debug, Default)]
pub(super) struct Offers {
    kept: VecDeque<Offer>,
}

#[derive(Debug)]
struct Offer {
    name: ContextName,
    bytes: Vec<u8>,
    is_used: bool,
}

impl Offers {
    /// The bytes that a datagram names, which are used from now on.
    pub(super) fn find(&mut self, id: ContextId) -> Option<&[u8]> {
        let found = self.kept.iter_mut().find(|offer| offer.name.id() == id)?;
        found.is_used = true;
        Some(&found.bytes)
    }

    /// Whether it is time for another one: after so much that is fresh if the newest is used, else after so much.
    pub(super) fn is_due(&self, fresh: usize, if_used: usize, if_unused: usize) -> bool {
        let newest = self.kept.back();
        newest.is_none_or(|newest| fresh >= if newest.is_used { if_used } else { if_unused })
    }

    /// Offers this one.
    pub(super) fn push(&mut self, name: ContextName, bytes: Vec<u8>) {
        self.kept.push_back(Offer { name, bytes, is_used: false });
        if self.kept.len() > KEPT {
            self.kept.pop_front();
        }
    }

    /// The one that is offered.
    pub(super) fn newest(&self) -> Option<ContextName> {
        self.kept.back().map(|newest| newest.name)
    }
}
