//! Recent events of an active run in memory. Lagging readers use the journal.
//!
//! Knows numbers and sizes. Does not know the readers, and never waits for them.

use super::event_group::EventGroup;
use rafcon_locks::Mutex;
use rafcon_protocol::Event;
use rafcon_storage::journal::stream::{StreamBlock, StreamDefinitions, StreamItem};
use rafcon_storage::journal::{Broken, Record};
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::watch;

/// Capacity per run in bytes, as received from the runner. Texts are about ten times as long.
const BYTES_MAX: usize = 512 << 10;
/// Approximate size of a group of events, in bytes.
const GROUP_BYTES: usize = 4 << 10;

/// The newest events of an active run.
#[derive(Debug)]
pub(crate) struct Ring {
    kept: Mutex<RingContent>,
    last: watch::Sender<u64>,
    folder: Option<PathBuf>,
    bytes_max: usize,
}

#[derive(Debug)]
struct RingContent {
    groups: VecDeque<Arc<EventGroup>>,
    bytes: usize,
    /// Number of the next event.
    next: u64,
    /// Definitions of the numbers that the runner uses.
    definitions: Arc<StreamDefinitions>,
}

/// Result of a read from a cursor on.
#[derive(Debug)]
pub(crate) enum EventsPage {
    /// These events are only in the journal.
    Behind,
    /// The next events in groups, of which the first may begin before the cursor. Empty if there are no new events.
    Events(Vec<Arc<EventGroup>>),
}

impl Ring {
    /// An empty ring. The run's journal is in `folder`.
    pub(super) fn new(folder: PathBuf) -> Self {
        Self::with_room(BYTES_MAX, Some(folder))
    }

    fn with_room(bytes_max: usize, folder: Option<PathBuf>) -> Self {
        let kept = Mutex::new(RingContent::empty(1, folder.clone()));
        Self { kept, last: watch::Sender::new(0), folder, bytes_max }
    }

    /// The groups with about `count` events from number `from` on.
    pub(crate) fn read(&self, from: u64, count: u64) -> EventsPage {
        let kept = self.kept.lock();
        let first = kept.groups.front().map_or(kept.next, |group| group.first);
        if from.max(1) < first {
            return EventsPage::Behind;
        }
        let skipped = kept.groups.partition_point(|group| group.next <= from);
        let groups = kept.groups.iter().skip(skipped);
        let wanted = groups.take_while(|group| group.first < from.saturating_add(count));
        EventsPage::Events(wanted.cloned().collect())
    }

    /// The number of the last event; `changed` waits for more. All events up to it can be read, here or in the journal.
    pub(crate) fn last(&self) -> watch::Receiver<u64> {
        self.last.subscribe()
    }

    /// Number of the next event.
    pub(super) fn next(&self) -> u64 {
        self.kept.lock().next
    }

    /// Adds events from a runner and skips known ones. After a gap, earlier events are only in the journal. Returns the last event
    /// of the run, if it is among them.
    pub(super) fn push(&self, bytes: &[u8]) -> Result<Option<Event>, Broken> {
        let (mut next, definitions) = {
            let kept = self.kept.lock();
            (kept.next, Arc::clone(&kept.definitions))
        };
        let mut finish = None;
        for block in StreamBlock::read_all(bytes) {
            let mut new = NewGroups::new(&definitions);
            let block = block?;
            let mut before_ns = block.t_before;
            for item in block.items() {
                let Some(StreamItem::Event { sequence, t_ns, record, bytes }) =
                    definitions.learn(item?)
                else {
                    continue;
                };
                if sequence >= next {
                    next = sequence + 1;
                    new.add(sequence, before_ns, bytes);
                    finish = finish_of(record).or(finish);
                }
                before_ns = t_ns;
            }
            self.add(new.into_groups());
        }
        Ok(finish)
    }

    fn add(&self, groups: Vec<EventGroup>) {
        let mut kept = self.kept.lock();
        for group in groups {
            kept.push(group);
        }
        while kept.bytes > self.bytes_max && kept.groups.len() > 1 {
            kept.drop_oldest();
        }
        let last = kept.next - 1;
        drop(kept);
        self.tell(last);
    }

    /// Empties the ring, because the journal contains all events up to number `last`.
    pub(super) fn settle(&self, last: u64) {
        let mut kept = self.kept.lock();
        let next = kept.next.max(last + 1);
        *kept = RingContent::empty(next, self.folder.clone());
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

/// Groups of events that are built from one block.
#[derive(Debug)]
struct NewGroups<'d> {
    definitions: &'d Arc<StreamDefinitions>,
    done: Vec<EventGroup>,
    first: u64,
    next: u64,
    t_before: u64,
    items: Vec<u8>,
}

impl<'d> NewGroups<'d> {
    fn new(definitions: &'d Arc<StreamDefinitions>) -> Self {
        Self { definitions, done: Vec::new(), first: 0, next: 0, t_before: 0, items: Vec::new() }
    }

    fn add(&mut self, sequence: u64, before_ns: u64, bytes: &[u8]) {
        if self.items.len() >= GROUP_BYTES {
            self.close();
        }
        if self.items.is_empty() {
            (self.first, self.t_before) = (sequence, before_ns);
        }
        self.items.extend_from_slice(bytes);
        self.next = sequence + 1;
    }

    fn close(&mut self) {
        if !self.items.is_empty() {
            let block =
                StreamBlock { first: self.first, t_before: self.t_before, items: &self.items };
            self.done.push(EventGroup::new(block, self.next, self.definitions));
            self.items.clear();
        }
    }

    fn into_groups(mut self) -> Vec<EventGroup> {
        self.close();
        self.done
    }
}

/// The event, if it is the last one of the run.
fn finish_of(record: Record) -> Option<Event> {
    match record {
        Record::Told(event) if matches!(*event, Event::Finished { .. }) => Some(*event),
        _ => None,
    }
}

impl RingContent {
    fn empty(next: u64, folder: Option<PathBuf>) -> Self {
        let definitions = Arc::new(StreamDefinitions::new(folder));
        Self { groups: VecDeque::new(), bytes: 0, next, definitions }
    }

    fn push(&mut self, group: EventGroup) {
        if group.first > self.next {
            self.groups.clear();
            self.bytes = 0;
        }
        self.next = group.next;
        self.bytes += bytes_of(&group);
        self.groups.push_back(Arc::new(group));
    }

    fn drop_oldest(&mut self) {
        if let Some(group) = self.groups.pop_front() {
            self.bytes -= bytes_of(&group);
        }
    }
}

/// Approximate memory of a group in bytes, without its texts.
fn bytes_of(group: &EventGroup) -> usize {
    group.items.len() + size_of::<EventGroup>()
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MAX, EventsPage, Ring};
    use crate::runs::event_group::EventText;
    use expect_test::expect;
    use proptest::prelude::*;
    use rafcon_protocol::{Event, Outcome};
    use rafcon_storage::journal::record::Content;
    use rafcon_storage::journal::stream::StreamBlock;
    use rafcon_storage::journal::{
        Definition, Item, Kept, Place, PlaceNumber, Record, Stored, ValueNumber,
    };
    use std::sync::Arc;

    /// A block of items whose first event has this number.
    fn block(first: u64, items: &[Item]) -> Vec<u8> {
        let (mut before, mut bytes, mut out) = (0, Vec::new(), Vec::new());
        for item in items {
            item.write(&mut before, &mut bytes);
        }
        StreamBlock { first, t_before: 0, items: &bytes }.write(&mut out);
        out
    }

    fn stopping() -> Item {
        Item::Record(0, Record::Told(Box::new(Event::Stopping)))
    }

    fn push(ring: &Ring, sequences: std::ops::RangeInclusive<u64>) {
        let items: Vec<Item> = sequences.clone().map(|_| stopping()).collect();
        assert!(ring.push(&block(*sequences.start(), &items)).unwrap().is_none());
    }

    fn read(ring: &Ring, from: u64) -> Option<Vec<u64>> {
        match ring.read(from, 100) {
            EventsPage::Behind => None,
            EventsPage::Events(groups) => {
                let texts = groups.iter().flat_map(|group| group.texts(true));
                Some(texts.map(|text| text.sequence).filter(|number| *number >= from).collect())
            }
        }
    }

    /// The texts of all events, one per line.
    fn texts(ring: &Ring, values: bool) -> String {
        let EventsPage::Events(groups) = ring.read(1, 100) else { panic!("the ring has them") };
        let texts = groups.iter().flat_map(|group| group.texts(values));
        let line = |text: &EventText| {
            format!("{} {}\n", text.sequence, text.text.as_deref().unwrap_or("-"))
        };
        texts.map(line).collect()
    }

    fn ring() -> Ring {
        Ring::with_room(BYTES_MAX, None)
    }

    #[test]
    fn whoever_is_not_far_behind_reads_here() {
        let ring = ring();
        assert_eq!(read(&ring, 0), Some(vec![]));
        push(&ring, 1..=3);
        assert_eq!(read(&ring, 0), Some(vec![1, 2, 3]));
        assert_eq!(read(&ring, 3), Some(vec![3]));
        assert_eq!(read(&ring, 4), Some(vec![]));
        assert_eq!(*ring.last().borrow(), 3);
    }

    #[test]
    fn what_came_before_the_link_or_is_over_is_in_the_journal() {
        let ring = ring();
        ring.settle(9);
        assert_eq!((read(&ring, 9), read(&ring, 10)), (None, Some(vec![])));
        push(&ring, 9..=10);
        assert_eq!((read(&ring, 9), read(&ring, 10)), (None, Some(vec![10])));
        ring.settle(12);
        assert_eq!((read(&ring, 12), read(&ring, 13)), (None, Some(vec![])));
        assert_eq!(*ring.last().borrow(), 12);
    }

    #[test]
    fn memory_is_bounded() {
        let ring = Ring::with_room(10 * (size_of::<super::EventGroup>() + 24), None);
        (1..=100).for_each(|sequence| push(&ring, sequence..=sequence));
        assert_eq!(read(&ring, 90), None);
        assert_eq!(read(&ring, 91), Some((91..=100).collect()));
        let ring = Ring::new(std::path::PathBuf::new());
        (1..=20_000).for_each(|sequence| push(&ring, sequence..=sequence));
        assert!((BYTES_MAX / 2..=BYTES_MAX).contains(&ring.kept.lock().bytes));
        assert_eq!((read(&ring, 1), read(&ring, 20_000)), (None, Some(vec![20_000])));
    }

    #[test]
    fn a_run_that_is_over_keeps_no_definitions() {
        let ring = ring();
        push(&ring, 1..=3);
        let EventsPage::Events(groups) = ring.read(1, 100) else { panic!("the ring has them") };
        let definitions = Arc::downgrade(&ring.kept.lock().definitions);
        ring.settle(3);
        assert!(definitions.upgrade().is_some(), "a reader still has events of it");
        drop(groups);
        assert!(definitions.upgrade().is_none());
    }

    #[test]
    fn events_are_spelled_with_and_without_values() {
        let place = Place {
            path: "R/A".to_owned(),
            names: "Root/A".to_owned(),
            is_library: false,
            is_script: true,
            inputs: vec![(1, "a".into())],
            outputs: vec![(2, "b".into())],
            scoped: Vec::new(),
            outcomes: vec![(0, "ok".into())],
        };
        let view = serde_json::json!([1, 2.5]);
        let content = Content::Nothing(String::new());
        let stored = Stored { view, type_name: "list".into(), content };
        let number = PlaceNumber(0);
        let items = [
            Item::Definition(Definition::Place(number, place)),
            Item::Definition(Definition::Value(ValueNumber(1), stored)),
            Item::Record(
                9,
                Record::Entered {
                    place: number,
                    inputs: vec![Kept::Value(ValueNumber(1))],
                    undoes: None,
                },
            ),
            Item::Record(12, Record::Global { name: "n".into(), value: Some(Kept::Int(3)) }),
            Item::Record(
                20,
                Record::Left {
                    place: number,
                    outcome: 0,
                    outputs: vec![Kept::Value(ValueNumber(2))],
                    error: None,
                    undoes: None,
                },
            ),
        ];
        let ring = ring();
        ring.push(&block(1, &items)).unwrap();
        expect![[r#"
            1 {"sequence":1,"t_ns":9,"event":{"type":"entered","path":"R/A","inputs":{"a":[1,2.5]}}}
            2 {"sequence":2,"t_ns":12,"event":{"type":"global","name":"n","value":3}}
            3 {"sequence":3,"t_ns":20,"event":{"type":"left","path":"R/A","outcome":{"id":0,"name":"ok"},"outputs":{"b":{"__class__":"","__repr__":"<no longer kept>"}}}}
        "#]].assert_eq(&texts(&ring, true));
        expect![[r#"
            1 {"sequence":1,"t_ns":9,"event":{"type":"entered","path":"R/A"}}
            2 -
            3 {"sequence":3,"t_ns":20,"event":{"type":"left","path":"R/A","outcome":{"id":0,"name":"ok"}}}
        "#]].assert_eq(&texts(&ring, false));
    }

    #[test]
    fn the_last_event_of_a_run_is_given() {
        let outcome = Outcome { id: 0, name: "ok".to_owned() };
        let finished = Event::Finished {
            outcome,
            outputs: serde_json::Map::new(),
            globals: serde_json::Map::new(),
            scoped_variables: serde_json::Map::new(),
            states_run: 2,
        };
        let last = Item::Record(0, Record::Told(Box::new(finished.clone())));
        let ring = ring();
        assert_eq!(ring.push(&block(1, &[stopping(), last])).unwrap(), Some(finished));
        assert_eq!(*ring.last().borrow(), 2);
    }

    proptest! {
        /// Whatever a runner repeats or omits, a reader that uses the journal where needed sees each event once.
        #[test]
        fn a_reader_sees_every_number_once(pushed in prop::collection::vec(1..200_u64, 1..200)) {
            let ring = Ring::with_room(20 * (size_of::<super::EventGroup>() + 24), None);
            let (mut next, mut seen) = (1, 0);
            for sequence in pushed {
                push(&ring, sequence..=sequence);
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

        /// A runner that sends arbitrary bytes is refused without further effect.
        #[test]
        fn any_bytes_are_events_or_broken(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let ring = ring();
            drop(ring.push(&bytes));
            if let EventsPage::Events(groups) = ring.read(ring.next().saturating_sub(9), 100) {
                let texts = groups.iter().map(|group| group.texts(true).len());
                prop_assert!(texts.sum::<usize>() <= 200);
            }
        }
    }
}
