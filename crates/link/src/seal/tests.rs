//! Sealed datagrams in every order, changed, repeated, and made by others.

use super::{
    Direction, Generation, Horizon, KeyId, OVERHEAD, Opener, PairingKey, Rejected, SealError,
    Sealer,
};
use expect_test::expect;
use proptest::prelude::{any, prop_assert, prop_assert_eq, proptest};
use proptest::sample::Index;

const ID: KeyId = KeyId(1);

fn key() -> PairingKey {
    PairingKey::from_bytes(std::array::from_fn(|at| u8::try_from(at).unwrap()))
}

fn sealer(generation: u32) -> Sealer {
    Sealer::new((ID, &key()), "rover", Direction::Down, Generation(generation))
}

fn opener(heard: Option<Horizon>) -> Opener {
    Opener::new((ID, &key()), "rover", Direction::Down, heard)
}

fn sealed(sealer: &mut Sealer, payload: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    sealer.seal(payload, &mut out).unwrap();
    out
}

/// What becomes of a datagram: its number and payload, or why it is rejected.
fn open(opener: &mut Opener, datagram: &[u8]) -> String {
    let mut copy = datagram.to_vec();
    match opener.open(&mut copy) {
        Ok(opened) => format!(
            "{}.{} {}",
            opened.generation.0,
            opened.number,
            String::from_utf8_lossy(opened.payload)
        ),
        Err(rejected) => rejected.to_string(),
    }
}

/// Held for good: another program in another language has to come to the same bytes.
#[test]
fn the_bytes_of_a_datagram_are_these() {
    let mut sealer = sealer(7);
    sealed(&mut sealer, b"");
    let bytes = sealed(&mut sealer, b"hold");
    expect!["[01, 01, 00, 00, 00, 07, 00, 00, 00, 00, 00, 01, 97, 22, 34, 8e, c2, 15, f1, b5, b9, 9f, ce, 2a, 1c, d4, 05, c8, bc, 9a, 21, 4f]"].assert_eq(&format!("{bytes:02x?}"));
    assert_eq!(bytes.len(), 4 + OVERHEAD);
}

#[test]
fn a_datagram_counts_once_in_any_order() {
    let (mut sealer, mut opener) = (sealer(1), opener(None));
    let [a, b, c] = ["a", "b", "c"].map(|text| sealed(&mut sealer, text.as_bytes()));
    let told = [&c, &a, &c, &b, &a].map(|datagram| open(&mut opener, datagram)).join("\n");
    expect![[r"
        1.2 c
        1.0 a
        datagram 2 was received before, or came too late to tell
        1.1 b
        datagram 0 was received before, or came too late to tell"]]
    .assert_eq(&told);
}

#[test]
fn a_sender_that_starts_again_is_heard_at_once_and_its_past_no_more() {
    let mut opener = opener(None);
    let (mut first, mut second) = (sealer(1), sealer(2));
    let [old, late] = ["old", "late"].map(|text| sealed(&mut first, text.as_bytes()));
    let new = sealed(&mut second, b"new");
    let mut forged = late.clone();
    forged[20] ^= 1;
    let told =
        [&old, &new, &late, &forged, &new].map(|datagram| open(&mut opener, datagram)).join("\n");
    expect![[r"
        1.0 old
        2.0 new
        a datagram is of start 1 of its sender, and start 2 was heard already: it is an old one sent again, or the sender's disk was put back; pair the two sides again then
        a datagram was not made by the other side, or was changed on its way
        datagram 0 was received before, or came too late to tell"]].assert_eq(&told);
}

#[test]
fn a_receiver_that_starts_again_takes_nothing_that_it_has_heard() {
    let (mut sealer, mut before) = (sealer(3), opener(None));
    let [a, b, c] = ["a", "b", "c"].map(|text| sealed(&mut sealer, text.as_bytes()));
    assert_eq!([open(&mut before, &a), open(&mut before, &b)], ["3.0 a", "3.1 b"]);
    let mut after = opener(before.heard());
    let told = [&a, &b, &c].map(|datagram| open(&mut after, datagram)).join("\n");
    expect![[r"
        datagram 0 was received before, or came too late to tell
        datagram 1 was received before, or came too late to tell
        3.2 c"]]
    .assert_eq(&told);
}

#[test]
fn what_the_other_side_has_not_made_is_rejected() {
    let datagram = sealed(&mut sealer(1), b"stop");
    let other = PairingKey::from_bytes([9; 32]);
    let openers = [
        Opener::new((ID, &other), "rover", Direction::Down, None),
        Opener::new((ID, &key()), "rover 2", Direction::Down, None),
        Opener::new((ID, &key()), "rover", Direction::Up, None),
        Opener::new((KeyId(2), &key()), "rover", Direction::Down, None),
    ];
    let mut told: Vec<String> =
        openers.into_iter().map(|mut opener| open(&mut opener, &datagram)).collect();
    let mut newer = datagram.clone();
    newer[0] = 2;
    told.push(open(&mut opener(None), &newer));
    told.push(open(&mut opener(None), &datagram[..OVERHEAD - 1]));
    expect![[r"
        a datagram was not made by the other side, or was changed on its way
        a datagram was not made by the other side, or was changed on its way
        a datagram was not made by the other side, or was changed on its way
        a datagram is sealed with pairing key 1, which is not known here: pair the two sides again
        the other side speaks version 2 of the link, this one speaks 1: update the older side
        a datagram of 27 bytes is too short"]]
    .assert_eq(&told.join("\n"));
}

#[test]
fn no_packet_number_is_used_twice() {
    let mut sealer = sealer(1);
    sealer.next = super::NUMBERS - 1;
    assert_eq!(sealer.seal(b"", &mut Vec::new()), Ok(super::NUMBERS - 1));
    let mut out = b"before".to_vec();
    assert_eq!(sealer.seal(b"", &mut out), Err(SealError::NumbersUsed));
    assert_eq!(out, b"before");
    assert_eq!(Generation(u32::MAX).next(), None);
}

#[test]
fn a_key_is_not_in_debug_output() {
    let (key, other) = (PairingKey::generate().unwrap(), PairingKey::generate().unwrap());
    assert_ne!(key, other);
    assert_eq!(format!("{key:?}"), "PairingKey(..)");
}

proptest! {
    /// One bit is another one, anywhere: nothing is opened, and nothing that follows is lost by it.
    #[test]
    fn a_flipped_bit_is_rejected_and_changes_nothing(
        payload: Vec<u8>, at: Index, bit in 0..8_u32, heard: bool,
    ) {
        let (mut sealer, mut opener) = (sealer(5), opener(None));
        let first = sealed(&mut sealer, b"first");
        if heard {
            prop_assert!(opener.open(&mut first.clone()).is_ok());
        }
        let datagram = sealed(&mut sealer, &payload);
        let mut flipped = datagram.clone();
        flipped[at.index(datagram.len())] ^= 1 << bit;
        let before = opener.heard();
        prop_assert!(opener.open(&mut flipped).is_err());
        prop_assert_eq!(opener.heard(), before);
        let mut copy = datagram.clone();
        prop_assert_eq!(opener.open(&mut copy).unwrap().payload, &payload[..]);
    }

    #[test]
    fn noise_is_rejected(mut noise: Vec<u8>, header in any::<bool>()) {
        if header {
            noise.splice(0..0, sealed(&mut sealer(1), b"")[..12].iter().copied());
        }
        let rejected = opener(None).open(&mut noise).unwrap_err();
        prop_assert!(!matches!(rejected, Rejected::Repeated(_)), "{rejected}");
    }
}
