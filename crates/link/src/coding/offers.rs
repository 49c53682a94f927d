//! Contexts that a station keeps and offers to the robot, one at a time.

use super::{ContextId, ContextName};
use std::collections::VecDeque;

/// Offered contexts, the newest last, at most `KEPT`.
#[derive(Debug, Default)]
pub(super) struct Offers<const KEPT: usize> {
    kept: VecDeque<Offer>,
}

#[derive(Debug)]
struct Offer {
    name: ContextName,
    bytes: Vec<u8>,
    is_used: bool,
}

impl<const KEPT: usize> Offers<KEPT> {
    /// The bytes that a datagram names, which are used from now on.
    pub(super) fn find(&mut self, id: ContextId) -> Option<&[u8]> {
        let found = self.kept.iter_mut().find(|offer| offer.name.id() == id)?;
        found.is_used = true;
        Some(&found.bytes)
    }

    /// True if the next offer is due. The threshold depends on whether the newest offer is in use.
    pub(super) fn is_due(&self, fresh: usize, if_used: usize, if_unused: usize) -> bool {
        let newest = self.kept.back();
        newest.is_none_or(|newest| fresh >= if newest.is_used { if_used } else { if_unused })
    }

    /// Offers a context, unless its name of three bytes equals that of a kept one.
    pub(super) fn push(&mut self, name: ContextName, bytes: Vec<u8>) {
        if self.kept.iter().any(|offer| offer.name.id() == name.id()) {
            return;
        }
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

#[cfg(test)]
mod tests {
    use super::{ContextName, Offers};
    use std::collections::BTreeMap;

    #[test]
    fn two_that_a_datagram_names_alike_are_not_kept_at_once() {
        let mut by_id = BTreeMap::new();
        let alike = (1_u64..).find_map(|number| {
            let name = ContextName::of(number, number, &number.to_be_bytes());
            by_id.insert(name.id().0, name).map(|other| [other, name])
        });
        let [first, second] = alike.unwrap();
        let mut offers = Offers::<3>::default();
        offers.push(first, b"first".to_vec());
        offers.push(second, b"second".to_vec());
        assert_eq!(offers.newest(), Some(first));
        assert_eq!(offers.find(second.id()), Some(&b"first"[..]));
    }
}
