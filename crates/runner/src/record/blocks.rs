//! The recent events in memory: a stream in blocks, whose oldest block is dropped for the newest. This module knows
//! bytes and numbers, but no readers.

use rafcon_storage::journal::stream::{StreamBlock, StreamItem};
use rafcon_storage::journal::{Reader, Record};
use std::collections::VecDeque;
use std::path::Path;

/// Size in bytes at which a block is full.
const BLOCK_BYTES: usize = 64 << 10;
/// Distance between the entry points of a block, in bytes. A reader skips at most this many bytes.
const MARK_EVERY: usize = 4 << 10;

/// The beginning of an event in a block.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Mark {
    /// Number of the event.
    pub(crate) sequence: u64,
    /// The time of the event before it.
    pub(crate) before_ns: u64,
    /// Index of its first byte.
    pub(crate) start: usize,
}

/// Consecutive items in a block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) mark: Mark,
    /// Index after the last byte.
    pub(crate) end: usize,
}

/// Events of one moment, with the definitions that they need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Encoded<'b> {
    pub(crate) bytes: &'b [u8],
    /// Number of events in `bytes`.
    pub(crate) count: u64,
    /// The time of the event before them.
    pub(crate) before_ns: u64,
    /// The time of their last event.
    pub(crate) last_ns: u64,
    /// The rare items, which every viewer receives. Their numbers count from 0.
    pub(crate) rare: &'b [Piece],
}

/// The bounded list of blocks.
#[derive(Debug)]
pub(crate) struct Blocks {
    list: VecDeque<RecordBlock>,
    bytes: usize,
    limit: usize,
    /// The number of the next event.
    next: u64,
}

#[derive(Debug, Default)]
struct RecordBlock {
    bytes: Vec<u8>,
    marks: Vec<Mark>,
    rare: Vec<Piece>,
    /// Beginning of the next event.
    end: Mark,
}

impl Blocks {
    /// An empty list. The next event has the number `next`, and about `limit` bytes are kept.
    pub(crate) fn new(next: u64, limit: usize) -> Self {
        Self { list: VecDeque::new(), bytes: 0, limit, next }
    }

    /// The number of the next event.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// The number of the oldest event in the list.
    pub(crate) fn first(&self) -> u64 {
        self.list.front().map_or(self.next, RecordBlock::first)
    }

    /// Adds events to the newest block.
    pub(crate) fn push(&mut self, new: Encoded<'_>) {
        if self.list.back().is_none_or(|block| block.bytes.len() >= BLOCK_BYTES) {
            let room = self.room();
            self.list.push_back(room);
        }
        let Some(block) = self.list.back_mut() else { return };
        block.push(self.next, new);
        self.bytes += new.bytes.len();
        self.next += new.count;
    }

    /// An empty block. The oldest one is reused once the limit is reached.
    fn room(&mut self) -> RecordBlock {
        let mut room = RecordBlock::default();
        while self.bytes >= self.limit {
            let Some(oldest) = self.list.pop_front() else { break };
            self.bytes -= oldest.bytes.len();
            room = oldest;
        }
        room.clear();
        room
    }

    /// Copies events with numbers from `from` to before `end` to `into`: those of one block, or only its rare ones.
    /// Returns the number to continue with.
    pub(crate) fn read(&self, from: u64, end: u64, rare: bool, into: &mut Chunk) -> u64 {
        into.clear();
        let after = self.list.partition_point(|block| block.first() <= from);
        let Some(block) = after.checked_sub(1).and_then(|index| self.list.get(index)) else {
            return from;
        };
        let next = block.end.sequence.min(end).max(from);
        if rare {
            block.rare_between(from, next).for_each(|piece| into.push(&block.bytes, *piece));
        } else if from < next {
            into.take(block, from, next);
        }
        next
    }
}

impl RecordBlock {
    fn first(&self) -> u64 {
        self.marks.first().map_or(u64::MAX, |mark| mark.sequence)
    }

    fn clear(&mut self) {
        self.bytes.clear();
        self.marks.clear();
        self.rare.clear();
    }

    fn push(&mut self, first: u64, new: Encoded<'_>) {
        let start = self.bytes.len();
        if self.marks.last().is_none_or(|mark| start - mark.start >= MARK_EVERY) {
            self.marks.push(Mark { sequence: first, before_ns: new.before_ns, start });
        }
        self.rare.extend(new.rare.iter().map(|piece| piece.moved(first, start)));
        self.bytes.extend_from_slice(new.bytes);
        self.end =
            Mark { sequence: first + new.count, before_ns: new.last_ns, start: self.bytes.len() };
    }

    /// The last entry point at or before event `sequence`.
    fn mark(&self, sequence: u64) -> Mark {
        if sequence == self.end.sequence {
            return self.end;
        }
        let after = self.marks.partition_point(|mark| mark.sequence <= sequence);
        after.checked_sub(1).and_then(|index| self.marks.get(index)).copied().unwrap_or_default()
    }

    fn rare_between(&self, from: u64, end: u64) -> impl Iterator<Item = &Piece> {
        let first = self.rare.partition_point(|piece| piece.mark.sequence < from);
        let after = self.rare.partition_point(|piece| piece.mark.sequence < end);
        self.rare[first..after].iter()
    }
}

impl Piece {
    fn moved(mut self, sequence: u64, start: usize) -> Self {
        self.mark.sequence += sequence;
        self.mark.start += start;
        self.end += start;
        self
    }
}

/// Events copied for a reader. The buffers are reused.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    bytes: Vec<u8>,
    pieces: Vec<Piece>,
    /// Set if the last piece is too long: the entry point before its end, and the first event to cut off.
    tail: Option<(Mark, u64)>,
    /// The reader's position, and the first event of its block.
    place: Option<(u64, Mark)>,
}

impl Chunk {
    fn clear(&mut self) {
        self.bytes.clear();
        self.pieces.clear();
        self.tail = None;
    }

    fn push(&mut self, bytes: &[u8], piece: Piece) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(&bytes[piece.mark.start..piece.end]);
        let mark = Mark { start, ..piece.mark };
        self.pieces.push(Piece { mark, end: self.bytes.len() });
    }

    /// Copies the events of a block from number `from` to before `end`.
    fn take(&mut self, block: &RecordBlock, from: u64, end: u64) {
        let here = block.first();
        let mark = match self.place.take() {
            Some((first, mark)) if first == here && mark.sequence == from => mark,
            _ => block.mark(from),
        };
        self.push(&block.bytes, Piece { mark, end: block.end.start });
        if end == block.end.sequence {
            self.place = Some((here, block.end));
            return;
        }
        let near = block.mark(end);
        let near = if near.start < mark.start { mark } else { near };
        self.tail = Some((Mark { start: near.start - mark.start, ..near }, end));
        self.place = Some((here, Mark { start: mark.start, ..Mark::default() }));
    }

    /// Cuts off the surplus of the last piece. This is not part of reading, which blocks the writer.
    pub(crate) fn trim(&mut self) {
        let Some((near, end)) = self.tail.take() else { return };
        let block = StreamBlock {
            first: near.sequence,
            t_before: near.before_ns,
            items: &self.bytes[near.start..],
        };
        let (mut items, mut mark) = (block.items(), near);
        while mark.sequence < end
            && let Some(Ok(item)) = items.next()
        {
            if let StreamItem::Event { .. } = item {
                let (sequence, before_ns, rest) = items.position();
                mark = Mark { sequence, before_ns, start: self.bytes.len() - rest };
            }
        }
        self.bytes.truncate(mark.start);
        if let Some(piece) = self.pieces.last_mut() {
            piece.end = mark.start;
        }
        if let Some((_, place)) = &mut self.place {
            *place = Mark { start: place.start + mark.start, ..mark };
        }
    }

    /// The events as blocks of a stream.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = StreamBlock<'_>> {
        self.pieces.iter().map(|piece| StreamBlock {
            first: piece.mark.sequence,
            t_before: piece.mark.before_ns,
            items: &self.bytes[piece.mark.start..piece.end],
        })
    }
}

/// Number of events read at once.
const PAGE: usize = 4096;

/// A journal that is opened on first use.
#[derive(Debug, Default)]
pub(crate) struct Archive {
    reader: Option<Reader>,
}

impl Archive {
    /// A page of events with numbers from `from` to before `end`; `None` if they are unavailable.
    pub(crate) fn page(
        &mut self,
        folder: Option<&Path>,
        from: u64,
        end: u64,
    ) -> Option<Vec<(u64, u64, Record)>> {
        let page = self.open(folder)?.page(from, PAGE).ok()?;
        let wanted = page.into_iter().take_while(|entry| entry.sequence < end);
        let records: Vec<_> =
            wanted.map(|entry| (entry.sequence, entry.t_ns, entry.record)).collect();
        (!records.is_empty()).then_some(records)
    }

    fn open(&mut self, folder: Option<&Path>) -> Option<&mut Reader> {
        if self.reader.is_none() {
            self.reader = Reader::open(folder?).ok();
        }
        self.reader.as_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::{Blocks, Chunk, Encoded, Mark, Piece};
    use expect_test::{Expect, expect};
    use proptest::prelude::*;
    use rafcon_storage::journal::stream::StreamItem;
    use rafcon_storage::journal::{Item, PlaceNumber, Record};

    /// A long line, which every viewer receives.
    fn line(number: u64) -> Record {
        let message = format!("{number:>8000}");
        Record::Log {
            place: None,
            level: rafcon_protocol::LogLevel::Info,
            stream: rafcon_protocol::Stream::Stdout,
            message,
        }
    }

    /// Pushes this many lines, with an entry before each.
    fn blocks(lines: u64) -> Blocks {
        let mut blocks = Blocks::new(1, 200_000);
        let mut before = 0;
        for number in 0..lines {
            let (mut bytes, before_ns) = (Vec::new(), before);
            let entered =
                Record::Entered { place: PlaceNumber(0), inputs: Vec::new(), undoes: None };
            Item::Record(number * 10, entered).write(&mut before, &mut bytes);
            let mark = Mark { sequence: 1, before_ns: before, start: bytes.len() };
            Item::Record(number * 10 + 5, line(number)).write(&mut before, &mut bytes);
            let rare = [Piece { mark, end: bytes.len() }];
            let last_ns = before;
            blocks.push(Encoded { bytes: &bytes, count: 2, before_ns, last_ns, rare: &rare });
        }
        blocks
    }

    /// Numbers and times of a chunk's events from number `from` on. An entry point may be before it.
    fn events(chunk: &Chunk, from: u64) -> Vec<(u64, u64)> {
        let items = chunk.blocks().flat_map(|block| block.items().collect::<Vec<_>>());
        let events = items.filter_map(|item| match item.unwrap() {
            StreamItem::Event { sequence, t_ns, .. } => Some((sequence, t_ns)),
            _ => None,
        });
        events.filter(|(sequence, _)| *sequence >= from).collect()
    }

    fn check(lines: u64, from: u64, end: u64, rare: bool, expect: &Expect) {
        let blocks = blocks(lines);
        let mut chunk = Chunk::default();
        let next = blocks.read(from.max(blocks.first()), end, rare, &mut chunk);
        chunk.trim();
        let events = events(&chunk, from);
        let shown = events.get(..3).unwrap_or(&events);
        expect.assert_eq(&format!("{shown:?} of {}, next {next}", events.len()));
    }

    #[test]
    fn a_reader_goes_on_where_it_was() {
        check(2, 1, 9, false, &expect!["[(1, 0), (2, 5), (3, 10)] of 4, next 5"]);
        check(2, 4, 9, false, &expect!["[(4, 15)] of 1, next 5"]);
        check(2, 5, 9, false, &expect!["[] of 0, next 5"]);
    }

    #[test]
    fn a_reader_gets_what_it_may_know() {
        check(2, 1, 3, false, &expect!["[(1, 0), (2, 5)] of 2, next 3"]);
    }

    #[test]
    fn who_wants_the_rare_ones_gets_no_others() {
        check(3, 1, 99, true, &expect!["[(2, 5), (4, 15), (6, 25)] of 3, next 7"]);
        check(3, 4, 99, true, &expect!["[(4, 15), (6, 25)] of 2, next 7"]);
    }

    #[test]
    fn the_oldest_are_given_up() {
        check(100, 1, 999, false, &expect!["[(163, 810), (164, 815), (165, 820)] of 18, next 181"]);
    }

    proptest! {
        /// However much becomes readable at a time, a reader that continues at its position receives each event once,
        /// and no event before the requested one.
        #[test]
        fn a_reader_that_goes_on_gets_each_event_once(steps in prop::collection::vec(0..30_u64, 1..40)) {
            let blocks = blocks(20);
            let (mut chunk, mut from, mut end, mut seen) = (Chunk::default(), 1, 1, Vec::new());
            for step in steps {
                end = (end + step).min(blocks.next());
                while from < end {
                    let next = blocks.read(from, end, false, &mut chunk);
                    chunk.trim();
                    prop_assert!(seen.is_empty() || events(&chunk, 0).first().is_none_or(|event| event.0 == from));
                    seen.extend(events(&chunk, from).into_iter().map(|(sequence, _)| sequence));
                    from = next;
                }
                prop_assert_eq!(&seen, &(1..from).collect::<Vec<_>>());
            }
        }
    }
}
