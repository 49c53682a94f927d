//! What one commit puts into the database, made from frames: rows of many events each, places, values. Knows the shape of
//! rows; must never know `SQLite`.

use super::binary::{BinaryReader, Broken};
use super::frame::Frame;
use super::record::{Definition, Item, Place, PlaceNumber, Stored, ValueNumber};
use super::tracker::Keyframe;

/// A row is closed once it is as long as this.
const BLOCK_BYTES: usize = 32 << 10;
/// The last row is written again, with more behind it, while it is shorter than this.
const TAIL_BYTES: usize = 2 << 10;

/// Events that lie in one row.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Block {
    /// Number of the first.
    pub(super) first: u64,
    /// How many.
    pub(super) count: u64,
    /// Time of the event before the first.
    pub(super) t_before: u64,
    /// Time of the last.
    pub(super) t_last: u64,
    /// The events as items.
    pub(super) data: Vec<u8>,
}

impl Block {
    /// The number of the event that follows it.
    pub(super) fn next(&self) -> u64 {
        self.first + self.count
    }
}

/// What one commit puts in.
#[derive(Debug, Default)]
pub(super) struct Group {
    /// The block that goes on, if one does.
    tail: Option<Block>,
    blocks: Vec<Block>,
    /// Places with the number of the first event that they hold for.
    pub(super) places: Vec<(PlaceNumber, u64, Place)>,
    /// Values.
    pub(super) values: Vec<(ValueNumber, Stored)>,
    /// How the run stood before these events, if it is to be kept.
    pub(super) keyframe: Option<Keyframe>,
}

impl Group {
    /// A group that follows on `tail`, the last block so far.
    pub(super) fn after(tail: Option<&Block>) -> Self {
        let tail = tail.filter(|tail| tail.data.len() < TAIL_BYTES).cloned();
        Self { tail, ..Self::default() }
    }

    /// All rows, a tail that went on included.
    pub(super) fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.tail.iter().chain(&self.blocks)
    }

    /// The last row.
    pub(super) fn into_last(self) -> Option<Block> {
        self.blocks.into_iter().next_back().or(self.tail)
    }

    /// Adds the frame that follows.
    pub(super) fn add(&mut self, frame: &Frame<'_>) -> Result<(), Broken> {
        self.add_definitions(frame)?;
        if frame.head.count == 0 {
            return Ok(());
        }
        let block = self.block_for(frame);
        block.data.extend_from_slice(frame.records);
        block.count += u64::from(frame.head.count);
        block.t_last = frame.head.t_last;
        Ok(())
    }

    /// The last block if the frame goes on with it, or a new one.
    fn block_for(&mut self, frame: &Frame<'_>) -> &mut Block {
        let fits = |block: &Block| {
            block.data.len() < BLOCK_BYTES
                && block.t_last == frame.head.t_before
                && block.next() == frame.head.first
        };
        if self.blocks.is_empty() && self.tail.as_ref().is_some_and(fits) {
            return self.tail.get_or_insert_default();
        }
        if !self.blocks.last().is_some_and(fits) {
            let (first, t_before) = (frame.head.first, frame.head.t_before);
            self.blocks.push(Block { first, t_before, t_last: t_before, ..Block::default() });
        }
        let last = self.blocks.len() - 1;
        &mut self.blocks[last]
    }

    fn add_definitions(&mut self, frame: &Frame<'_>) -> Result<(), Broken> {
        for definition in definitions(frame) {
            match definition? {
                (first, Definition::Place(number, place)) => {
                    self.places.push((number, first, place));
                }
                (_, Definition::Value(number, stored)) => self.values.push((number, stored)),
            }
        }
        Ok(())
    }
}

/// What a frame defines, each with the number of the first event that it holds for.
pub(super) fn definitions<'b>(frame: &Frame<'b>) -> Definitions<'b> {
    Definitions { reader: BinaryReader::new(frame.definitions), first: frame.head.first }
}

/// Reads definitions up to the end or the first that is broken.
#[derive(Debug)]
pub(super) struct Definitions<'b> {
    reader: BinaryReader<'b>,
    first: u64,
}

impl Definitions<'_> {
    fn read(&mut self) -> Result<(u64, Definition), Broken> {
        let before = self.reader.number()?;
        match self.reader.item(0)? {
            Item::Definition(definition) => Ok((self.first.saturating_add(before), definition)),
            Item::Record(..) => Err(self.reader.broken("a record among definitions")),
        }
    }
}

impl Iterator for Definitions<'_> {
    type Item = Result<(u64, Definition), Broken>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.reader.is_at_end() {
            return None;
        }
        let read = self.read();
        if read.is_err() {
            self.reader = BinaryReader::new(&[]);
        }
        Some(read)
    }
}
