//! The newest events of a run that goes on, in memory: for all who are not far behind. Whoever is reads the journal.
//!
//! Knows numbers and sizes. Must never know who reads, nor wait for them.

use super::encoded_event::EncodedEvent;
use rafcon_locks::Mutex;
use std::collections::VecDeque;
use std::sync::Arc;
use tokio::sync::watch;

/// So many bytes of events are kept for each run.
const BYTES_MAX: usize = 4 << 20;

/// The newest events of one run.
#[derive(Debug)]
pub(crate) struct Ring {
    kept: Mutex<RingContent>,
    last: watch::Sender<u64>,
    bytes_max: usize,
}

#[derive(Debug)]
struct RingContent {
    events: VecDeque<Arc<EncodedEvent>>,
    bytes: usize,
    /// The number of the event that comes next.
    next: u64,
}

/// What there is from a cursor on.
#[derive(Debug)]
pub(crate) enum EventsPage {
    /// These events are only in the journal.
    Behind,
    /// The events that follow; none: nothing happened since.
    Events(Vec<Arc<EncodedEvent>>),
}

impl Default for Ring {
    fn default() -> Self {
        Self::with_room(BYTES_MAX)
    }
}

impl Ring {
    fn with_room(bytes_max: usize) -> Self {
        let kept = RingContent { events: VecDeque::new(), bytes: 0, next: 1 };
        Self { kept: Mutex::new(kept), last: watch::Sender::new(0), bytes_max }
    }

    /// At most `count` events from number `from` on.
    pub(crate) fn read(&self, from: u64, count: usize) -> EventsPage {
        let kept = self.kept.lock();
        let first = kept.next - kept.events.len() as u64;
        let Some(skipped) = from.max(1).checked_sub(first) else { return EventsPage::Behind };
        let skipped = usize::try_from(skipped).unwrap_or(usize::MAX);
        EventsPage::Events(kept.events.iter().skip(skipped).take(count).cloned().collect())
    }

    /// The number of the last event; with `changed`, when there are more. All up to it can be read, here or in the journal.
    pub(crate) fn last(&self) -> watch::Receiver<u64> {
        self.last.subscribe()
    }

    /// The number of the event that comes next.
    pub(super) fn next(&self) -> u64 {
        self.kept.lock().next
    }

    /// Takes events in, in their order. What is known already is left out; behind a gap, all before it is in the journal only.
    pub(super) fn push(&self, events: impl IntoIterator<Item = EncodedEvent>) {
        let mut kept = self.kept.lock();
        for told in events {
            kept.push(told);
        }
        while kept.bytes > self.bytes_max && kept.events.len() > 1 {
            kept.drop_oldest();
        }
        let last = kept.next - 1;
        drop(kept);
        self.tell(last);
    }

    /// Everything up to number `last` is in the journal, and memory is given back.
    pub(super) fn settle(&self, last: u64) {
        let mut kept = self.kept.lock();
        let next = kept.next.max(last + 1);
        *kept = RingContent { events: VecDeque::new(), bytes: 0, next };
        drop(kept);
        self.tell(next - 1);
    }

    fn tell(&self, last: u64) {
        self.last.send_if_modified(|told| {
            let is_more = last > *told;
            *told = last.max(*told);
            is_more
        });
    }
}

impl RingContent {
    fn push(&mut self, told: EncodedEvent) {
        if told.sequence < self.next {
            return;
        }
        if told.sequence > self.next {
            self.events.clear();
            self.bytes = 0;
        }
        self.next = told.sequence + 1;
        self.bytes += told.bytes();
        self.events.push_back(Arc::new(told));
    }

    fn drop_oldest(&mut self) {
        if let Some(told) = self.events.pop_front() {
            self.bytes -= told.bytes();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{EventsPage, Ring};
    use crate::runs::encoded_event::EncodedEvent;
    use proptest::prelude::*;

    fn told(sequence: u64) -> EncodedEvent {
        let event = r#"{"type":"stopping"}"#;
        let line =
            format!(r#"{{"message":"event","sequence":{sequence},"t_ns":0,"event":{event}}}"#);
        EncodedEvent::read(&line).unwrap()
    }

    fn read(ring: &Ring, from: u64) -> Option<Vec<u64>> {
        match ring.read(from, 100) {
            EventsPage::Behind => None,
            EventsPage::Events(events) => Some(events.iter().map(|told| told.sequence).collect()),
        }
    }

    #[test]
    fn whoever_is_not_far_behind_reads_here() {
        let ring = Ring::default();
        assert_eq!(read(&ring, 0), Some(vec![]));
        ring.push([told(1), told(2), told(3)]);
        assert_eq!(read(&ring, 0), Some(vec![1, 2, 3]));
        assert_eq!(read(&ring, 3), Some(vec![3]));
        assert_eq!(read(&ring, 4), Some(vec![]));
        assert_eq!(*ring.last().borrow(), 3);
    }

    #[test]
    fn what_came_before_the_link_or_is_over_is_in_the_journal() {
        let ring = Ring::default();
        ring.settle(9);
        assert_eq!((read(&ring, 9), read(&ring, 10)), (None, Some(vec![])));
        ring.push([told(9), told(10)]);
        assert_eq!((read(&ring, 9), read(&ring, 10)), (None, Some(vec![10])));
        ring.settle(12);
        assert_eq!((read(&ring, 12), read(&ring, 13)), (None, Some(vec![])));
        assert_eq!(*ring.last().borrow(), 12);
    }

    #[test]
    fn memory_is_bounded() {
        let ring = Ring::with_room(10 * told(100).bytes());
        ring.push((1..=100).map(told));
        assert_eq!(read(&ring, 90), None);
        assert_eq!(read(&ring, 91), Some((91..=100).collect()));
    }

    proptest! {
        /// Whatever a runner repeats or leaves out, a reader that turns to the journal where it must sees each event once.
        #[test]
        fn a_reader_sees_every_number_once(pushed in prop::collection::vec(1..200_u64, 1..200)) {
            let ring = Ring::with_room(20 * told(1).bytes());
            let (mut next, mut seen) = (1, 0);
            for sequence in pushed {
                ring.push([told(sequence)]);
                while next <= *ring.last().borrow() {
                    match read(&ring, next) {
                        None => next += 1,
                        Some(events) => {
                            prop_assert_eq!(events.first(), Some(&next));
                            next = events.last().unwrap() + 1;
                        }
                    }
                    seen += 1;
                    prop_assert!(seen < 100_000);
                }
            }
        }
    }
}
