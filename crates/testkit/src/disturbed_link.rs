//! A station and a robot with a link that is cut in either direction, and with restarts of the robot's server. Checks the
//! guarantees of commands: none is executed late, twice or with other bytes, and the station reports the robot's own fates.

use rafcon_link::{
    CommandId, CommandState, EventBlock, FromRobot, Horizon, Identity, KeyId, NewCommand, NotSent,
    PairingKey, Profile, ReceivedCommand, RobotSession, RunSource, SenderStart, SessionTime,
    StationSession, StreamId,
};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;
use std::time::Duration;

/// One-way delays for tests, in ms: a room, field tests of planetary missions, and planetary distances.
pub const DELAYS_MS: [u64; 5] = [20, 2_000, 8_000, 60_000, 600_000];
/// All profiles of links.
pub const PROFILES: [Profile; 4] = [Profile::LAN, Profile::WIFI, Profile::DELAY_2S, Profile::DEEP];

/// All combinations of profile and delay.
pub fn links() -> impl Iterator<Item = (Profile, Duration)> {
    let delays = DELAYS_MS.map(Duration::from_millis);
    PROFILES.into_iter().flat_map(move |profile| delays.map(|delay| (profile.clone(), delay)))
}

struct NoRuns;

impl RunSource for NoRuns {
    fn events(&mut self, _: StreamId, _: u64, _: u64, _: usize) -> Option<EventBlock> {
        None
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

/// An event on the link or at the robot. Times are percentages of [`LinkSetup::disturbed`].
#[derive(Debug, Clone, Copy)]
pub enum Disturbance {
    /// No datagram reaches the robot between these times.
    UpCut(u64, u64),
    /// No datagram reaches the station between these times.
    DownCut(u64, u64),
    /// The robot's server restarts at this time.
    RobotStarts(u64),
    /// One of this number of datagrams is lost.
    Losses(u64),
}

/// A link and its disturbances.
#[derive(Debug, Clone)]
pub struct LinkSetup {
    /// Profile of the link on both sides.
    pub profile: Profile,
    /// Delay of each datagram.
    pub one_way: Duration,
    /// Disturbances, all before the link is stable for good.
    pub disturbances: Vec<Disturbance>,
}

impl LinkSetup {
    /// Time until the link is stable for good: a few exchanges.
    pub fn disturbed(&self) -> Duration {
        self.one_way * 20 + self.profile.status_every * 20
    }

    fn is_cut(&self, now: Duration, is_up: bool) -> bool {
        let percent = now.as_millis() * 100 / self.disturbed().as_millis();
        self.disturbances.iter().any(|disturbance| match disturbance {
            Disturbance::UpCut(from, to) => {
                is_up && (u128::from(*from)..u128::from(*to)).contains(&percent)
            }
            Disturbance::DownCut(from, to) => {
                !is_up && (u128::from(*from)..u128::from(*to)).contains(&percent)
            }
            Disturbance::RobotStarts(_) | Disturbance::Losses(_) => false,
        })
    }

    fn is_lost(&self, now: Duration, number: u64, is_up: bool) -> bool {
        let is_one = |disturbance: &Disturbance| matches!(disturbance, Disturbance::Losses(of) if number.is_multiple_of(*of));
        self.is_cut(now, is_up) || now < self.disturbed() && self.disturbances.iter().any(is_one)
    }
}

/// A station and a robot on both sides of the link, in virtual time.
pub struct DisturbedLink {
    link: LinkSetup,
    /// Time of the simulation, which is the station's.
    pub now: Duration,
    /// Datagrams in flight by direction: time of arrival, and bytes.
    up: VecDeque<(Duration, Vec<u8>)>,
    down: VecDeque<(Duration, Vec<u8>)>,
    /// Number of datagrams sent.
    sent: u64,
    /// The session of the station.
    pub station: StationSession,
    robot: RobotSession,
    robot_began: Duration,
    robot_starts: u32,
    robot_heard: Option<Horizon>,
    /// Bytes of the commands sent.
    given: BTreeMap<CommandId, Vec<u8>>,
    /// The robot's journal: number of executions of each command.
    pub carried_out: BTreeMap<CommandId, u32>,
    /// The last state of each command as the station received it.
    pub fates: BTreeMap<CommandId, CommandState>,
    /// Commands that were overdue at any time.
    pub overdue: BTreeSet<CommandId>,
}

impl fmt::Debug for DisturbedLink {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { link, now, .. } = self;
        f.debug_struct("DisturbedLink")
            .field("link", link)
            .field("now", now)
            .finish_non_exhaustive()
    }
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

impl DisturbedLink {
    /// A station and a robot that start now.
    pub fn new(link: LinkSetup) -> Self {
        let start = SenderStart::new(1, 0);
        let identity =
            Identity { key_id: KeyId(1), key: &key(), robot: "scout", start, heard: None };
        Self {
            now: Duration::ZERO,
            up: VecDeque::new(),
            down: VecDeque::new(),
            sent: 0,
            station: StationSession::new(&identity, link.profile.clone()),
            robot: robot_session(&link.profile, 1, None),
            robot_began: Duration::ZERO,
            robot_starts: 1,
            robot_heard: None,
            given: BTreeMap::new(),
            carried_out: BTreeMap::new(),
            fates: BTreeMap::new(),
            overdue: BTreeSet::new(),
            link,
        }
    }

    /// Time of the robot's session.
    fn robot_time(&self) -> SessionTime {
        SessionTime::after(self.now.saturating_sub(self.robot_began))
    }

    /// Time of the station's session.
    pub fn station_time(&self) -> SessionTime {
        SessionTime::after(self.now)
    }

    /// Restarts the robot's server.
    pub fn restart_robot(&mut self) {
        (self.robot_starts, self.robot_began) = (self.robot_starts + 1, self.now);
        self.robot = robot_session(&self.link.profile, self.robot_starts, self.robot_heard);
    }

    /// Executes a command on the robot, and records it in the journal.
    fn do_command(&mut self, command: &ReceivedCommand) {
        let local = self.robot_time();
        assert_eq!(self.given.get(&command.id), Some(&command.body), "another body");
        let is_done = self.carried_out.contains_key(&command.id);
        if !command.is_late && !is_done {
            assert!(local.as_millis() <= command.not_after_ms, "carried out late");
            *self.carried_out.entry(command.id).or_default() += 1;
        }
        if self.carried_out.contains_key(&command.id) {
            self.robot.set_command_state(local, command.id, CommandState::Done, "");
        }
    }

    /// Sends a command from the station, if possible.
    pub fn command(&mut self, command: NewCommand) -> Result<(), NotSent> {
        self.given.insert(command.id, command.body.clone());
        self.station.command(self.station_time(), command)
    }

    /// Advances to this time in steps of due events. Panics if the robot executes a command late, or one that was never
    /// sent.
    pub fn go_on(&mut self, until: Duration) {
        while self.now < until {
            let (local, station_time) = (self.robot_time(), self.station_time());
            while let Some(datagram) =
                self.robot.poll_transmit(local, &mut NoRuns).expect("numbers")
            {
                self.sent += 1;
                if !self.link.is_lost(self.now, self.sent, false) {
                    self.down.push_back((self.now + self.link.one_way, datagram));
                }
            }
            while let Some(datagram) = self.station.poll_transmit(station_time).expect("numbers") {
                self.sent += 1;
                if !self.link.is_lost(self.now, self.sent, true) {
                    self.up.push_back((self.now + self.link.one_way, datagram));
                }
            }
            self.overdue.extend(self.station.take_overdue(station_time));
            let due = [
                self.robot.poll_timeout(local).map(|at| at + self.robot_began),
                self.station.poll_timeout(station_time),
            ];
            let due = due.map(|at| at.map(|at| at.since(SessionTime::BEGIN)));
            let arrivals = [&self.up, &self.down].map(|way| way.front().map(|(at, _)| *at));
            let next = due.into_iter().chain(arrivals).flatten().min();
            self.now = next.unwrap_or(until).max(self.now + Duration::from_millis(1)).min(until);
            self.arrive();
        }
    }

    fn arrive(&mut self) {
        let (local, station_time) = (self.robot_time(), self.station_time());
        while let Some((_, mut datagram)) = self.up.pop_front_if(|(at, _)| *at <= self.now) {
            let mut commands = Vec::new();
            let _of_an_earlier_start =
                self.robot.handle_datagram(local, &mut datagram, |command| commands.push(command));
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
            let _of_an_earlier_start =
                self.station.handle_datagram(station_time, &mut datagram, show);
        }
    }

    /// Panics if the station received a fate that differs from the robot's journal, or a command was executed twice.
    pub fn check_fates(&self) {
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
