//! Events with large values: what they cost, and that newer events do not wait for them.

mod world;

use rafcon_link::{Identity, KeyId, PairingKey, Profile, SenderStart, StationSession};
use rafcon_testkit::link_world::{Conditions, Cut};
use std::fmt::Write as _;
use std::time::Duration;
use world::World;

/// Events in a round of the machine: the value is in one of them.
const ROUND: u64 = 4;
/// Readings of a scan.
const READINGS: u64 = 250;

/// A scan of 1.8 kB as text, each like the one before, then three short events.
fn scan_or_short(event: u64) -> Vec<u8> {
    let round = event / ROUND;
    if !event.is_multiple_of(ROUND) {
        return format!("\u{2}entered {} at {round}", event % ROUND).into_bytes();
    }
    let mut text = format!(r#"{{"frame":"laser","stamp":{round},"ranges":["#);
    for reading in 0..READINGS {
        let noise = (round * READINGS + reading).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 58;
        write!(text, "{}.{:03},", 2 + reading / 100, reading % 100 * 9 + noise).unwrap_or_default();
    }
    text.into_bytes()
}

#[test]
fn a_value_of_two_kilobytes_in_each_round_costs_its_coded_length_twice() {
    let way = Conditions::delay_2s;
    let every = Duration::from_millis(100);
    let ways = (way(256_000), way(32_000));
    let mut world = World::new(&Profile::DELAY_2S, ways, every, scan_or_short);
    world.go_on(Duration::from_secs(30));
    let (bytes, head) = (world.down.bytes, world.head);
    world.go_on(Duration::from_secs(90));
    let per_event = (world.down.bytes - bytes) / (world.head - head);
    let late = world.p99(Duration::from_secs(30), Duration::from_secs(80));
    assert!(per_event <= 300, "{per_event} bytes");
    assert!(late <= Duration::from_millis(300), "{late:?}");
}

/// The loss of a datagram is no reason for a request: what it carried is sent twice, whether it fits into a datagram with others or not.
#[test]
fn no_event_beside_long_ones_waits_for_a_report() {
    let way = |lost| Conditions { lost, late: 0, doubled: 0, ..Conditions::delay_2s(256_000) };
    let mut world =
        World::new(&Profile::DELAY_2S, (way(2), way(0)), Duration::from_millis(200), scan_or_short);
    world.go_on(Duration::from_secs(630));
    let (from, to) = (Duration::from_secs(30), Duration::from_secs(620));
    let late = world.quantile(998, from, to);
    assert!(late <= Duration::from_millis(600), "{late:?}");
}

/// Bytes that no coder shortens, six datagrams of them in every tenth event.
fn noise_or_short(event: u64) -> Vec<u8> {
    let hash = |nth: u64| (event * 1_024 + nth).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = |nth: u64| (hash(nth) ^ hash(nth) >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let words = if event.is_multiple_of(10) { NOISE / 8 } else { 2 };
    (0..words).flat_map(|nth| mixed(nth).to_be_bytes()).collect()
}

const NOISE: u64 = 6_400;

#[test]
fn of_a_long_event_only_the_lost_parts_are_sent_again() {
    let way = |bits_per_s| Conditions {
        delay: Duration::from_millis(300),
        lost: 20,
        ..Conditions::delay_2s(bits_per_s)
    };
    let ways = (way(1_000_000), way(100_000));
    let every = Duration::from_millis(200);
    let mut world = World::new(&Profile::WIFI, ways, every, noise_or_short);
    world.go_on(Duration::from_secs(20));
    let (bytes, head) = (world.down.bytes, world.head);
    world.go_on(Duration::from_mins(2));
    let long = (world.head - head) / 10;
    let per_long = (world.down.bytes - bytes) / long;
    // Sent once, repaired twice or thrice, and nine short events beside it.
    assert!(per_long <= 16_000, "{per_long} bytes for each long event");
    let (from, to) = (Duration::from_secs(20), Duration::from_secs(110));
    let late = world.quantile(890, from, to);
    assert!(late <= Duration::from_millis(400), "{late:?} for short events");
    let late = world.quantile(999, from, to);
    assert!(late <= Duration::from_secs(5), "{late:?} for long ones");
}

/// A long text, each like the one before.
fn texts(event: u64) -> Vec<u8> {
    let line = |nth| format!("reading {nth} of round {}: {}\n", event / 10, (event + nth) % 7);
    if event.is_multiple_of(10) {
        (0..200).map(line).collect::<String>().into_bytes()
    } else {
        vec![1; 9]
    }
}

#[test]
fn a_long_event_is_sent_in_its_packed_length() {
    for profile in [Profile::LAN, Profile::WIFI, Profile::DELAY_2S] {
        let way = || Conditions::delay_2s(256_000);
        let mut world = World::new(&profile, (way(), way()), Duration::from_millis(300), texts);
        world.go_on(Duration::from_mins(1));
        let (bytes, head) = (world.down.bytes, world.head);
        world.go_on(Duration::from_mins(3));
        let per_round = (world.down.bytes - bytes) / ((world.head - head) / 10);
        assert!(per_round <= 3_000, "{}: {per_round} bytes for 6 kB", profile.name);
    }
}

/// A long event whose first parts are lost with the link. Then only the link to the station returns, and the station has started again.
#[test]
fn a_station_that_cannot_report_reads_a_long_event_although_it_has_lost_the_context() {
    let way = || Conditions { lost: 0, late: 0, doubled: 0, ..Conditions::delay_2s(256_000) };
    let mut world =
        World::new(&Profile::DELAY_2S, (way(), way()), Duration::from_secs(2), one_long_text);
    world.go_on(Duration::from_secs(55));
    world.up.begin_cut(world.now, Cut::Drops);
    world.down.begin_cut(world.now, Cut::Drops);
    world.go_on(Duration::from_mins(1));
    assert_eq!(world.head, LONG);
    let (key_id, key, start) = (KeyId(1), PairingKey::from_bytes([7; 32]), SenderStart::new(2, 0));
    let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
    world.station = StationSession::new(&identity, Profile::DELAY_2S);
    world.go_on(Duration::from_secs(90));
    world.down.end_cut(world.now);
    world.delays.clear();
    world.go_on(Duration::from_mins(3));
    let at = Duration::from_secs(2 * LONG);
    assert!(world.delays.iter().any(|(event, _)| *event == at), "it never came");
}

/// The long event.
const LONG: u64 = 30;

fn one_long_text(event: u64) -> Vec<u8> {
    if event == LONG { [noise_or_short(10), texts(10)].concat() } else { texts(10)[..60].to_vec() }
}
