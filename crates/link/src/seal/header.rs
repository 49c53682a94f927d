//! Headers of datagrams: what is sent of them, and what a short one leaves out.

use super::{
    FEW, Generation, HEADER, IS_SALTED, IS_SHORT, KeyId, NUMBERS, SALTED_HEADER, SHORT_HEADER,
    SHORT_NUMBERS, SenderStart, VERSION,
};
use ring::aead::Nonce;

/// A header as it is sent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Header {
    pub(super) bytes: [u8; SALTED_HEADER],
    pub(super) length: usize,
}

impl Header {
    pub(super) fn sent(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// The last bits of a generation.
pub(super) fn few(generation: Generation) -> u8 {
    generation.0.to_le_bytes()[0] & FEW
}

/// The packet number with these last bits that is nearest to what is expected.
pub(super) fn nearest(expected: u64, last: u16) -> u64 {
    let half = SHORT_NUMBERS / 2;
    let number = expected - expected % SHORT_NUMBERS + u64::from(last);
    if number + half <= expected && number + SHORT_NUMBERS < NUMBERS {
        number + SHORT_NUMBERS
    } else if number > expected + half && number >= SHORT_NUMBERS {
        number - SHORT_NUMBERS
    } else {
        number
    }
}

pub(super) fn short_header(KeyId(key): KeyId, generation: Generation, number: u64) -> Header {
    let first = IS_SHORT | few(generation) << 5 | (key & FEW) << 3 | VERSION;
    let [.., n0, n1] = number.to_be_bytes();
    let mut bytes = [0; SALTED_HEADER];
    bytes[..SHORT_HEADER].copy_from_slice(&[first, n0, n1]);
    Header { bytes, length: SHORT_HEADER }
}

pub(super) fn full_header(key: KeyId, generation: Generation, number: u64) -> Header {
    let mut bytes = [0; SALTED_HEADER];
    bytes[..HEADER].copy_from_slice(&nonce_bytes(key, generation, number));
    Header { bytes, length: HEADER }
}

pub(super) fn salted_header(key: KeyId, start: SenderStart, number: u64) -> Header {
    let mut header = full_header(key, start.generation, number);
    header.bytes[0] |= IS_SALTED;
    header.bytes[HEADER..].copy_from_slice(&start.salt.0.to_be_bytes());
    Header { length: SALTED_HEADER, ..header }
}

pub(super) fn nonce_bytes(KeyId(key): KeyId, generation: Generation, number: u64) -> [u8; HEADER] {
    let [g0, g1, g2, g3] = generation.0.to_be_bytes();
    let [_, _, n0, n1, n2, n3, n4, n5] = number.to_be_bytes();
    [VERSION, key, g0, g1, g2, g3, n0, n1, n2, n3, n4, n5]
}

/// The full header without the salt, which is part of the key. Each datagram under one key has a distinct header.
pub(super) fn nonce(key: KeyId, generation: Generation, number: u64) -> Nonce {
    Nonce::assume_unique_for_key(nonce_bytes(key, generation, number))
}
