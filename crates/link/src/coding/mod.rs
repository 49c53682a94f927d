//! Items in fewer bytes: an arithmetic coder with a model that has learnt from what both sides know. Undone before anything else sees
//! the items, so that they stay those of the journal.
//!
//! Each datagram is opened without those before it: what is learnt from one is forgotten before the next.

mod context;
mod model;
mod offers;
mod repetition;
mod snapshots;

pub(crate) use context::{CONTEXT_MAX, ContextId, ContextName, Contexts, LastCoder};
pub(crate) use snapshots::{OfferedSnapshots, SentSnapshots};

use model::{Model, SCALE};

/// Longest sequence of items coded together, in bytes. It bounds what a datagram decodes to.
pub(crate) const PLAIN_MAX: usize = 16_384;

/// Codes and decodes with what it has learnt.
#[derive(Debug)]
pub(crate) struct Coder {
    model: Model,
}

impl Coder {
    /// One that has learnt from these bytes, which both sides know.
    pub(crate) fn new(known: &[u8]) -> Self {
        let mut model = Model::new();
        model.learn(known);
        model.fix();
        Self { model }
    }

    /// The bytes, coded.
    pub(crate) fn encode(&mut self, plain: &[u8]) -> Vec<u8> {
        let mut out = Vec::with_capacity(plain.len());
        let mut range = Range::new();
        for byte in plain {
            let mut bits = self.model.begin_byte();
            for place in (0..8).rev() {
                let (guess, bit) = (self.model.guess(&bits), byte >> place & 1 == 1);
                range.narrow(guess.one, bit);
                while let Some(byte) = range.shift() {
                    out.push(byte);
                }
                self.model.update(&guess, bit);
                bits.push(bit);
            }
            self.model.end_byte(*byte);
        }
        self.model.forget();
        range.end(&mut out);
        out
    }

    /// Decodes `length` bytes. `None` if that is too many.
    pub(crate) fn decode(&mut self, coded: &[u8], length: usize) -> Option<Vec<u8>> {
        if length > PLAIN_MAX {
            return None;
        }
        // Behind the end are zeros.
        let mut coded = coded.iter().copied().chain(std::iter::repeat(0));
        let mut next = || u32::from(coded.next().unwrap_or_default());
        let mut range = Range::new();
        let mut value = (0..4).fold(0, |value, _| value << 8 | next());
        let mut plain = Vec::with_capacity(length);
        for _ in 0..length {
            let mut bits = self.model.begin_byte();
            for _ in 0..8 {
                let guess = self.model.guess(&bits);
                let bit = value <= range.middle(guess.one);
                range.narrow(guess.one, bit);
                while range.shift().is_some() {
                    value = value << 8 | next();
                }
                self.model.update(&guess, bit);
                bits.push(bit);
            }
            self.model.end_byte(bits.byte());
            plain.push(bits.byte());
        }
        self.model.forget();
        Some(plain)
    }
}

/// The numbers that a coded text may still become, from the lowest to the highest.
#[derive(Debug)]
struct Range {
    low: u32,
    high: u32,
}

impl Range {
    fn new() -> Self {
        Self { low: 0, high: u32::MAX }
    }

    /// Up to here a bit is a one.
    fn middle(&self, one: i32) -> u32 {
        let width = u64::from(self.high - self.low);
        let part = width * u64::from(one.cast_unsigned()) / u64::from(SCALE.cast_unsigned());
        // Less than the width.
        self.low + u32::try_from(part).unwrap_or_default()
    }

    fn narrow(&mut self, one: i32, bit: bool) {
        let middle = self.middle(one);
        if bit {
            self.high = middle;
        } else {
            self.low = middle + 1;
        }
    }

    /// The first byte, if it is certain; the others move up.
    fn shift(&mut self) -> Option<u8> {
        let [first, ..] = self.low.to_be_bytes();
        let is_certain = self.high.to_be_bytes()[0] == first;
        is_certain.then(|| {
            (self.low, self.high) = (self.low << 8, self.high << 8 | 0xff);
            first
        })
    }

    /// As few bytes as name a number of the range, if zeros follow.
    fn end(&self, out: &mut Vec<u8>) {
        for bytes in 0..=4_u32 {
            let unit = 1_u64 << (32 - 8 * bytes);
            let number = u64::from(self.low).div_ceil(unit) * unit;
            if number <= u64::from(self.high) {
                let number = u32::try_from(number).unwrap_or_default();
                out.extend_from_slice(&number.to_be_bytes()[..bytes as usize]);
                // Zeros at the end are there anyway.
                while out.last() == Some(&0) {
                    out.pop();
                }
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests;
