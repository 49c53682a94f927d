//! A link that carries less than its profile says. Behind a modem with a long queue, new events do not wait for older ones; on a path that
//! drops long datagrams, they become shorter.

mod world;

use rafcon_link::{CommandId, NewCommand, Profile, StreamId};
use rafcon_testkit::disturbed_link::PROFILES;
use rafcon_testkit::link_world::{Conditions, Cut};
use std::time::Duration;
use world::{RUN, World};

/// Files that are sent beside the events.
const FILES: StreamId = StreamId(2);
/// Interval of events.
const EVERY: Duration = Duration::from_millis(200);
const ITEM: usize = 60;
/// Number and length of the parts of files.
const PARTS: u64 = 322;
const PART: usize = 400;

/// Bytes of an event that no coder shortens.
fn item(event: u64) -> Vec<u8> {
    let hash = |nth: u64| (event * 64 + nth).wrapping_mul(0x9e37_79b9_7f4a_7c15).to_be_bytes();
    (0..8).flat_map(hash).take(ITEM).collect()
}

fn secs(secs: u64) -> Duration {
    Duration::from_secs(secs)
}

/// A modem of 64 and 9.6 kbit/s.
fn modem() -> (Conditions, Conditions) {
    let way = |bits_per_s| Conditions {
        delay: Duration::from_millis(600),
        bits_per_s,
        lost: 1,
        doubled: 0,
        late: 0,
        queue_max: secs(8),
        ..Conditions::delay_2s(bits_per_s)
    };
    (way(64_000), way(9_600))
}

#[test]
fn new_events_do_not_wait_in_a_slow_modem_behind_older_ones() {
    let (down, up) = modem();
    let mut world = World::new(&Profile::DELAY_2S, (down, up), EVERY, item);
    // 240 kB in the background, which takes 30 s of the link.
    world.robot.begin(FILES, 4_000);
    world.robot.set_rank(FILES, rafcon_link::Rank::Needed);
    world.go_on(secs(60));
    // At first nobody knows what the modem carries.
    let first = world.p99(secs(15), secs(60));
    world.down.cut(secs(60), secs(120), Cut::Drops);
    world.up.cut(secs(60), secs(120), Cut::Drops);
    world.go_on(secs(180));
    let second = world.p99(secs(125), secs(180));
    assert!(first <= Duration::from_millis(600), "{first:?} beside files");
    assert!(second <= Duration::from_millis(600), "{second:?} beside back-fill");
    assert_eq!(world.files, 4_000);
    assert_eq!(world.robot.progress(RUN).map(|(_, missing)| missing < 20), Some(true));
}

/// A link as its profile says, with this share of datagrams lost.
fn usual(lost: usize) -> (Conditions, Conditions) {
    let way = |bits_per_s| Conditions { lost, ..Conditions::delay_2s(bits_per_s) };
    (way(256_000), way(32_000))
}

fn with_files(profile: &Profile, ways: (Conditions, Conditions), parts: u64) -> World {
    let mut world = World::new(profile, ways, EVERY, item);
    world.robot.begin(FILES, parts);
    world.robot.set_rank(FILES, rafcon_link::Rank::Needed);
    world
}

#[test]
fn a_link_that_carries_its_rate_is_used_whole_whatever_it_loses() {
    for lost in [0, 2, 30] {
        let mut world = with_files(&Profile::DELAY_2S, usual(lost), 40_000);
        world.go_on(secs(20));
        assert_eq!(world.robot.send_rate(), 256_000, "{lost} % lost");
    }
    for profile in PROFILES {
        let way = |bits_per_s| Conditions::delay_2s(bits_per_s);
        let ways = (way(profile.down_bits_per_s), way(profile.up_bits_per_s));
        let mut world = with_files(&profile, ways, 1);
        world.go_on(profile.report_every * 30);
        assert_eq!(world.robot.send_rate(), profile.down_bits_per_s, "{}", profile.name);
    }
}

#[test]
fn without_an_up_link_the_rate_is_that_of_the_profile() {
    let mut world = with_files(&Profile::DELAY_2S, usual(2), 40_000);
    world.up.begin_cut(Duration::ZERO, Cut::Drops);
    world.go_on(Profile::DELAY_2S.silence() + secs(1));
    assert_eq!(world.robot.send_rate(), 256_000);
}

#[test]
fn a_link_that_carries_more_than_before_is_used_again() {
    let (down, up) = modem();
    let mut world = with_files(&Profile::DELAY_2S, (down.clone(), up), 1_000_000);
    world.go_on(secs(60));
    let slow = world.robot.send_rate();
    assert!((40_000..80_000).contains(&slow), "{slow}");
    world.down.set_conditions(Conditions { bits_per_s: 256_000, ..down });
    world.go_on(secs(180));
    assert_eq!(world.robot.send_rate(), 256_000);
}

/// What is later for good does not wait in a queue.
#[test]
fn a_longer_way_is_no_congestion() {
    let (down, up) = usual(2);
    let mut world = with_files(&Profile::DELAY_2S, (down.clone(), up), 1_000_000);
    world.go_on(secs(60));
    world.down.set_conditions(Conditions { delay: down.delay + secs(1), ..down });
    world.go_on(secs(90));
    assert_eq!(world.robot.send_rate(), 256_000);
}

#[test]
fn datagrams_become_as_short_as_a_path_needs_that_drops_longer_ones() {
    let way = Conditions { delay: Duration::from_millis(20), ..Conditions::delay_2s(10_000_000) };
    let mut world = with_files(&Profile::LAN, (way.clone(), way), 4_000);
    world.carries = 650;
    world.go_on(secs(1));
    // It does not fit into a datagram that passes, which is not known yet.
    let id = CommandId([1; 16]);
    let (valid, body) = (secs(60), vec![7; 1_000]);
    let command = NewCommand { id, valid, wait: None, epoch: 0, body };
    world.station.command(world.session_time(), command).expect("a clock");
    world.go_on(secs(60));
    assert_eq!(world.robot.shortened_datagrams(), Some(600));
    assert_eq!(world.station.shortened_datagrams(), Some(600));
    assert_eq!(world.carried_out, [id]);
    assert_eq!(world.files, 4_000);
    let late = world.p99(secs(30), secs(60));
    assert!(late <= Duration::from_millis(300), "{late:?}");
}

/// An event of a mission: much of it repeats.
fn mission_event(event: u64) -> Vec<u8> {
    let state = event.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 54;
    format!("\u{2}\u{8}entered state {state} of approach, outcome success").into_bytes()
}

#[test]
fn new_events_are_cheap_and_not_late_although_three_of_ten_datagrams_are_lost() {
    let way = |bits_per_s| Conditions {
        delay: Duration::from_millis(20),
        lost: 30,
        late: 30,
        ..Conditions::delay_2s(bits_per_s)
    };
    let ways = (way(4_000_000), way(1_000_000));
    let mut world = World::new(&Profile::WIFI, ways, EVERY, mission_event);
    world.go_on(secs(30));
    let (bytes, head) = (world.down.bytes, world.head);
    world.go_on(secs(150));
    let per_event = (world.down.bytes - bytes) / (world.head - head);
    let late = world.p99(secs(30), secs(140));
    assert!(per_event <= 150, "{per_event} bytes, {late:?}");
    assert!(late <= Duration::from_millis(400), "{late:?}");
}

/// A part of a file, whose bytes no coder shortens.
fn part(number: u64) -> Vec<u8> {
    (0..7).flat_map(|nth| item(number * 7 + nth)).take(PART).collect()
}

/// Bytes sent for 129 kB of files until the robot knows that all have arrived, in percent of the files.
fn cost_of_files(profile: &Profile, ways: (Conditions, Conditions)) -> u64 {
    let mut world = World::new(profile, ways, secs(600), part);
    world.robot.begin(FILES, PARTS);
    world.robot.set_rank(FILES, rafcon_link::Rank::Needed);
    while world.robot.progress(FILES).is_none_or(|(_, missing)| missing > 0) {
        world.go_on(world.now + Duration::from_millis(100));
        assert!(world.now < secs(3_600), "the files do not arrive");
    }
    let (sent, _) = world.robot.traffic();
    (sent.by_kind["machines"] * 100).div_ceil(PARTS * PART as u64)
}

#[test]
fn files_cost_little_more_than_their_bytes_also_before_the_first_report() {
    let link = |delay_ms, lost, [down, up]: [u64; 2]| {
        let way = |bits_per_s| Conditions {
            delay: Duration::from_millis(delay_ms),
            lost,
            doubled: 0,
            late: 0,
            queue_max: secs(8),
            ..Conditions::delay_2s(bits_per_s)
        };
        (way(down), way(up))
    };
    for (name, profile, ways, bar) in [
        ("2 s", Profile::DELAY_2S, link(2_000, 2, [256_000, 32_000]), 130),
        ("64 kbit/s", Profile::DELAY_2S, link(600, 5, [64_000, 9_600]), 130),
        ("8 s", Profile::DELAY_2S, link(8_000, 1, [256_000, 32_000]), 130),
        ("minutes", Profile::DEEP, link(240_000, 1, [8_000, 1_000]), 130),
        // Three of ten are lost: each byte has to be sent 1.43 times.
        ("wifi", Profile::WIFI, link(20, 30, [4_000_000, 1_000_000]), 185),
    ] {
        let cost = cost_of_files(&profile, ways);
        assert!(cost <= bar, "{name}: {cost} % of {bar} %");
    }
}
