//! Timed events of the world of a seed.

use super::carrier::Cut;
use crate::random::Random;
use std::time::Duration;

/// A kind of world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scenario {
    /// An hour on a link of 2 s: cuts of 90 s and of 12 minutes, half of the time without an up-link.
    SpaceBotCamp,
    /// Ten minutes in which servers die again and again.
    Kills,
}

/// A period of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) from: Duration,
    pub(super) to: Duration,
}

impl Window {
    pub(super) fn new(from: u64, length: u64) -> Self {
        let from = Duration::from_millis(from);
        Self { from, to: from + Duration::from_millis(length) }
    }

    pub(super) fn has(&self, time: Duration) -> bool {
        (self.from..self.to).contains(&time)
    }

    /// The window extended in both directions.
    pub(super) fn wider(self, before: Duration, after: Duration) -> Self {
        Self { from: self.from.saturating_sub(before), to: self.to + after }
    }
}

/// A single event in the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    StartRobot,
    KillRobot,
    StartStation(usize),
    KillStation(usize),
    /// The operator at the station in control sends a command.
    Command,
    /// The other station takes control.
    TakeControl,
    /// The disk of a station is full.
    FillDisk(usize),
    /// It has room again.
    FreeDisk(usize),
    /// The robot's calendar jumps by this many ms, forward or back.
    SetCalendar(i64),
    /// Another operator of the first station watches the mission.
    Watch,
}

#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) length: Duration,
    /// Period without events in the mission.
    pub(super) quiet: Window,
    /// Cuts of the link in both directions, with the fate of datagrams that are sent up meanwhile.
    pub(super) cuts: Vec<(Window, Cut)>,
    /// Periods without an up-link.
    pub(super) one_way: Vec<Window>,
    /// Periods in which a server is down, with the number of the station, or `None` for the robot.
    pub(super) down: Vec<(Window, Option<usize>)>,
    /// Periods in which the disk of a station is full.
    pub(super) full: Vec<(Window, usize)>,
    pub(super) actions: Vec<(Duration, Action)>,
}

/// Number of stations with an up-link. One more station joins late and has none.
pub(super) const STATIONS: usize = 2;
pub(super) const LATE: usize = 2;

impl Plan {
    pub(super) fn new(scenario: Scenario, random: &mut Random) -> Self {
        let mut plan = match scenario {
            Scenario::SpaceBotCamp => Self::space_bot_camp(random),
            Scenario::Kills => Self::kills(random),
        };
        plan.add_full_disks(random);
        plan.add_calendar_jumps(random);
        plan.actions.push((Duration::ZERO, Action::StartRobot));
        plan.actions.extend((0..STATIONS).map(|it| (Duration::ZERO, Action::StartStation(it))));
        plan.actions.sort_by_key(|(at, _)| *at);
        plan
    }

    /// Fills the disk of a station occasionally. No server starts meanwhile, because it could not store the number of its
    /// start.
    fn add_full_disks(&mut self, random: &mut Random) {
        let length = usize::try_from(self.length.as_millis()).unwrap_or_default();
        for _ in 0..6 {
            let station = random.below(STATIONS);
            let full = Window::new(random.below(length) as u64, 500 + random.below(60_000) as u64);
            let starts = self
                .actions
                .iter()
                .any(|(at, action)| *action == Action::StartStation(station) && full.has(*at));
            let others = self
                .full
                .iter()
                .any(|(other, at)| *at == station && other.from < full.to && full.from < other.to);
            if !starts && !others {
                self.full.push((full, station));
                self.actions.push((full.from, Action::FillDisk(station)));
                self.actions.push((full.to, Action::FreeDisk(station)));
            }
        }
    }

    /// Lets the robot's calendar jump occasionally: by moments, or by days.
    fn add_calendar_jumps(&mut self, random: &mut Random) {
        let length = usize::try_from(self.length.as_millis()).unwrap_or_default();
        for _ in 0..8 {
            let far = [500, 60_000, 90_000_000][random.below(3)];
            let jump = random.small(far) - random.small(far);
            let at = Duration::from_millis(random.below(length) as u64);
            self.actions.push((at, Action::SetCalendar(jump)));
        }
    }

    fn space_bot_camp(random: &mut Random) -> Self {
        let mut between = |from: usize, to: usize| (from + random.below(to - from)) as u64;
        let first = Window::new(between(120_000, 300_000), 90_000);
        let second = Window::new(between(1_400_000, 1_600_000), 720_000);
        let first_one_way = Window::new(between(420_000, 480_000), 900_000);
        let second_one_way = Window::new(between(2_400_000, 2_480_000), 900_000);
        let robot = Window::new(between(0, 60_000), between(1_000, 20_000));
        let robot = Window { from: first.from + robot.from, to: first.from + robot.to };
        let station = Window::new(between(0, 600_000), between(1_000, 60_000));
        let station = Window { from: second.from + station.from, to: second.from + station.to };
        let late = second_one_way.from + Duration::from_millis(between(10_000, 600_000));
        let mut actions = vec![
            (robot.from, Action::KillRobot),
            (robot.to, Action::StartRobot),
            (station.from, Action::KillStation(0)),
            (station.to, Action::StartStation(0)),
            (late, Action::StartStation(LATE)),
            (Duration::from_millis(between(1_380_000, 1_400_000)), Action::TakeControl),
            // Place the cut in the middle of it.
            (first.from.saturating_sub(Duration::from_millis(between(0, 4_000))), Action::Command),
        ];
        let mut at = 20_000;
        while at < 3_550_000 {
            actions.push((Duration::from_millis(at), Action::Command));
            at += between(4_000, 30_000);
        }
        let mut cut = || if between(0, 2) == 0 { Cut::Drops } else { Cut::Holds };
        Self {
            length: Duration::from_hours(1),
            quiet: Window::new(3_420_000, 120_000),
            cuts: vec![(first, cut()), (second, cut())],
            one_way: vec![first_one_way, second_one_way],
            down: vec![(robot, None), (station, Some(0))],
            full: Vec::new(),
            actions,
        }
    }

    fn kills(random: &mut Random) -> Self {
        let mut between = |from: usize, to: usize| (from + random.below(to - from)) as u64;
        let (mut actions, mut down, mut cuts, mut at) = (Vec::new(), Vec::new(), Vec::new(), 5_000);
        while at < 580_000 {
            let time = Window::new(at, between(100, 6_000));
            let who = match between(0, 3) {
                0 => None,
                1 => Some(0),
                _ => Some(1),
            };
            let (kill, start) = match who {
                None => (Action::KillRobot, Action::StartRobot),
                Some(it) => (Action::KillStation(it), Action::StartStation(it)),
            };
            actions.extend([(time.from, kill), (time.to, start)]);
            down.push((time, who));
            if between(0, 4) == 0 {
                let cut = if between(0, 2) == 0 { Cut::Drops } else { Cut::Holds };
                cuts.push((Window::new(at + between(0, 2_000), between(200, 20_000)), cut));
            }
            at = at + 6_000 + between(0, 6_000);
        }
        let mut at = 3_000;
        while at < 590_000 {
            actions.push((Duration::from_millis(at), Action::Command));
            at += between(100, 3_000);
        }
        for _ in 0..4 {
            actions.push((Duration::from_millis(between(10_000, 590_000)), Action::TakeControl));
        }
        cuts.sort_by_key(|(cut, _)| cut.from);
        cuts.dedup_by(|next, cut| next.0.from < cut.0.to);
        Self {
            length: Duration::from_mins(10),
            quiet: Window::new(0, 0),
            cuts,
            one_way: Vec::new(),
            down,
            full: Vec::new(),
            actions,
        }
    }
}
