//! What happened lately, in memory: encoded records in blocks, the oldest given up for the newest. Knows bytes and numbers;
//! must never know who reads.

use rafcon_storage::journal::record::Items;
use rafcon_storage::journal::{Item, Record};
use std::collections::VecDeque;

/// A block is full with so many bytes.
const BLOCK_BYTES: usize = 64 << 10;
/// From one entry point of a block to the next, in bytes: what a reader decodes in vain at most.
const MARK_EVERY: usize = 4 << 10;

/// Where a record begins.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Mark {
    /// Its number.
    pub(crate) sequence: u64,
    /// The time of the record before it.
    pub(crate) before_ns: u64,
    /// Its first byte.
    pub(crate) start: usize,
}

/// Records that lie one after the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) mark: Mark,
    /// The byte after the last one.
    pub(crate) end: usize,
}

/// Records that happened at once, encoded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Encoded<'b> {
    pub(crate) bytes: &'b [u8],
    /// How many records there are.
    pub(crate) count: u64,
    /// The time of the record before them.
    pub(crate) before_ns: u64,
    /// Those that every viewer is told: their numbers count from 0.
    pub(crate) rare: &'b [Piece],
}

/// The bounded list of blocks.
#[derive(Debug)]
pub(crate) struct Blocks {
    list: VecDeque<RecordBlock>,
    bytes: usize,
    limit: usize,
    /// The number of the next record.
    next: u64,
}

#[derive(Debug, Default)]
struct RecordBlock {
    bytes: Vec<u8>,
    marks: Vec<Mark>,
    rare: Vec<Piece>,
}

impl Blocks {
    /// Nothing yet; the next record has the number `next`, and about `limit` bytes are kept.
    pub(crate) fn new(next: u64, limit: usize) -> Self {
        Self { list: VecDeque::new(), bytes: 0, limit, next }
    }

    /// The number of the next record.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// The number of the oldest record that is still there.
    pub(crate) fn first(&self) -> u64 {
        self.list.front().and_then(|block| block.marks.first()).map_or(self.next, |m| m.sequence)
    }

    /// Adds records.
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

    /// An empty block: the oldest one, if there are enough.
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

    /// Copies records with numbers from `from` to before `end` to `into`: those of one block, or the rare ones of it. Gives
    /// the number to go on with.
    pub(crate) fn read(&self, from: u64, end: u64, rare: bool, into: &mut Chunk) -> u64 {
        into.begin(from, end);
        let after = self.list.partition_point(|block| block.first() <= from);
        let Some(block) = after.checked_sub(1).and_then(|index| self.list.get(index)) else {
            return from;
        };
        if rare {
            block.rare_from(from).for_each(|piece| into.push(&block.bytes, *piece));
        } else {
            into.push(&block.bytes, block.all_from(from));
        }
        self.list.get(after).map_or(self.next, RecordBlock::first).min(end)
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
    }

    fn all_from(&self, from: u64) -> Piece {
        let after = self.marks.partition_point(|mark| mark.sequence <= from);
        let mark = after.checked_sub(1).and_then(|index| self.marks.get(index));
        Piece { mark: mark.copied().unwrap_or_default(), end: self.bytes.len() }
    }

    fn rare_from(&self, from: u64) -> impl Iterator<Item = &Piece> {
        let first = self.rare.partition_point(|piece| piece.mark.sequence < from);
        self.rare[first..].iter()
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

/// Records copied out for a reader; it is used again and again.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    bytes: Vec<u8>,
    pieces: Vec<Piece>,
    from: u64,
    end: u64,
}

impl Chunk {
    fn begin(&mut self, from: u64, end: u64) {
        self.bytes.clear();
        self.pieces.clear();
        (self.from, self.end) = (from, end);
    }

    fn push(&mut self, bytes: &[u8], piece: Piece) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(&bytes[piece.mark.start..piece.end]);
        let mark = Mark { start, ..piece.mark };
        self.pieces.push(Piece { mark, end: self.bytes.len() });
    }

    /// The records with number and time.
    pub(crate) fn records(&self) -> impl Iterator<Item = (u64, u64, Record)> {
        let records = self.pieces.iter().flat_map(|piece| {
            let items = Items::new(&self.bytes[piece.mark.start..piece.end], piece.mark.before_ns);
            let records = items.filter_map(|item| match item {
                Ok(Item::Record(t_ns, record)) => Some((t_ns, record)),
                Ok(Item::Definition(_)) | Err(_) => None,
            });
            (piece.mark.sequence..).zip(records)
        });
        let wanted = self.from..self.end;
        records
            .filter(move |(sequence, _)| wanted.contains(sequence))
            .map(|(sequence, (t_ns, record))| (sequence, t_ns, record))
    }
}

#[cfg(test)]
mod tests {
    use super::{Blocks, Chunk, Encoded, Mark, Piece};
    use expect_test::{Expect, expect};
    use rafcon_storage::journal::{Item, PlaceNumber, Record};

    /// A long line that every viewer is told.
    fn line(number: u64) -> Record {
        let message = format!("{number:>8000}");
        Record::Log {
            place: None,
            level: rafcon_protocol::LogLevel::Info,
            stream: rafcon_protocol::Stream::Stdout,
            message,
        }
    }

    /// Pushes so many lines with an entry before each.
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
            blocks.push(Encoded { bytes: &bytes, count: 2, before_ns, rare: &rare });
        }
        blocks
    }

    fn check(lines: u64, from: u64, end: u64, rare: bool, expect: &Expect) {
        let blocks = blocks(lines);
        let mut chunk = Chunk::default();
        let next = blocks.read(from.max(blocks.first()), end, rare, &mut chunk);
        let records: Vec<(u64, u64)> = chunk.records().map(|(number, t, _)| (number, t)).collect();
        let shown = records.get(..3).unwrap_or(&records);
        expect.assert_eq(&format!("{shown:?} of {}, next {next}", records.len()));
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
}
