//! The coder there and back: whatever is coded is the same afterwards. Knows nothing of frames.

use super::{Coder, ContextName, PLAIN_MAX, SentSnapshots};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn what_is_coded_comes_back(
        known in prop::collection::vec(any::<u8>(), 0..200),
        plain in prop::collection::vec(prop_oneof![3 => 0..4_u8, 1 => any::<u8>()], 0..600),
    ) {
        let (mut robot, mut station) = (Coder::new(&known), Coder::new(&known));
        for _ in 0..2 {
            let coded = robot.encode(&plain);
            prop_assert_eq!(station.decode(&coded, plain.len()), Some(plain.clone()));
            prop_assert!(coded.len() <= plain.len() * 2 + 8);
        }
    }

    #[test]
    fn any_bytes_become_as_many_as_they_should_and_leave_nothing_behind(
        coded in prop::collection::vec(any::<u8>(), 0..300),
        length in 0..2_000_usize,
    ) {
        let items = b"entered Waypoint 12, left Waypoint 12, entered Waypoint 13";
        let mut coder = Coder::new(items);
        let before = coder.encode(items);
        prop_assert_eq!(coder.decode(&coded, length).map(|plain| plain.len()), Some(length));
        prop_assert_eq!(coder.encode(items), before);
    }
}

#[test]
fn a_datagram_does_not_become_more_than_so_much() {
    assert_eq!(Coder::new(b"").decode(b"bomb", PLAIN_MAX + 1), None);
}

#[test]
fn of_the_snapshots_that_were_sent_the_oldest_leaves_and_others_are_coded_from() {
    let snapshot = |sequence: u64| vec![sequence.to_le_bytes()[0]; 8_192];
    let codes_from = |count: u64, known: u64| {
        let mut sent = SentSnapshots::default();
        (1..=count).for_each(|sequence| sent.note(sequence, snapshot(sequence)));
        sent.offer(Some(ContextName::of(known, known, &snapshot(known))));
        sent.encode(b"how it stands").is_some()
    };
    assert!(codes_from(32, 1));
    assert!(!codes_from(33, 1));
    assert!(codes_from(33, 2) && codes_from(33, 33));
}
