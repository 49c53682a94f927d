//! Content of one commit, built from frames: rows of many events each, places, values. Defines the rows, not the time of writing.

use super::sums::{self, RowHeader};
use crate::journal::moment::Keyframe;
use crate::journal::record::binary::{BinaryWriter, Broken};
use crate::journal::record::frame::{Frame, definitions};
use crate::journal::record::{Content, Definition, Place, PlaceNumber, Stored, ValueNumber};
use rusqlite::{Result, Transaction, params};

/// Values shorter than this are stored in their own row, others once by their hash.
const SHORT: usize = 128;
/// A row takes no more events once it is this long.
const BLOCK_BYTES: usize = 32 << 10;
/// Maximum length of a last row that is extended.
const TAIL_BYTES: usize = 2 << 10;

/// The events of one row.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::journal) struct Block {
    /// Number of the first event.
    pub(in crate::journal) first: u64,
    /// Number of consecutive events from `first` on.
    pub(in crate::journal) count: u64,
    /// Time of the event before the first.
    pub(in crate::journal) t_before: u64,
    /// Time of the last event.
    pub(in crate::journal) t_last: u64,
    /// Events as encoded items.
    pub(in crate::journal) data: Vec<u8>,
}

impl Block {
    /// Returns the number of the event that follows the block.
    pub(in crate::journal) fn next(&self) -> u64 {
        self.first + self.count
    }
}

/// Content of one commit.
#[derive(Debug, Default)]
pub(in crate::journal) struct Group {
    /// Block that this group extends, if it extends one.
    tail: Option<Block>,
    blocks: Vec<Block>,
    /// Places with the number of the first event that they apply to.
    pub(in crate::journal) places: Vec<(PlaceNumber, u64, Place)>,
    pub(in crate::journal) values: Vec<(ValueNumber, Stored)>,
    /// Keyframe before these events, if one is due.
    pub(in crate::journal) keyframe: Option<Keyframe>,
}

impl Group {
    /// Creates a group that follows `tail`, the last block of the database.
    pub(in crate::journal) fn after(tail: Option<&Block>) -> Self {
        let tail = tail.filter(|tail| tail.data.len() < TAIL_BYTES).cloned();
        Self { tail, ..Self::default() }
    }

    /// Returns all rows, including an extended tail.
    pub(in crate::journal) fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.tail.iter().chain(&self.blocks)
    }

    /// Returns the last row.
    pub(in crate::journal) fn into_last(self) -> Option<Block> {
        self.blocks.into_iter().next_back().or(self.tail)
    }

    /// Adds the next frame to the group.
    pub(in crate::journal) fn add(&mut self, frame: &Frame<'_>) -> std::result::Result<(), Broken> {
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

    /// Returns the last block if the frame fits, or else a new one.
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

    fn add_definitions(&mut self, frame: &Frame<'_>) -> std::result::Result<(), Broken> {
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

    /// Writes the whole group to the tables. Replaces rows that an earlier attempt wrote after record number `committed` and
    /// definition number `places`.
    pub(super) fn put(
        &self,
        transaction: &Transaction<'_>,
        committed: u64,
        places: u64,
    ) -> Result<()> {
        let delete = "DELETE FROM blocks WHERE first > ?1";
        transaction.execute(delete, [committed.cast_signed()])?;
        put_blocks(transaction, self)?;
        if !self.places.is_empty() {
            put_places(transaction, self, places)?;
        }
        if !self.values.is_empty() {
            put_values(transaction, self)?;
        }
        self.keyframe.as_ref().map_or(Ok(()), |keyframe| put_keyframe(transaction, keyframe))
    }
}

fn put_blocks(transaction: &Transaction<'_>, group: &Group) -> Result<()> {
    let mut insert = transaction.prepare(
        "INSERT OR REPLACE INTO blocks(first, count, t_before, t_last, data, sum)
            VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
    )?;
    for block in group.blocks() {
        let head = RowHeader::of(block);
        let RowHeader { first, count, t_before, t_last } = head;
        let sum = head.sum(&block.data);
        insert.execute(params![first, count, t_before, t_last, block.data, sum])?;
    }
    Ok(())
}

fn put_places(transaction: &Transaction<'_>, group: &Group, before: u64) -> Result<()> {
    transaction.execute("DELETE FROM places WHERE nth > ?1", [before.cast_signed()])?;
    let mut insert = transaction
        .prepare("INSERT INTO places(nth, number, first, data, sum) VALUES (?1, ?2, ?3, ?4, ?5)")?;
    let mut data = Vec::new();
    for ((number, first, place), nth) in group.places.iter().zip(before.cast_signed() + 1..) {
        data.clear();
        BinaryWriter::new(&mut data).place_definition(*number, place);
        let (number, first) = (i64::from(number.0), first.cast_signed());
        let sum = sums::of_place(nth, number, first, &data);
        insert.execute(params![nth, number, first, data, sum])?;
    }
    Ok(())
}

fn put_values(transaction: &Transaction<'_>, group: &Group) -> Result<()> {
    let mut insert = transaction
        .prepare("INSERT OR IGNORE INTO vals(number, hash, data, sum) VALUES (?1, ?2, ?3, ?4)")?;
    let keep = "INSERT INTO blobs VALUES (?1, ?2, 1) ON CONFLICT DO UPDATE SET uses = uses + 1";
    let mut keep = transaction.prepare(keep)?;
    for (number, stored) in &group.values {
        let (number, data) = (number.0.cast_signed(), stored.to_bytes());
        let hash = (data.len() >= SHORT).then(|| *blake3::hash(&data).as_bytes());
        let short = if hash.is_some() { None } else { Some(&data[..]) };
        let sum = sums::of_value(number, hash.as_ref().map(|hash| &hash[..]), short);
        if insert.execute(params![number, hash, short, sum])? == 0 {
            continue;
        }
        if let Some(hash) = hash {
            keep.execute(params![hash, data])?;
        }
        if let Content::File { hash, size } = &stored.content {
            put_file(transaction, hash, *size)?;
        }
    }
    Ok(())
}

fn put_file(transaction: &Transaction<'_>, name: &str, size: u64) -> Result<()> {
    let keep = "INSERT INTO large VALUES (?1, ?2, 1) ON CONFLICT DO UPDATE SET uses = uses + 1";
    transaction.execute(keep, params![name, size.cast_signed()])?;
    Ok(())
}

fn put_keyframe(transaction: &Transaction<'_>, keyframe: &Keyframe) -> Result<()> {
    let insert = "INSERT OR REPLACE INTO keyframes(sequence, data, next_value, sum)
        VALUES (?1, ?2, ?3, ?4)";
    let [sequence, next_value] = [keyframe.sequence, keyframe.next_value.0].map(u64::cast_signed);
    let sum = sums::of_keyframe(sequence, next_value, &keyframe.data);
    transaction.execute(insert, params![sequence, keyframe.data, next_value, sum])?;
    let mut insert = transaction.prepare("INSERT OR REPLACE INTO named VALUES (?1, ?2)")?;
    for (number, last) in &keyframe.named {
        insert.execute([number.0.cast_signed(), last.cast_signed()])?;
    }
    Ok(())
}
