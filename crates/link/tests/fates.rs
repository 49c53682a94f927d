//! Fates of commands over links of any delay that are cut in either direction, with a robot whose server starts again: a fate that the
//! station reports is the one in the robot's journal, and every fate is known in the end.

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use rafcon_link::{CommandId, CommandState, NewCommand, NotSent};
use rafcon_testkit::disturbed_link::{
    DELAYS_MS, Disturbance, DisturbedLink, LinkSetup, PROFILES, links,
};
use std::cell::Cell;
use std::time::Duration;

/// A command: when it is given, in percent, how long it is valid, in round trips, and its length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Given {
    percent: u64,
    round_trips: u32,
    length: usize,
}

/// Bytes that are different for each command and at each place.
fn body_of(id: CommandId, length: usize) -> Vec<u8> {
    let byte = |at: usize| u8::try_from((at * 7 + at / 251) % 256).expect("a byte");
    (0..length).map(|at| id.0[0].wrapping_mul(31) ^ byte(at)).collect()
}

fn check(link: &LinkSetup, commands: &[Given]) -> DisturbedLink {
    let mut world = DisturbedLink::new(link.clone());
    let at = |percent: u64| link.disturbed() * u32::try_from(percent).expect("percent") / 100;
    let mut moments: Vec<(Duration, Option<(u8, Given)>)> = Vec::new();
    for (nth, given) in (1..).zip(commands) {
        moments.push((at(given.percent), Some((nth, *given))));
    }
    for disturbance in &link.disturbances {
        if let Disturbance::RobotStarts(percent) = disturbance {
            moments.push((at(*percent), None));
        }
    }
    moments.sort();
    let (mut given, mut transfers) = (Vec::new(), Duration::ZERO);
    for (moment, command) in moments {
        world.go_on(moment);
        world.check_fates();
        let Some((nth, Given { round_trips, length, .. })) = command else {
            world.restart_robot();
            continue;
        };
        let id = CommandId([nth; 16]);
        let takes = world.station.transfer_time(length);
        transfers += takes;
        let valid = link.one_way * 2 * round_trips + takes + Duration::from_secs(1);
        let command = NewCommand { id, valid, wait: None, epoch: 0, body: body_of(id, length) };
        if world.command(command).is_ok() {
            given.push(id);
        }
    }
    // From now on the link is whole.
    world.go_on(link.disturbed());
    let whole = world.now + link.one_way * 12 + link.profile.status_every * 20;
    world.go_on(whole + transfers * 4 + Duration::from_mins(5));
    world.check_fates();
    for id in given {
        assert!(!world.station.is_open(id), "the fate of {id:?} is never known");
        assert!(matches!(world.fates.get(&id), Some(CommandState::Done | CommandState::Expired)));
    }
    world
}

/// The way back is dead while the command arrives: it is carried out, overdue at the station, and known to be done afterwards.
#[test]
fn a_command_that_was_carried_out_is_never_called_expired() {
    for (profile, one_way) in links() {
        let disturbances = vec![Disturbance::DownCut(40, 90)];
        let commands = vec![Given { percent: 45, round_trips: 1, length: 5 }];
        let world = check(&LinkSetup { profile, one_way, disturbances }, &commands);
        let id = CommandId([1; 16]);
        assert_eq!(world.carried_out.get(&id), Some(&1));
        assert_eq!(world.fates.get(&id), Some(&CommandState::Done));
        assert!(world.overdue.contains(&id), "its fate was unknown for a while");
    }
}

/// The up-link is dead: what the robot says after the time of the command proves that it cannot be carried out.
#[test]
fn a_command_over_a_dead_up_link_expires_as_soon_as_the_robot_proves_it() {
    for (profile, one_way) in links() {
        let disturbances = vec![Disturbance::UpCut(40, 100)];
        let link = LinkSetup { profile, one_way, disturbances };
        let mut world = DisturbedLink::new(link.clone());
        world.go_on(link.disturbed() * 45 / 100);
        let (id, valid) = (CommandId([1; 16]), one_way * 2 + Duration::from_secs(1));
        let command = NewCommand { id, valid, wait: None, epoch: 0, body: body_of(id, 5) };
        world.command(command).expect("a clock");
        // Over at the robot, and told on the way down with the next status.
        world.go_on(world.now + valid + one_way + link.profile.status_every * 8);
        assert_eq!(world.fates.get(&id), Some(&CommandState::Expired));
        assert!(!world.carried_out.contains_key(&id) && !world.station.is_open(id));
    }
}

fn disturbances() -> impl Strategy<Value = Vec<Disturbance>> {
    let cut = (0..90_u64, 1..40_u64).prop_map(|(from, length)| (from, from + length));
    let disturbance = prop_oneof![
        cut.clone().prop_map(|(from, to)| Disturbance::UpCut(from, to)),
        cut.prop_map(|(from, to)| Disturbance::DownCut(from, to)),
        (10..100_u64).prop_map(Disturbance::RobotStarts),
        (2..20_u64).prop_map(Disturbance::Losses),
    ];
    prop::collection::vec(disturbance, 0..5)
}

fn given() -> impl Strategy<Value = Given> {
    let length = prop_oneof![3 => 1..40_usize, 1 => 40..3_000_usize];
    (20..100_u64, 0..4_u32, length).prop_map(|(percent, round_trips, length)| Given {
        percent,
        round_trips,
        length,
    })
}

/// A script of 20,000 bytes, of which each third datagram is lost on its way.
#[test]
fn a_long_command_arrives_over_every_link_and_a_stop_does_not_wait_for_it() {
    for (profile, one_way) in links() {
        let losses = LinkSetup {
            profile: profile.clone(),
            one_way,
            disturbances: vec![Disturbance::Losses(3)],
        };
        let mut world = DisturbedLink::new(losses);
        world.go_on(one_way * 4 + profile.status_every * 8);
        let (script, stop) = (CommandId([1; 16]), CommandId([2; 16]));
        let takes = world.station.transfer_time(20_000);
        // Of what is sent again, a third is lost again: each repetition takes a round trip.
        let valid = world.station.command_lifetime(world.station_time()) + takes * 4 + one_way * 8;
        let command =
            |id, length| NewCommand { id, valid, wait: None, epoch: 0, body: body_of(id, length) };
        let NotSent::TooSlow { .. } =
            world.command(NewCommand { valid: takes / 2, ..command(script, 20_000) }).unwrap_err()
        else {
            panic!("it cannot arrive in time");
        };
        world.command(command(script, 20_000)).expect("a clock");
        world.go_on(world.now + takes / 4);
        world.command(command(stop, 40)).expect("a clock");
        let datagram = Duration::from_secs((profile.up_bytes_max as u64 + 28) * 8)
            / u32::try_from(profile.up_bits_per_s).unwrap();
        world.go_on(world.now + one_way + Duration::from_millis(200) + datagram * 4);
        assert_eq!(world.carried_out.get(&stop), Some(&1), "{} {one_way:?}", profile.name);
        let mut arrived = 0;
        while world.station.is_open(script) {
            world.go_on(world.now + one_way + Duration::from_secs(1));
            if let Some(progress) = world.station.command_progress(script) {
                assert_eq!(progress.length, 20_000);
                assert!(progress.arrived >= arrived, "progress never falls");
                arrived = progress.arrived;
            }
        }
        let at = format!("{} {one_way:?}", profile.name);
        assert_eq!(world.fates.get(&script), Some(&CommandState::Done), "{at}");
        assert_eq!(world.carried_out.get(&script), Some(&1));
    }
}

/// `RAFCON_TEST_LINKS` sets how many links are tried, each with up to seven commands.
#[test]
#[expect(clippy::disallowed_methods, reason = "the long form of the test is asked for")]
fn the_station_and_the_journal_of_the_robot_agree_about_every_command() {
    let links =
        std::env::var("RAFCON_TEST_LINKS").map_or(64, |links| links.parse().expect("a number"));
    let commands = Cell::new(0);
    let strategy = (
        prop::sample::select(DELAYS_MS.to_vec()),
        prop::sample::select(PROFILES.to_vec()),
        disturbances(),
        prop::collection::vec(given(), 1..8),
    );
    let config =
        ProptestConfig { cases: links, source_file: Some(file!()), ..ProptestConfig::default() };
    let tried = TestRunner::new(config).run(&strategy, |(delay, profile, disturbances, given)| {
        let one_way = Duration::from_millis(delay);
        check(&LinkSetup { profile, one_way, disturbances }, &given);
        commands.set(commands.get() + given.len());
        Ok(())
    });
    if let Err(wrong) = tried {
        panic!("{wrong}");
    }
    println!(r#"{{"name":"commands_wrong_fate","value":0,"unit":"","of":{}}}"#, commands.get());
}
