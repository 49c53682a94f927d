//! Something that comes in parts, in any order.

use crate::range_set::RangeSet;

/// Maximum length of what is sent in parts, such as an event or a snapshot, in bytes.
pub const LENGTH_MAX: u32 = 16 << 20;
/// The smallest part that is worth a frame, in bytes.
pub(crate) const PART_MIN: usize = 64;

/// Received parts of one item. Parts of a newer item replace them.
#[derive(Debug, Default)]
pub(crate) struct Assembly {
    number: u64,
    bytes: Vec<u8>,
    /// The numbers of the bytes that are here, from 1.
    here: RangeSet,
}

impl Assembly {
    /// True if these are the parts of the item with this number and length.
    pub(crate) fn is_of(&self, number: u64, length: u32) -> bool {
        self.number == number && self.bytes.len() == length as usize
    }

    /// Its bytes in memory.
    pub(crate) fn length(&self) -> usize {
        self.bytes.len()
    }

    /// The bytes that are here, numbered from 1.
    pub(crate) fn here(&self) -> &RangeSet {
        &self.here
    }

    /// Adds a part of the item with this number. Returns the item once it is complete.
    pub(crate) fn add(
        &mut self,
        number: u64,
        length: u32,
        offset: u32,
        part: &[u8],
    ) -> Option<Vec<u8>> {
        if length > LENGTH_MAX {
            return None;
        }
        if !self.is_of(number, length) {
            *self = Self { number, bytes: vec![0; length as usize], here: RangeSet::default() };
        }
        let (start, end) = (offset as usize, offset as usize + part.len());
        self.bytes.get_mut(start..end)?.copy_from_slice(part);
        self.here.insert(start as u64 + 1..=end as u64);
        (self.here.contiguous() == u64::from(length)).then(|| std::mem::take(self).bytes)
    }
}
