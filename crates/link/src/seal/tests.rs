//! Sealed datagrams in every order, changed, repeated, and made by others.

use super::{
    Direction, For, Generation, Horizon, KeyId, OVERHEAD, Opener, PairingKey, Rejected,
    SALTED_HEADER, SealError, Sealer, SenderStart,
};
use expect_test::expect;
use proptest::prelude::{any, prop_assert, prop_assert_eq, proptest};
use proptest::sample::Index;
use proptest::test_runner::TestCaseError;

const ID: KeyId = KeyId(1);

fn key() -> PairingKey {
    PairingKey::from_bytes(std::array::from_fn(|at| u8::try_from(at).unwrap()))
}

fn sealer(generation: u32) -> Sealer {
    Sealer::new(ID, &key(), "rover", Direction::Down, SenderStart::new(generation, 0x5a17))
}

fn opener(heard: Option<Horizon>) -> Opener {
    Opener::new(ID, &key(), "rover", Direction::Down, heard)
}

fn sealed(sealer: &mut Sealer, payload: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    sealer.seal(For::Confirmed, payload, &mut out).unwrap();
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
    expect!["[45, 01, 00, 00, 00, 07, 00, 00, 00, 00, 00, 01, 00, 00, 5a, 17, c9, fc, 5e, bb, 05, 04, 91, 16, ce, ed, 4d, c3, f2, 7c, 14, 99, 48, 89, f1, 99]"].assert_eq(&format!("{bytes:02x?}"));
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

/// Copies of one disk count the same starts; the salt of each start keeps their keys apart.
#[test]
fn two_copies_of_a_sender_share_no_key_and_only_the_first_is_heard() {
    let start = |salt| SenderStart::new(7, salt);
    let copy = |salt| Sealer::new(ID, &key(), "rover", Direction::Down, start(salt));
    let (mut first, mut second) = (copy(1), copy(2));
    let [ours, theirs] = [&mut first, &mut second].map(|sealer| sealed(sealer, b"the same"));
    let stream = |datagram: &[u8]| datagram[SALTED_HEADER..].to_vec();
    assert_ne!(stream(&ours), stream(&theirs), "one key stream for two datagrams");
    let mut before = opener(None);
    let mut told = vec![open(&mut before, &ours), open(&mut before, &theirs)];
    let mut after = opener(before.heard());
    told.push(open(&mut after, &theirs));
    told.push(open(&mut after, &sealed(&mut first, b"more")));
    expect![[r"
        7.0 the same
        a datagram is of another start 7 of its sender than the one that was heard: its disk was copied or restored; pair one of the two again
        a datagram is of another start 7 of its sender than the one that was heard: its disk was copied or restored; pair one of the two again
        7.1 more"]].assert_eq(&told.join("\n"));
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
        Opener::new(ID, &other, "rover", Direction::Down, None),
        Opener::new(ID, &key(), "rover 2", Direction::Down, None),
        Opener::new(ID, &key(), "rover", Direction::Up, None),
        Opener::new(KeyId(2), &key(), "rover", Direction::Down, None),
    ];
    let mut told: Vec<String> =
        openers.into_iter().map(|mut opener| open(&mut opener, &datagram)).collect();
    let mut newer = datagram.clone();
    newer[0] = 6;
    told.push(open(&mut opener(None), &newer));
    told.push(open(&mut opener(None), &datagram[..OVERHEAD - 1]));
    told.push(open(&mut opener(None), &[0x80; 18]));
    expect![[r"
        a datagram was not made by the other side, or was changed on its way
        a datagram was not made by the other side, or was changed on its way
        a datagram was not made by the other side, or was changed on its way
        a datagram is sealed with pairing key 1, which is not known here: pair the two sides again
        the other side speaks version 6 of the link, this one speaks 5: update the older side
        a datagram of 31 bytes is too short
        a datagram of 18 bytes is too short"]]
    .assert_eq(&told.join("\n"));
}

/// A sender whose last datagrams have this number and the one after, the first of them confirmed.
fn confirmed(generation: u32, number: u64) -> (Sealer, Vec<u8>) {
    let mut sealer = sealer(generation);
    sealer.next = number;
    let first = sealed(&mut sealer, b"first");
    sealer.confirm(number);
    (sealer, first)
}

#[test]
fn a_receiver_that_confirmed_a_datagram_gets_short_headers() {
    let (mut sealer, first) = confirmed(7, 65_534);
    let mut opener = opener(None);
    let short: Vec<_> = (0..3).map(|_| sealed(&mut sealer, b"hold")).collect();
    let mut told = vec![open(&mut opener, &short[0]), open(&mut opener, &first)];
    told.extend([&short[2], &short[1], &short[2]].map(|datagram| open(&mut opener, datagram)));
    let mut out = Vec::new();
    sealer.seal(For::Anyone, b"all", &mut out).unwrap();
    told.push(open(&mut opener, &out));
    expect![[r"
        a datagram with a short header is of a start of its sender that was not heard yet, or is over: the next one with a full header tells
        7.65534 first
        7.65537 hold
        7.65536 hold
        datagram 65537 was received before, or came too late to tell
        7.65538 all"]]
    .assert_eq(&told.join("\n"));
    expect!["[ed, 00, 00]"].assert_eq(&format!("{:02x?}", &short[1][..3]));
    assert_eq!(short[1].len(), 4 + OVERHEAD - 13);
}

#[test]
fn a_short_header_is_used_as_long_as_it_can_be_told_what_it_means() {
    let (mut sealer, first) = confirmed(1, 100);
    let mut opener = opener(None);
    open(&mut opener, &first);
    for number in 101..20_000_u64 {
        let datagram = sealed(&mut sealer, b"");
        let is_short = datagram[0] & 0x80 != 0;
        assert_eq!(is_short, number - 100 < super::CONFIRMED_FOR, "{number}");
        // The receiver hears but the last one of those with a short header.
        if !is_short || number - 100 == super::CONFIRMED_FOR - 1 {
            assert_eq!(open(&mut opener, &datagram), format!("1.{number} "));
        }
    }
    sealer.confirm(19_999);
    assert_eq!(sealed(&mut sealer, b"").len(), 19);
    sealer.forget_confirmed();
    assert_eq!(sealed(&mut sealer, b"").len(), OVERHEAD);
    // What was never sent cannot be confirmed.
    sealer.confirm(1 << 40);
    assert_eq!(sealed(&mut sealer, b"").len(), OVERHEAD);
}

#[test]
fn a_short_header_of_another_start_or_key_is_rejected() {
    let (mut old, first) = confirmed(1, 3);
    let (mut new, second) = confirmed(2, 3);
    let (mut far, third) = confirmed(6, 3);
    let mut opener = opener(None);
    open(&mut opener, &first);
    let [old, new, far] = [&mut old, &mut new, &mut far].map(|sealer| sealed(sealer, b"short"));
    let mut told = vec![open(&mut opener, &new), open(&mut opener, &second)];
    told.extend([&old, &far, &new, &third].map(|datagram| open(&mut opener, datagram)));
    let mut other = new.clone();
    other[0] ^= 0b0001_0000;
    told.extend([&far, &other].map(|datagram| open(&mut opener, datagram)));
    expect![[r"
        a datagram with a short header is of a start of its sender that was not heard yet, or is over: the next one with a full header tells
        2.3 first
        a datagram with a short header is of a start of its sender that was not heard yet, or is over: the next one with a full header tells
        a datagram was not made by the other side, or was changed on its way
        2.4 short
        6.3 first
        6.4 short
        a datagram is sealed with pairing key 3, which is not known here: pair the two sides again"]]
    .assert_eq(&told.join("\n"));
}

#[test]
fn no_packet_number_is_used_twice() {
    let mut sealer = sealer(1);
    sealer.next = super::NUMBERS - 1;
    assert_eq!(sealer.seal(For::Anyone, b"", &mut Vec::new()), Ok(super::NUMBERS - 1));
    let mut out = b"before".to_vec();
    assert_eq!(sealer.seal(For::Anyone, b"", &mut out), Err(SealError::NumbersUsed));
    assert_eq!(out, b"before");
    assert_eq!(Generation(u32::MAX).next(), None);
}

#[test]
fn a_key_is_not_in_debug_output() {
    let (key, other) = (PairingKey::generate().unwrap(), PairingKey::generate().unwrap());
    assert_ne!(key, other);
    assert_eq!(format!("{key:?}"), "PairingKey(..)");
}

/// A datagram with one other bit is not opened and changes nothing; the datagram itself is opened afterwards.
fn flipped_is_rejected(
    (sealer, opener): (&mut Sealer, &mut Opener),
    payload: &[u8],
    (at, bit): (Index, u32),
) -> Result<(), TestCaseError> {
    let mut datagram = sealed(sealer, payload);
    let mut flipped = datagram.clone();
    flipped[at.index(datagram.len())] ^= 1 << bit;
    let before = opener.heard();
    prop_assert!(opener.open(&mut flipped).is_err());
    prop_assert_eq!(opener.heard(), before);
    prop_assert_eq!(opener.open(&mut datagram).unwrap().payload, payload);
    Ok(())
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
        flipped_is_rejected((&mut sealer, &mut opener), &payload, (at, bit))?;
    }

    #[test]
    fn noise_is_rejected(mut noise: Vec<u8>, header in any::<bool>()) {
        if header {
            noise.splice(0..0, sealed(&mut sealer(1), b"")[..SALTED_HEADER].iter().copied());
        }
        let rejected = opener(None).open(&mut noise).unwrap_err();
        prop_assert!(!matches!(rejected, Rejected::Repeated(_)), "{rejected}");
    }

    #[test]
    fn a_number_is_told_from_its_last_bits(newest in 0..super::NUMBERS - 40_000, off in -32_767..32_767_i64) {
        let number = newest.saturating_add_signed(off);
        let [.., n0, n1] = number.to_be_bytes();
        prop_assert_eq!(super::header::nearest(newest, u16::from_be_bytes([n0, n1])), number);
    }

    #[test]
    fn a_flipped_bit_of_a_short_datagram_is_rejected_and_changes_nothing(
        payload: Vec<u8>, at: Index, bit in 0..8_u32,
    ) {
        let (mut sealer, first) = confirmed(5, 70_000);
        let mut opener = opener(None);
        prop_assert!(opener.open(&mut first.clone()).is_ok());
        flipped_is_rejected((&mut sealer, &mut opener), &payload, (at, bit))?;
    }
}

#[test]
fn numbers_continue_over_a_change_of_keys_and_what_was_confirmed_before_does_not_count() {
    let sealer = |id, byte| {
        let key = PairingKey::from_bytes([byte; 32]);
        Sealer::new(KeyId(id), &key, "scout", Direction::Down, SenderStart::new(1, 0))
    };
    let seal = |sealer: &mut Sealer| {
        let mut datagram = Vec::new();
        let number = sealer.seal(For::Confirmed, b"", &mut datagram).expect("a number");
        format!("{number}: {} bytes", datagram.len())
    };
    let (mut old, mut new) = (sealer(1, 1), sealer(2, 2));
    let first = [seal(&mut old), seal(&mut old)];
    new.follow(&old);
    new.confirm(1);
    let unconfirmed = seal(&mut new);
    new.confirm(2);
    let [one, two] = first;
    assert_eq!(
        [one, two, unconfirmed, seal(&mut new)],
        ["0: 32 bytes", "1: 32 bytes", "2: 32 bytes", "3: 19 bytes"]
    );
}
