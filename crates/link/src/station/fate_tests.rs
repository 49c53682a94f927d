//! Fates of commands over links of any delay that are cut in either direction, with a robot whose server starts again: a fate that the
//! station reports is the one in the robot's journal, and every fate is known in the end.

use super::{CommandId, CommandState, FromRobot, NewCommand, NotSent, StationSession};
use crate::endpoint::Identity;
use crate::frame::StreamId;
use crate::profile::Profile;
use crate::robot::{EventBuffer, ReceivedCommand, RobotSession, RunSource};
use crate::seal::{Horizon, KeyId, PairingKey, SenderStart};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

struct NoRuns;

impl RunSource for NoRuns {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBuffer> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

/// What happens to the link or to the robot, as shares of the test's time in percent.
#[derive(Debug, Clone, Copy)]
enum Trouble {
    UpCut(u64, u64),
    DownCut(u64, u64),
    RobotStarts(u64),
    /// Of so many datagrams in each direction one is lost.
    Losses(u64),
}

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

#[derive(Debug, Clone)]
struct Scenario {
    profile: Profile,
    one_way: Duration,
    troubles: Vec<Trouble>,
    commands: Vec<Given>,
}

impl Scenario {
    /// Long enough for a few exchanges before the link is whole for good.
    fn troubled(&self) -> Duration {
        self.one_way * 20 + self.profile.status_every * 20
    }

    fn is_cut(&self, now: Duration, is_up: bool) -> bool {
        let percent = now.as_millis() * 100 / self.troubled().as_millis();
        self.troubles.iter().any(|trouble| match trouble {
            Trouble::UpCut(from, to) => {
                is_up && (u128::from(*from)..u128::from(*to)).contains(&percent)
            }
            Trouble::DownCut(from, to) => {
                !is_up && (u128::from(*from)..u128::from(*to)).contains(&percent)
            }
            Trouble::RobotStarts(_) | Trouble::Losses(_) => false,
        })
    }

    fn is_lost(&self, now: Duration, number: u64, is_up: bool) -> bool {
        let is_one = |trouble: &Trouble| matches!(trouble, Trouble::Losses(of) if number.is_multiple_of(*of));
        self.is_cut(now, is_up) || now < self.troubled() && self.troubles.iter().any(is_one)
    }
}

struct TroubledLink {
    scenario: Scenario,
    now: Duration,
    /// Datagrams in flight by their direction: when they arrive, and their bytes.
    up: VecDeque<(Duration, Vec<u8>)>,
    down: VecDeque<(Duration, Vec<u8>)>,
    /// Datagrams that were sent.
    sent: u64,
    station: StationSession,
    robot: RobotSession,
    robot_began: Duration,
    robot_starts: u32,
    robot_heard: Option<Horizon>,
    /// The robot's journal.
    carried_out: BTreeMap<CommandId, u32>,
    fates: BTreeMap<CommandId, CommandState>,
    overdue: BTreeSet<CommandId>,
}

fn key() -> PairingKey {
    PairingKey::from_bytes([7; 32])
}

fn robot_session(profile: &Profile, start: u32, heard: Option<Horizon>) -> RobotSession {
    let start = SenderStart::new(start, 0);
    let identity = Identity { key_id: KeyId(1), key: &key(), robot: "scout", start, heard };
    let mut robot = RobotSession::new(&identity, profile.clone());
    robot.begin(StreamId(1), 0);
    robot
}

impl TroubledLink {
    fn new(scenario: Scenario) -> Self {
        let start = SenderStart::new(1, 0);
        let identity =
            Identity { key_id: KeyId(1), key: &key(), robot: "scout", start, heard: None };
        Self {
            now: Duration::ZERO,
            up: VecDeque::new(),
            down: VecDeque::new(),
            sent: 0,
            station: StationSession::new(&identity, scenario.profile.clone()),
            robot: robot_session(&scenario.profile, 1, None),
            robot_began: Duration::ZERO,
            robot_starts: 1,
            robot_heard: None,
            carried_out: BTreeMap::new(),
            fates: BTreeMap::new(),
            overdue: BTreeSet::new(),
            scenario,
        }
    }

    /// Time of the robot's session.
    fn robot_time(&self) -> Duration {
        self.now.saturating_sub(self.robot_began)
    }

    fn restart_robot(&mut self) {
        (self.robot_starts, self.robot_began) = (self.robot_starts + 1, self.now);
        self.robot = robot_session(&self.scenario.profile, self.robot_starts, self.robot_heard);
    }

    /// The robot's runner does what it may, and its journal keeps that.
    fn do_command(&mut self, command: &ReceivedCommand) {
        let local = self.robot_time();
        assert!(command.body == body_of(command.id, command.body.len()), "another body");
        let is_done = self.carried_out.contains_key(&command.id);
        if !command.is_late && !is_done {
            assert!(local.as_millis() <= u128::from(command.not_after_ms), "carried out late");
            *self.carried_out.entry(command.id).or_default() += 1;
        }
        if self.carried_out.contains_key(&command.id) {
            self.robot.set_command_state(local, command.id, CommandState::Done, "");
        }
    }

    /// Goes on to this time, from one moment to the next at which something is due.
    fn go_on(&mut self, until: Duration) {
        while self.now < until {
            let local = self.robot_time();
            while let Some(datagram) = self.robot.transmit(local, &mut NoRuns).expect("numbers") {
                self.sent += 1;
                if !self.scenario.is_lost(self.now, self.sent, false) {
                    self.down.push_back((self.now + self.scenario.one_way, datagram));
                }
            }
            while let Some(datagram) = self.station.transmit(self.now).expect("numbers") {
                self.sent += 1;
                if !self.scenario.is_lost(self.now, self.sent, true) {
                    self.up.push_back((self.now + self.scenario.one_way, datagram));
                }
            }
            self.overdue.extend(self.station.take_overdue(self.now));
            let due = [
                self.robot_began + self.robot.next_transmit(local),
                self.station.next_transmit(self.now),
            ];
            let arrivals = [&self.up, &self.down].map(|way| way.front().map(|(at, _)| *at));
            let next = due.into_iter().chain(arrivals.into_iter().flatten()).min();
            self.now = next.unwrap_or(until).max(self.now + Duration::from_millis(1)).min(until);
            self.arrive();
        }
    }

    fn arrive(&mut self) {
        let local = self.robot_time();
        while let Some((_, mut datagram)) = self.up.pop_front_if(|(at, _)| *at <= self.now) {
            let mut commands = Vec::new();
            let _of_an_earlier_start =
                self.robot.receive(local, &mut datagram, |command| commands.push(command));
            self.robot_heard = self.robot.horizon();
            for command in &commands {
                self.do_command(command);
            }
        }
        while let Some((_, mut datagram)) = self.down.pop_front_if(|(at, _)| *at <= self.now) {
            let fates = &mut self.fates;
            let show = |shown: FromRobot<'_>| {
                if let FromRobot::CommandState { id, state, .. } = shown {
                    fates.insert(id, state);
                }
            };
            let _of_an_earlier_start = self.station.receive(self.now, &mut datagram, show);
        }
    }

    fn check_fates(&self) {
        for (id, fate) in &self.fates {
            let is_done = self.carried_out.contains_key(id);
            match fate {
                CommandState::Done => assert!(is_done, "{id:?} was not carried out"),
                CommandState::Expired => assert!(!is_done, "{id:?} was carried out"),
                CommandState::Received | CommandState::Started | CommandState::Refused => {}
            }
        }
        assert!(self.carried_out.values().all(|times| *times == 1));
    }
}

fn check(scenario: &Scenario) -> TroubledLink {
    let mut world = TroubledLink::new(scenario.clone());
    let at = |percent: u64| scenario.troubled() * u32::try_from(percent).expect("percent") / 100;
    let mut moments: Vec<(Duration, Option<(u8, Given)>)> = Vec::new();
    for (nth, given) in (1..).zip(&scenario.commands) {
        moments.push((at(given.percent), Some((nth, *given))));
    }
    for trouble in &scenario.troubles {
        if let Trouble::RobotStarts(percent) = trouble {
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
        let valid = scenario.one_way * 2 * round_trips + takes + Duration::from_secs(1);
        let command = NewCommand { id, valid, wait: None, epoch: 0, body: body_of(id, length) };
        if world.station.command(world.now, command).is_ok() {
            given.push(id);
        }
    }
    // From now on the link is whole.
    world.go_on(scenario.troubled());
    let whole = world.now + scenario.one_way * 12 + scenario.profile.status_every * 20;
    world.go_on(whole + transfers * 4 + Duration::from_mins(5));
    world.check_fates();
    for id in given {
        assert!(!world.station.is_open(id), "the fate of {id:?} is never known");
        assert!(matches!(world.fates.get(&id), Some(CommandState::Done | CommandState::Expired)));
    }
    world
}

const DELAYS_MS: [u64; 5] = [20, 2_000, 8_000, 60_000, 600_000];
const PROFILES: [Profile; 4] = [Profile::LAN, Profile::WIFI, Profile::DELAY_2S, Profile::DEEP];

/// The way back is dead while the command arrives: it is carried out, overdue at the station, and known to be done afterwards.
#[test]
fn a_command_that_was_carried_out_is_never_called_expired() {
    for (profile, delay_ms) in PROFILES.iter().flat_map(|it| DELAYS_MS.map(|ms| (it.clone(), ms))) {
        let one_way = Duration::from_millis(delay_ms);
        let troubles = vec![Trouble::DownCut(40, 90)];
        let commands = vec![Given { percent: 45, round_trips: 1, length: 5 }];
        let world = check(&Scenario { profile, one_way, troubles, commands });
        let id = CommandId([1; 16]);
        assert_eq!(world.carried_out.get(&id), Some(&1));
        assert_eq!(world.fates.get(&id), Some(&CommandState::Done));
        assert!(world.overdue.contains(&id), "its fate was unknown for a while");
    }
}

/// The up-link is dead: what the robot says after the time of the command proves that it cannot be carried out.
#[test]
fn a_command_over_a_dead_up_link_expires_as_soon_as_the_robot_proves_it() {
    for (profile, delay_ms) in PROFILES.iter().flat_map(|it| DELAYS_MS.map(|ms| (it.clone(), ms))) {
        let one_way = Duration::from_millis(delay_ms);
        let troubles = vec![Trouble::UpCut(40, 100)];
        let scenario = Scenario { profile, one_way, troubles, commands: Vec::new() };
        let mut world = TroubledLink::new(scenario.clone());
        world.go_on(scenario.troubled() * 45 / 100);
        let (id, valid) = (CommandId([1; 16]), one_way * 2 + Duration::from_secs(1));
        let command = NewCommand { id, valid, wait: None, epoch: 0, body: body_of(id, 5) };
        world.station.command(world.now, command).expect("a clock");
        // Over at the robot, and told on the way down with the next status.
        world.go_on(world.now + valid + one_way + scenario.profile.status_every * 8);
        assert_eq!(world.fates.get(&id), Some(&CommandState::Expired));
        assert!(!world.carried_out.contains_key(&id) && !world.station.is_open(id));
    }
}

fn troubles() -> impl Strategy<Value = Vec<Trouble>> {
    let cut = (0..90_u64, 1..40_u64).prop_map(|(from, length)| (from, from + length));
    let trouble = prop_oneof![
        cut.clone().prop_map(|(from, to)| Trouble::UpCut(from, to)),
        cut.prop_map(|(from, to)| Trouble::DownCut(from, to)),
        (10..100_u64).prop_map(Trouble::RobotStarts),
        (2..20_u64).prop_map(Trouble::Losses),
    ];
    prop::collection::vec(trouble, 0..5)
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
    for (profile, delay_ms) in PROFILES.iter().flat_map(|it| DELAYS_MS.map(|ms| (it.clone(), ms))) {
        let one_way = Duration::from_millis(delay_ms);
        let losses = Scenario {
            profile: profile.clone(),
            one_way,
            troubles: vec![Trouble::Losses(3)],
            commands: Vec::new(),
        };
        let mut world = TroubledLink::new(losses);
        world.go_on(one_way * 4 + profile.status_every * 8);
        let (script, stop) = (CommandId([1; 16]), CommandId([2; 16]));
        let (takes, began) = (world.station.transfer_time(20_000), world.now);
        let valid = world.station.command_lifetime(began) + takes * 4;
        let command =
            |id, length| NewCommand { id, valid, wait: None, epoch: 0, body: body_of(id, length) };
        let NotSent::TooSlow { .. } = world
            .station
            .command(began, NewCommand { valid: takes / 2, ..command(script, 20_000) })
            .unwrap_err()
        else {
            panic!("it cannot arrive in time");
        };
        world.station.command(began, command(script, 20_000)).expect("a clock");
        world.go_on(began + takes / 4);
        world.station.command(world.now, command(stop, 40)).expect("a clock");
        let datagram = Duration::from_secs((profile.up_bytes_max as u64 + 28) * 8)
            / u32::try_from(profile.up_bits_per_s).unwrap();
        world.go_on(world.now + one_way + Duration::from_millis(200) + datagram * 4);
        assert_eq!(world.carried_out.get(&stop), Some(&1), "{} {delay_ms}", profile.name);
        let mut arrived = 0;
        while world.station.is_open(script) {
            world.go_on(world.now + one_way + Duration::from_secs(1));
            if let Some(progress) = world.station.command_progress(script) {
                assert_eq!(progress.length, 20_000);
                assert!(progress.arrived >= arrived, "progress never falls");
                arrived = progress.arrived;
            }
        }
        assert_eq!(world.fates.get(&script), Some(&CommandState::Done));
        assert_eq!(world.carried_out.get(&script), Some(&1));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn the_station_and_the_journal_of_the_robot_agree_about_every_command(
        delay in prop::sample::select(DELAYS_MS.to_vec()),
        profile in prop::sample::select(PROFILES.to_vec()),
        troubles in troubles(),
        commands in prop::collection::vec(given(), 1..8),
    ) {
        let one_way = Duration::from_millis(delay);
        check(&Scenario { profile, one_way, troubles, commands });
    }
}
