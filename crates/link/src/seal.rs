//! Datagrams that only the other side can have made and that count once: authenticated, encrypted, without a handshake, so that the
//! first datagram after a silence is as good as any other.
//!
//! The construction follows CCSDS 355.0-B (space data link security) with the primitives of RFC 5869 and RFC 8439: one key for
//! each direction and start, derived by HKDF-SHA256 from a pairing key, and ChaCha20-Poly1305. Its nonce is the full header
//! without the salt, its associated data the header on the wire. After an acknowledged packet number, a short header is sent,
//! and the receiver reconstructs the full one as in QUIC (RFC 9000, 17.1).

mod header;

use crate::replay_window::ReplayWindow;
use header::{few, full_header, nearest, nonce, salted_header, short_header};
use ring::aead::{Aad, CHACHA20_POLY1305, LessSafeKey, NONCE_LEN, UnboundKey};
use ring::hkdf::{self, HKDF_SHA256, Prk};
use ring::rand::{SecureRandom as _, SystemRandom};
use std::fmt;

/// Maximum bytes of the header and the tag of a datagram.
pub const OVERHEAD: usize = SALTED_HEADER + TAG;

const VERSION: u8 = 5;
/// Bytes of a full header without the salt.
const HEADER: usize = NONCE_LEN;
const SALTED_HEADER: usize = HEADER + 4;
/// Bit of the first byte of a full header with a salt.
const IS_SALTED: u8 = 0x40;
/// A confirmed receiver knows the salt. For one that has lost it, every eighth full header has it again.
const SALT_EVERY: u32 = 8;
const TAG: usize = 16;
/// The first bit of a short header.
const IS_SHORT: u8 = 0x80;
const SHORT_HEADER: usize = 3;
/// Mask of the bits of the generation and of the key's number in a short header.
const FEW: u8 = 0b11;
/// Packet numbers whose difference is less than half of this are distinct in their last 16 bits.
const SHORT_NUMBERS: u64 = 1 << 16;
/// Datagrams after the last acknowledged one that have a short header. Half of the distinct numbers remain for datagrams that
/// arrive late or are forgotten.
const CONFIRMED_FOR: u64 = SHORT_NUMBERS / 4;
/// Packet numbers have 48 bits.
const NUMBERS: u64 = 1 << 48;
const HKDF_SALT: &[u8] = b"rafcon link 1";

/// Which way a datagram goes. Each way has keys of its own, so that nothing can be sent back to its sender.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From the robot to the station.
    Down,
    /// From the station to the robot.
    Up,
}

impl Direction {
    /// The other way.
    pub(crate) fn back(self) -> Self {
        match self {
            Self::Down => Self::Up,
            Self::Up => Self::Down,
        }
    }

    fn byte(self) -> u8 {
        match self {
            Self::Down => b'D',
            Self::Up => b'U',
        }
    }
}

/// The secret that a robot and its stations share: 32 bytes by chance.
#[derive(Clone, PartialEq, Eq)]
pub struct PairingKey([u8; 32]);

impl PairingKey {
    /// A random key; `None` if the system has no randomness.
    pub fn generate() -> Option<Self> {
        let mut bytes = [0; 32];
        SystemRandom::new().fill(&mut bytes).ok()?;
        Some(Self(bytes))
    }

    /// The key with these bytes.
    pub fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// Its bytes, for the file that keeps it.
    pub fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl fmt::Debug for PairingKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("PairingKey(..)")
    }
}

/// Which of the pairing keys a datagram is sealed with: another one after each change of keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct KeyId(pub u8);

/// The number of a sender's start. Each start has a higher one than all before, which has to be on the sender's disk, synced, before
/// the first datagram is sealed: under one generation, no packet number may be used twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Generation(pub u32);

impl Generation {
    /// Generation of the next start. `None` after the last one, when new keys are needed.
    pub fn next(self) -> Option<Self> {
        self.0.checked_add(1).map(Self)
    }
}

/// A random number of a sender's start. It is part of the key, so that two computers with copies of one disk never reuse a
/// nonce under one key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Salt(pub u32);

impl Salt {
    /// A random salt; `None` if the system has no randomness.
    pub fn generate() -> Option<Self> {
        let mut bytes = [0; 4];
        SystemRandom::new().fill(&mut bytes).ok()?;
        Some(Self(u32::from_be_bytes(bytes)))
    }
}

/// One start of a sender.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct SenderStart {
    /// Number of the start, from 1.
    pub generation: Generation,
    /// Chosen by chance for this start.
    pub salt: Salt,
}

impl SenderStart {
    /// The start with these numbers.
    pub const fn new(generation: u32, salt: u32) -> Self {
        Self { generation: Generation(generation), salt: Salt(salt) }
    }
}

/// Last datagram that a receiver opened, for its disk: after its restart, nothing up to it counts again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Horizon {
    /// The newest start.
    pub start: SenderStart,
    /// The newest packet number of that start.
    pub number: u64,
}

/// Error of [`Sealer::seal`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SealError {
    /// All packet numbers of this generation are used.
    #[error("all packet numbers of this start are used: start again to have a new generation")]
    NumbersUsed,
}

/// Error of [`Opener::open`]. The opener is unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Rejected {
    /// It is shorter than any datagram.
    #[error("a datagram of {0} bytes is too short")]
    TooShort(usize),
    /// The other side speaks another version.
    #[error(
        "the other side speaks version {0} of the link, this one speaks {VERSION}: update the older side"
    )]
    Version(u8),
    /// It is sealed with a key that is not known here.
    #[error("a datagram is sealed with pairing key {}, which is not known here: pair the two sides again", .0.0)]
    Key(KeyId),
    /// The other side made it, in a generation before the newest one.
    #[error(
        "a datagram is of start {} of its sender, and start {} was heard already: it is an old one sent again, or the sender's disk \
         was put back; pair the two sides again then", .was.0, .newest.0
    )]
    OldGeneration {
        /// Its generation.
        was: Generation,
        /// The newest one.
        newest: Generation,
    },
    /// Another start of the other side has this number: its disk was copied or restored.
    #[error(
        "a datagram is of another start {} of its sender than the one that was heard: its disk was copied or restored; pair one of \
         the two again", .0.0
    )]
    Copied(Generation),
    /// Its short header belongs to another start than the current one.
    #[error(
        "a datagram with a short header is of a start of its sender that was not heard yet, or is over: the next one with a full header \
         tells"
    )]
    UnknownStart,
    /// It was received before, or is older than the replay window.
    #[error("datagram {0} was received before, or came too late to tell")]
    Repeated(u64),
    /// It was not sealed by the other side, or it was changed on its way.
    #[error("a datagram was not made by the other side, or was changed on its way")]
    Forged,
}

/// A datagram that was opened.
#[derive(Debug, PartialEq, Eq)]
pub struct Opened<'d> {
    /// The start of its sender that it is of.
    pub generation: Generation,
    /// Its number in that generation.
    pub number: u64,
    /// Content of the datagram.
    pub payload: &'d [u8],
}

/// Seals what one side sends. One for each start of a program.
#[derive(Debug)]
pub struct Sealer {
    key: LessSafeKey,
    key_id: KeyId,
    start: SenderStart,
    next: u64,
    /// The first number under this key.
    first: u64,
    /// The receiver has opened the datagram of this number.
    confirmed: Option<u64>,
    /// Full headers since the last one with a salt.
    unsalted: u32,
}

/// Receivers that have to be able to open a datagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum For {
    /// The receiver that confirmed one lately; anyone, if none did.
    Confirmed,
    /// A receiver in contact, which may have missed the last datagrams.
    Listener,
    /// Any receiver with the key.
    Anyone,
}

impl Sealer {
    /// For what the robot of this name sends (`Down`), or is sent (`Up`). The generation has to be on disk already.
    pub fn new(
        key_id: KeyId,
        key: &PairingKey,
        robot: &str,
        direction: Direction,
        start: SenderStart,
    ) -> Self {
        let key = derived(key, robot, direction, start);
        Self { key, key_id, start, next: 0, first: 0, confirmed: None, unsalted: 0 }
    }

    /// Continues the numbers of the sealer before this one, so that what the receiver confirms is known to be of this key.
    pub fn follow(&mut self, before: &Self) {
        self.next = self.next.max(before.next);
        (self.first, self.confirmed) = (self.next, None);
    }

    /// The receiver acknowledged this datagram of this start.
    pub fn confirm(&mut self, number: u64) {
        if (self.first..self.next).contains(&number) {
            self.confirmed = self.confirmed.max(Some(number));
        }
    }

    /// There is another receiver, which has confirmed nothing.
    pub fn forget_confirmed(&mut self) {
        self.confirmed = None;
    }

    /// Maximum bytes of the header and the tag of the next datagram, if it is for `whom`.
    pub fn overhead(&self, whom: For) -> usize {
        if self.is_salted(whom) { OVERHEAD } else { HEADER + TAG }
    }

    /// True if the next full header has the salt.
    fn is_salted(&self, whom: For) -> bool {
        whom == For::Anyone || self.confirmed.is_none() || self.unsalted + 1 >= SALT_EVERY
    }

    /// Appends the sealed datagram to `out` and returns its packet number.
    pub fn seal(&mut self, whom: For, payload: &[u8], out: &mut Vec<u8>) -> Result<u64, SealError> {
        let number = self.next;
        if number >= NUMBERS {
            return Err(SealError::NumbersUsed);
        }
        let is_near = self.confirmed.is_some_and(|confirmed| number - confirmed < CONFIRMED_FOR);
        let sent = match whom {
            For::Confirmed if is_near => short_header(self.key_id, self.start.generation, number),
            _ if self.is_salted(whom) => {
                self.unsalted = 0;
                salted_header(self.key_id, self.start, number)
            }
            _ => {
                self.unsalted += 1;
                full_header(self.key_id, self.start.generation, number)
            }
        };
        let start = out.len();
        out.extend_from_slice(sent.sent());
        out.extend_from_slice(payload);
        let nonce = nonce(self.key_id, self.start.generation, number);
        let (nonce, sealed) = (nonce, &mut out[start + sent.length..]);
        let tag = self.key.seal_in_place_separate_tag(nonce, Aad::from(sent.sent()), sealed);
        let Ok(tag) = tag else {
            // Only of gigabytes at once.
            out.truncate(start);
            return Err(SealError::NumbersUsed);
        };
        out.extend_from_slice(tag.as_ref());
        self.next += 1;
        Ok(number)
    }
}

/// Opens what the other side has sealed: each datagram once, in any order.
#[derive(Debug)]
pub struct Opener {
    key_id: KeyId,
    pairing_key: PairingKey,
    robot: String,
    direction: Direction,
    newest: Option<OpenedStart>,
}

#[derive(Debug)]
struct OpenedStart {
    start: SenderStart,
    key: LessSafeKey,
    window: ReplayWindow,
}

impl Opener {
    /// Opens datagrams from the robot of this name (`Down`) or to it (`Up`). `heard` is the last datagram before this start, if
    /// known.
    pub fn new(
        key_id: KeyId,
        key: &PairingKey,
        robot: &str,
        direction: Direction,
        heard: Option<Horizon>,
    ) -> Self {
        let newest = heard.map(|Horizon { start, number }| OpenedStart {
            start,
            key: derived(key, robot, direction, start),
            window: ReplayWindow::after(number),
        });
        Self { key_id, pairing_key: key.clone(), robot: robot.to_owned(), direction, newest }
    }

    /// Last datagram received.
    pub fn heard(&self) -> Option<Horizon> {
        let newest = self.newest.as_ref()?;
        Some(Horizon { start: newest.start, number: newest.window.newest()? })
    }

    /// True if the header of a datagram names this key. A short header names it by two bits.
    pub(crate) fn is_named_by(&self, datagram: &[u8]) -> bool {
        match *datagram {
            [first, ..] if first & IS_SHORT != 0 => first >> 3 & FEW == self.key_id.0 & FEW,
            [_, key, ..] => key == self.key_id.0,
            _ => false,
        }
    }

    /// Opens a datagram in its place.
    pub fn open<'d>(&mut self, datagram: &'d mut [u8]) -> Result<Opened<'d>, Rejected> {
        let length = datagram.len();
        let is_short = datagram.first().is_some_and(|first| first & IS_SHORT != 0);
        let is_salted = datagram.first().is_some_and(|first| first & IS_SALTED != 0);
        let header_length = match (is_short, is_salted) {
            (true, _) => SHORT_HEADER,
            (false, true) => SALTED_HEADER,
            (false, false) => HEADER,
        };
        let (sent, sealed) = datagram
            .split_at_mut_checked(header_length)
            .filter(|(_, sealed)| sealed.len() >= TAG)
            .ok_or(Rejected::TooShort(length))?;
        let (start, number) = self.read(sent)?;
        let generation = start.generation;
        let newest = self.newest.as_ref().filter(|newest| newest.start == start);
        if newest.is_some_and(|newest| !newest.window.is_new(number)) {
            return Err(Rejected::Repeated(number));
        }
        let made = newest
            .is_none()
            .then(|| derived(&self.pairing_key, &self.robot, self.direction, start));
        let key = made.as_ref().or(newest.map(|newest| &newest.key)).ok_or(Rejected::Forged)?;
        let nonce = nonce(self.key_id, generation, number);
        let payload = key
            .open_in_place(nonce, Aad::from(&*sent), sealed)
            .map_err(|_forged| Rejected::Forged)?;
        if let Some(newest) = self.newest.as_ref().map(|newest| newest.start) {
            if generation < newest.generation {
                return Err(Rejected::OldGeneration { was: generation, newest: newest.generation });
            }
            if generation == newest.generation && start != newest {
                return Err(Rejected::Copied(generation));
            }
        }
        if let Some(key) = made {
            self.newest = Some(OpenedStart { start, key, window: ReplayWindow::new() });
        }
        if let Some(newest) = &mut self.newest {
            newest.window.receive(number);
        }
        Ok(Opened { generation, number, payload })
    }

    /// The start and packet number that a header claims.
    fn read(&self, header: &[u8]) -> Result<(SenderStart, u64), Rejected> {
        match *header {
            [first, n0, n1] => {
                let (few_bits, key, version) = (first >> 5 & FEW, first >> 3 & FEW, first & 0b111);
                self.check(version, KeyId(key), FEW)?;
                let newest = self.newest.as_ref().ok_or(Rejected::UnknownStart)?;
                if few(newest.start.generation) != few_bits {
                    return Err(Rejected::UnknownStart);
                }
                let expected = newest.window.newest().map_or(0, |newest| newest + 1);
                let number = nearest(expected, u16::from_be_bytes([n0, n1]));
                Ok((newest.start, number))
            }
            [version, key, g0, g1, g2, g3, n0, n1, n2, n3, n4, n5, ref salt @ ..] => {
                self.check(version & !IS_SALTED, KeyId(key), u8::MAX)?;
                let generation = Generation(u32::from_be_bytes([g0, g1, g2, g3]));
                let newest = self.newest.as_ref().map(|newest| newest.start);
                let start = match *salt {
                    [s0, s1, s2, s3] => {
                        SenderStart { generation, salt: Salt(u32::from_be_bytes([s0, s1, s2, s3])) }
                    }
                    _ => match newest {
                        Some(newest) if generation == newest.generation => newest,
                        Some(newest) if generation < newest.generation => {
                            let (was, newest) = (generation, newest.generation);
                            return Err(Rejected::OldGeneration { was, newest });
                        }
                        _ => return Err(Rejected::UnknownStart),
                    },
                };
                Ok((start, u64::from_be_bytes([0, 0, n0, n1, n2, n3, n4, n5])))
            }
            _ => Err(Rejected::TooShort(header.len())),
        }
    }

    /// True if the header has this version and, in the bits of `mask`, this key.
    fn check(&self, version: u8, key: KeyId, mask: u8) -> Result<(), Rejected> {
        if version != VERSION {
            return Err(Rejected::Version(version));
        }
        if self.key_id.0 & mask != key.0 {
            return Err(Rejected::Key(key));
        }
        Ok(())
    }
}

/// The key of one direction and start.
fn derived(key: &PairingKey, robot: &str, direction: Direction, start: SenderStart) -> LessSafeKey {
    let extracted: Prk = hkdf::Salt::new(HKDF_SHA256, HKDF_SALT).extract(&key.0);
    let [generation, salt] = [start.generation.0, start.salt.0].map(u32::to_be_bytes);
    let info = [&[direction.byte()], &generation[..], &salt[..], robot.as_bytes()];
    match extracted.expand(&info, &CHACHA20_POLY1305) {
        Ok(material) => LessSafeKey::new(UnboundKey::from(material)),
        // Only of keys that are longer than 255 blocks.
        Err(_too_long) => unreachable!("a key of 32 bytes is not too long"),
    }
}

#[cfg(test)]
mod tests;
