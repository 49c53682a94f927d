//! Contexts that the coders of both sides learn from: recent events of the station, identified by their hash.

use super::Coder;
use super::offers::Offers;
use rafcon_events::{EventBlock, EventBlockRef};
use ring::digest::{SHA256, digest};
use std::collections::BTreeMap;

/// Capacity of a context, in bytes of items.
pub(crate) const CONTEXT_MAX: usize = 8_192;
/// From fewer it learns too little.
const CONTEXT_MIN: usize = 512;
/// Bytes of items between two offers of contexts.
const RENEW_AFTER: usize = 8_192;
/// The same while the last offer is unused.
const GIVE_UP_AFTER: usize = 65_536;
/// Capacity for the newest events, in bytes.
const RECENT_MAX: usize = 32_768;
/// Kept offers: the one that is used, the one before, and the one that is offered.
const OFFERS: usize = 3;
/// Number of the newest groups of events that a context can end with.
const ENDS: usize = 16;

/// A context, as a datagram that needs it names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ContextId(pub(crate) [u8; 3]);

/// Which events a context is made of, and the hash of their items.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ContextName {
    pub(crate) first: u64,
    pub(crate) last: u64,
    pub(crate) hash: [u8; 8],
}

impl ContextName {
    /// The name of the context of these events.
    pub(crate) fn of(first: u64, last: u64, items: &[u8]) -> Self {
        let mut hash = [0; 8];
        let whole = digest(&SHA256, items);
        hash.iter_mut().zip(whole.as_ref()).for_each(|(to, from)| *to = *from);
        Self { first, last, hash }
    }

    pub(crate) fn id(&self) -> ContextId {
        let [a, b, c, ..] = self.hash;
        ContextId([a, b, c])
    }
}

/// The coder of one run, with the context that was used last. It is made when it is needed.
#[derive(Debug, Default)]
pub(crate) struct LastCoder {
    last: Option<(ContextId, Coder)>,
}

impl LastCoder {
    /// The coder with this context, of these items.
    pub(crate) fn with(&mut self, id: ContextId, items: &[u8]) -> &mut Coder {
        let known = self.last.take().filter(|(of, _)| *of == id);
        let (_, coder) = self.last.insert(known.unwrap_or_else(|| (id, Coder::new(items))));
        coder
    }
}

/// The newest events of a run at its station, the source of contexts.
#[derive(Debug, Default)]
pub(crate) struct Contexts {
    /// Groups of events by their last event. The longest group of each is kept.
    recent: BTreeMap<u64, EventBlock>,
    bytes: usize,
    /// Bytes received since the last context.
    fresh: usize,
    offers: Offers<OFFERS>,
}

impl Contexts {
    /// Events that were received, new or again.
    pub(crate) fn note(&mut self, block: EventBlockRef<'_>) {
        let (last, length) = (block.last_sequence(), block.bytes.len());
        let is_shorter = |known: &EventBlock| known.first_sequence <= block.first_sequence;
        if length > CONTEXT_MAX || self.recent.get(&last).is_some_and(is_shorter) {
            return;
        }
        (self.bytes, self.fresh) = (self.bytes + length, self.fresh + length);
        if let Some(shorter) = self.recent.insert(last, block.to_block()) {
            self.bytes -= shorter.bytes.len();
        }
        while self.bytes > RECENT_MAX
            && let Some((_, oldest)) = self.recent.pop_first()
        {
            self.bytes -= oldest.bytes.len();
        }
    }

    /// The items of a context that a datagram names.
    pub(crate) fn find(&mut self, id: ContextId) -> Option<&[u8]> {
        self.offers.find(id)
    }

    /// The context that the robot may use; a newer one if there is reason to.
    pub(crate) fn offer(&mut self) -> Option<ContextName> {
        let is_due = self.offers.is_due(self.fresh, RENEW_AFTER, GIVE_UP_AFTER);
        if is_due && let Some((name, items)) = self.make() {
            self.fresh = 0;
            self.offers.push(name, items);
        }
        self.offers.newest()
    }

    /// The most that follows upon another without a gap, near the end.
    fn make(&self) -> Option<(ContextName, Vec<u8>)> {
        let ends = self.recent.keys().rev().take(ENDS);
        let chains = ends.map(|last| (self.chain(*last), *last));
        let ((first, length), last) = chains.max_by_key(|((_, length), _)| *length)?;
        if length < CONTEXT_MIN {
            return None;
        }
        let mut groups = Vec::new();
        let mut next = last;
        while let Some(block) = self.recent.get(&next).filter(|block| block.first_sequence >= first)
        {
            groups.push(block.bytes.as_slice());
            next = block.first_sequence - 1;
        }
        groups.reverse();
        let items = groups.concat();
        Some((ContextName::of(first, last, &items), items))
    }

    /// From which event on all are at hand up to `last`, and the length of their items.
    fn chain(&self, last: u64) -> (u64, usize) {
        let (mut first, mut length) = (last + 1, 0);
        while let Some(block) = self.recent.get(&(first - 1))
            && length + block.bytes.len() <= CONTEXT_MAX
        {
            (first, length) = (block.first_sequence, length + block.bytes.len());
        }
        (first, length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noted(lengths: &[usize]) -> Contexts {
        let mut contexts = Contexts::default();
        for (first, length) in (1..).zip(lengths) {
            let items = vec![7; *length];
            contexts.note(EventBlockRef {
                first_sequence: first,
                count: 1,
                time_before: 0,
                bytes: &items,
            });
        }
        contexts
    }

    #[test]
    fn a_context_is_made_of_so_many_bytes_at_most() {
        let offer = |lengths: &[usize]| noted(lengths).offer().map(|name| (name.first, name.last));
        let most = CONTEXT_MAX;
        assert_eq!(offer(&[most]), Some((1, 1)));
        assert_eq!(offer(&[most + 1]), None);
        assert_eq!(offer(&[most / 2, most / 2]), Some((1, 2)));
        assert_eq!(offer(&[1, most / 2, most / 2]), Some((2, 3)));
        assert_eq!(offer(&[most + 1, most]), Some((2, 2)));
    }

    #[test]
    fn of_the_newest_events_so_many_bytes_are_at_hand() {
        let at_hand = |lengths: &[usize]| {
            let contexts = noted(lengths);
            (contexts.recent.keys().next().copied(), contexts.bytes)
        };
        let (quarter, most) = (RECENT_MAX / 4, RECENT_MAX);
        assert_eq!(at_hand(&[quarter; 4]), (Some(1), most));
        assert_eq!(
            at_hand(&[quarter, quarter, quarter, quarter, 1]),
            (Some(2), most - quarter + 1)
        );
        assert_eq!(at_hand(&[quarter; 100]), (Some(97), most));
    }
}
