//! Probability of the next bit after the bytes before it. Six contexts count bits, a seventh input is the bit after the last
//! occurrence of the same bytes, and adaptive weights mix them. Integer arithmetic gives both sides of a link the same numbers.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "probabilities have 12 bits, logits as many and a sign"
)]

use super::repetition::{LENGTHS, Repetition, SURE, sure};

/// The bytes before a bit that make a context: how far each is behind.
const CONTEXTS: [&[usize]; COUNT] = [&[1], &[1, 2], &[1, 2, 3], &[2], &[2, 3], &[1, 2, 3, 4, 5]];
const COUNT: usize = 6;
/// The longest distance in `CONTEXTS`.
const BEHIND: usize = 5;
/// Slots of a context.
const SLOTS: usize = 1 << 14;
/// A slot counts up to this; then old bits count less and less.
const SEEN_MAX: u16 = 14;
/// Learning rate of the weights.
const LEARN: i32 = 8;
/// A weight of one.
const ONE: i32 = 1 << 16;
/// Probabilities have 12 bits.
pub(super) const SCALE: i32 = 1 << 12;

/// The opinions that are mixed: the contexts, then the repetition.
const OPINIONS: usize = COUNT + 1;

/// Step of a slot towards a bit, by the number of bits it has counted, in 65,536ths.
const RATES: [i32; 16] = [
    40_960, 25_206, 18_204, 14_247, 11_703, 9_930, 8_623, 7_620, 6_827, 6_183, 5_650, 5_201, 4_819,
    4_489, 4_201, 4_201,
];
/// Weight of a slot, by the number of bits it has counted, in 256ths.
const TRUST: [i32; 16] =
    [0, 100, 150, 180, 200, 215, 225, 232, 238, 243, 247, 250, 253, 255, 256, 256];

/// The logistic function at every 128th of its domain.
const CURVE: [i32; 33] = [
    1, 2, 3, 6, 10, 16, 27, 45, 73, 120, 194, 310, 488, 747, 1_101, 1_546, 2_047, 2_549, 2_994,
    3_348, 3_607, 3_785, 3_901, 3_975, 4_024, 4_050, 4_068, 4_079, 4_085, 4_089, 4_092, 4_093,
    4_094,
];

/// The probability, in [`SCALE`], of a logit in 256ths.
const fn squash(logit: i32) -> i32 {
    if logit > 2_047 {
        return SCALE - 1;
    }
    if logit < -2_047 {
        return 1;
    }
    let (part, place) = (logit & 127, ((logit >> 7) + 16) as usize);
    (CURVE[place] * (128 - part) + CURVE[place + 1] * part + 64) >> 7
}

/// The logit of each probability.
static STRETCH: [i16; SCALE as usize] = {
    let (mut table, mut logit, mut next) = ([2_047; SCALE as usize], -2_047, 0);
    while logit < 2_048 {
        let probability = squash(logit);
        while next <= probability {
            table[next as usize] = logit as i16;
            next += 1;
        }
        logit += 1;
    }
    table
};

/// Statistics of the earlier bytes.
#[derive(Debug, Clone)]
pub(super) struct Model {
    /// Slots of each context, then those of the repetition: a probability of 12 bits and a count of bits.
    slots: Box<[u16]>,
    state: MixState,
    repetition: Repetition,
    /// Slots that were changed since the model was fixed, with what was in them.
    changed: Vec<(u32, u16)>,
    fixed: Option<MixState>,
}

/// State that changes with each bit, without the slots.
#[derive(Debug, Clone, Copy)]
struct MixState {
    /// By how sure the repetition is.
    weights: [[i32; OPINIONS]; SURE],
    /// The last bytes, the newest first.
    before: [u8; BEHIND],
}

/// A byte of which some bits are known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bits {
    hashes: [u32; COUNT],
    /// Bits of the current byte, after a leading one.
    known: u32,
}

/// Prediction of a bit, with its inputs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guess {
    /// Probability of a one, between 0 and [`SCALE`], both excluded.
    pub(super) one: i32,
    places: [usize; OPINIONS],
    words: [i32; OPINIONS],
    /// The weights that are used.
    sure: usize,
    /// Bit that the repetition predicts, if it predicts one.
    expected: Option<bool>,
}

impl Model {
    pub(super) fn new() -> Self {
        Self {
            slots: vec![(SCALE as u16 / 2) << 4; SLOTS * COUNT + LENGTHS].into_boxed_slice(),
            state: MixState { weights: [[ONE * 35 / 100; OPINIONS]; SURE], before: [0; BEHIND] },
            repetition: Repetition::default(),
            changed: Vec::new(),
            fixed: None,
        }
    }

    /// Learns from bytes that both sides know.
    pub(super) fn learn(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let mut bits = self.begin_byte();
            for place in (0..8).rev() {
                let (guess, bit) = (self.guess(&bits), byte >> place & 1 == 1);
                self.update(&guess, bit);
                bits.push(bit);
            }
            self.end_byte(*byte);
        }
    }

    /// Starts a transaction: later statistics can be rolled back.
    pub(super) fn fix(&mut self) {
        self.changed.clear();
        self.fixed = Some(self.state);
        self.repetition.fix();
    }

    /// Forgets what was learnt since the model was fixed.
    pub(super) fn forget(&mut self) {
        for (place, slot) in self.changed.drain(..).rev() {
            self.slots[place as usize] = slot;
        }
        if let Some(state) = self.fixed {
            self.state = state;
        }
        self.repetition.forget();
    }

    pub(super) fn begin_byte(&self) -> Bits {
        let mut hashes = [0; COUNT];
        for (number, (hash, context)) in (1_u32..).zip(hashes.iter_mut().zip(CONTEXTS)) {
            *hash = number.wrapping_mul(0x9E37_79B1);
            for behind in context {
                let byte = u32::from(self.state.before[behind - 1]);
                *hash = (*hash ^ byte).wrapping_mul(0x2545_F491).wrapping_add(0x0123_4567);
            }
        }
        Bits { hashes, known: 1 }
    }

    pub(super) fn end_byte(&mut self, byte: u8) {
        self.state.before.rotate_right(1);
        self.state.before[0] = byte;
        self.repetition.end_byte(byte);
    }

    pub(super) fn guess(&self, bits: &Bits) -> Guess {
        let (mut places, mut words, mut logit) = ([0; OPINIONS], [0; OPINIONS], 0_i64);
        let expected = self.repetition.expects(bits.known);
        let length = if expected.is_some() { self.repetition.length() } else { 0 };
        let sure = sure(length);
        let weights = &self.state.weights[sure];
        for context in 0..COUNT {
            let hash = bits.hashes[context].wrapping_add(bits.known.wrapping_mul(0x9E37_79B1));
            let place = (hash.wrapping_mul(0x85EB_CA6B) >> 15) as usize % SLOTS;
            places[context] = context * SLOTS + place;
            words[context] = self.word(places[context]);
            logit += i64::from(weights[context]) * i64::from(words[context]);
        }
        if let Some(expected) = expected {
            places[COUNT] = COUNT * SLOTS + length;
            let word = self.word(places[COUNT]);
            words[COUNT] = if expected { word } else { -word };
            logit += i64::from(weights[COUNT]) * i64::from(words[COUNT]);
        }
        let logit = (logit >> 16).clamp(-2_048, 2_048) as i32;
        Guess { one: squash(logit).clamp(1, SCALE - 1), places, words, sure, expected }
    }

    /// Logit of the probability of a slot.
    fn word(&self, place: usize) -> i32 {
        let slot = self.slots[place];
        let (probability, seen) = (usize::from(slot >> 4), usize::from(slot & 15));
        (i32::from(STRETCH[probability]) * TRUST[seen]) >> 8
    }

    pub(super) fn update(&mut self, guess: &Guess, bit: bool) {
        let error = (i32::from(bit) * SCALE - guess.one) * LEARN;
        let weights = &mut self.state.weights[guess.sure];
        for (weight, word) in weights.iter_mut().zip(guess.words) {
            *weight = (*weight + ((word * error + ONE / 2) >> 16)).clamp(-8 * ONE, 8 * ONE);
        }
        for context in 0..COUNT {
            self.move_slot(guess.places[context], bit);
        }
        if let Some(expected) = guess.expected {
            self.move_slot(guess.places[COUNT], bit == expected);
        }
    }

    /// A slot saw this bit.
    fn move_slot(&mut self, place: usize, bit: bool) {
        let slot = self.slots[place];
        if self.fixed.is_some() {
            self.changed.push((place as u32, slot));
        }
        let (probability, seen) = (i32::from(slot >> 4), slot & 15);
        let target = if bit { SCALE - 1 } else { 0 };
        let moved = probability + (((target - probability) * RATES[usize::from(seen)]) >> 16);
        self.slots[place] = (moved.clamp(0, SCALE - 1) as u16) << 4 | (seen + 1).min(SEEN_MAX);
    }
}

impl Bits {
    pub(super) fn push(&mut self, bit: bool) {
        self.known = self.known << 1 | u32::from(bit);
    }

    /// The byte, once all bits are known.
    pub(super) fn byte(&self) -> u8 {
        self.known.to_le_bytes()[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_counts_up_to_the_bound_and_still_learns() {
        let mut model = Model::new();
        for (bit, from, to) in [(true, 3_900, 4_095), (false, 0, 195)] {
            for seen in 0..1_000 {
                model.move_slot(0, bit);
                let most = if bit { SEEN_MAX.min(seen + 1) } else { SEEN_MAX };
                assert_eq!(model.slots[0] & 15, most);
            }
            let probability = model.slots[0] >> 4;
            assert!((from..=to).contains(&probability), "{probability} after {bit}");
        }
    }
}
