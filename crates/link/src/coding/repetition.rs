//! Prediction by repetition: the byte that followed the last occurrence of these bytes. Long repetitions are nearly certain.

/// Equal bytes that begin a repetition.
const BEGIN: usize = 5;
/// Lengths are counted up to this.
pub(super) const LENGTHS: usize = 32;
/// Greatest confidence in a repetition.
pub(super) const SURE: usize = 3;
/// Bits of the hash that finds the last occurrence.
const HASH_BITS: u32 = 13;

/// Confidence in a repetition of this length.
pub(super) fn sure(length: usize) -> usize {
    match length {
        0 => 0,
        1..16 => 1,
        _ => 2,
    }
}

/// Earlier bytes, with the previous occurrence of the newest ones.
#[derive(Debug, Clone)]
pub(super) struct Repetition {
    bytes: Vec<u8>,
    /// By the hash of some bytes, the place behind them where they came last; 0 if they never did.
    last: Box<[u32]>,
    state: RepetitionState,
    /// Entries of `last` that were changed since it was fixed, with what was in them.
    changed: Vec<(usize, u32)>,
    fixed: Option<(usize, RepetitionState)>,
}

#[derive(Debug, Clone, Copy, Default)]
struct RepetitionState {
    /// The place of the byte that is expected; 0 if none is.
    next: usize,
    /// Length of the repetition in bytes.
    length: usize,
}

impl Default for Repetition {
    fn default() -> Self {
        Self {
            bytes: Vec::new(),
            last: vec![0; 1 << HASH_BITS].into_boxed_slice(),
            state: RepetitionState::default(),
            changed: Vec::new(),
            fixed: None,
        }
    }
}

impl Repetition {
    /// Predicts the next bit of a byte whose first bits are `known`, after a leading one. `None` if the predicted byte has other
    /// bits.
    pub(super) fn expects(&self, known: u32) -> Option<bool> {
        let byte = u32::from(*self.bytes.get(self.state.next).filter(|_| self.state.next > 0)?);
        let left = 7 - known.ilog2().min(7);
        let is_so = (byte | 0x100) >> (left + 1) == known;
        is_so.then_some(byte >> left & 1 == 1)
    }

    /// Number of equal bytes, from 1 and less than [`LENGTHS`].
    pub(super) fn length(&self) -> usize {
        self.state.length.clamp(1, LENGTHS - 1)
    }

    pub(super) fn end_byte(&mut self, byte: u8) {
        let RepetitionState { next, length } = self.state;
        let goes_on = next > 0 && self.bytes.get(next) == Some(&byte);
        self.bytes.push(byte);
        self.state = if goes_on {
            RepetitionState { next: next + 1, length: length + 1 }
        } else {
            RepetitionState::default()
        };
        let Some(newest) = self.bytes.last_chunk::<BEGIN>() else { return };
        let place = hash(*newest);
        let there = self.last[place] as usize;
        if !goes_on && there > 0 {
            let same = self.bytes[..there].iter().rev().zip(self.bytes.iter().rev());
            let length = same.take(LENGTHS).take_while(|(then, now)| then == now).count();
            if length >= BEGIN {
                self.state = RepetitionState { next: there, length };
            }
        }
        if self.fixed.is_some() {
            self.changed.push((place, self.last[place]));
        }
        self.last[place] = u32::try_from(self.bytes.len()).unwrap_or_default();
    }

    /// Starts a transaction: later bytes can be rolled back.
    pub(super) fn fix(&mut self) {
        self.changed.clear();
        self.fixed = Some((self.bytes.len(), self.state));
    }

    /// Forgets what came since it was fixed.
    pub(super) fn forget(&mut self) {
        for (place, entry) in self.changed.drain(..).rev() {
            self.last[place] = entry;
        }
        if let Some((length, state)) = self.fixed {
            self.bytes.truncate(length);
            self.state = state;
        }
    }
}

fn hash(bytes: [u8; BEGIN]) -> usize {
    let mix = |hash: u32, byte: &u8| (hash ^ u32::from(*byte)).wrapping_mul(0x2545_F491);
    (bytes.iter().fold(0x9E37_79B1, mix) >> (32 - HASH_BITS)) as usize
}
