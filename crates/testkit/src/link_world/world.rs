//! The world: it delivers datagrams and events in time, and checks all invariants after every step.

use super::carrier::{Carrier, Conditions, Cut, DELAY};
use super::clock::LocalClock;
use super::measures::Measures;
use super::mission::Mission;
use super::plan::{Action, LATE, Plan, STATIONS, Scenario, Window};
use super::robot::{CarriedOut, Robot};
use super::station::Station;
use super::watching::Operators;
use crate::random::Random;
use rafcon_link::{CommandId, NewCommand, Profile, Traffic};
use std::collections::BTreeMap;
use std::time::Duration;

/// A view is live if it includes all events up to this age, in addition to the delay.
const LIVE: Duration = Duration::from_millis(150);
/// Period after a cut that does not count as a whole link.
const RECOVERY: Duration = Duration::from_secs(15);
/// Interval at which groups of events reach the robot's server.
const GROUP: Duration = Duration::from_millis(5);
const TICK: Duration = Duration::from_secs(1);

/// Runs the world of a seed. Returns its measurements, or the first broken invariant.
pub fn run(seed: u64, scenario: Scenario) -> Result<Measures, String> {
    let mut world = LinkWorld::new(seed, scenario);
    world.go().map_err(|broken| format!("seed {seed}, at {:?}: {broken}", world.now))?;
    let measures = world.measures;
    Ok(match scenario {
        Scenario::SpaceBotCamp => measures,
        // Its links are rarely whole; only losses, late commands and repeated commands count.
        Scenario::Kills => {
            let Measures { missing, extra, different, late_or_twice, commands, kills, .. } =
                measures;
            Measures {
                missing,
                extra,
                different,
                late_or_twice,
                commands,
                kills,
                ..Measures::default()
            }
        }
    })
}

/// Bytes between the first station and the robot in a mission that this number of operators watch.
pub fn run_watched(seed: u64, operators: usize) -> Result<u64, String> {
    let mut world = LinkWorld::new(seed, Scenario::SpaceBotCamp);
    let joins = Operators::join_at(operators).map(|at| (at, Action::Watch));
    world.plan.actions.extend(joins);
    world.plan.actions.sort_by_key(|(at, _)| *at);
    world.go().map_err(|broken| format!("seed {seed}, at {:?}: {broken}", world.now))?;
    Ok(world.down[0].bytes + world.up[0].bytes)
}

struct LinkWorld {
    now: Duration,
    random: Random,
    profile: Profile,
    plan: Plan,
    next_action: usize,
    mission: Mission,
    head: u64,
    robot: Robot,
    stations: Vec<Station>,
    /// Carriers to each station.
    down: Vec<Carrier>,
    /// Carriers from each station.
    up: Vec<Carrier>,
    given: BTreeMap<CommandId, Given>,
    in_control: usize,
    epoch: u64,
    robot_epoch: u64,
    /// The event of the state that the first station shows.
    seen: u64,
    returns: Vec<Waited>,
    late_joined: Option<Duration>,
    fills: Vec<Fill>,
    tick: Tick,
    measures: Measures,
    operators: Operators,
}

struct Given {
    at: Duration,
    until: Duration,
    epoch: u64,
    carried_out: bool,
}

/// Set after a cut until the first station is live.
struct Waited {
    since: Duration,
}

/// Set after the long cut until the replica of the first station is complete.
struct Fill {
    since: Duration,
    until: u64,
    bar: Duration,
}

/// Traffic to the first station up to a full second.
struct Tick {
    at: Duration,
    bytes: u64,
    traffic: Traffic,
    head: u64,
}

impl LinkWorld {
    fn new(seed: u64, scenario: Scenario) -> Self {
        let mut random = Random::new(seed);
        let plan = Plan::new(scenario, &mut random);
        let profile = Profile::DELAY_2S;
        let mut fork = || random.below(usize::MAX) as u64;
        let mission = Mission::new(Random::new(fork()), plan.length, plan.quiet);
        let carrier = |bits_per_s, seed| Carrier::new(Conditions::delay_2s(bits_per_s), seed);
        let mut down: Vec<_> =
            (0..=STATIONS).map(|_| carrier(profile.down_bits_per_s, fork())).collect();
        let mut up: Vec<_> =
            (0..STATIONS).map(|_| carrier(profile.up_bits_per_s, fork())).collect();
        for (window, cut) in &plan.cuts {
            for carrier in &mut down {
                carrier.cut(window.from, window.to, Cut::Drops);
            }
            for carrier in &mut up {
                carrier.cut(window.from, window.to, *cut);
            }
        }
        for window in &plan.one_way {
            for carrier in &mut up {
                carrier.cut(window.from, window.to, Cut::Drops);
            }
        }
        Self {
            now: Duration::ZERO,
            profile,
            plan,
            next_action: 0,
            mission,
            head: 0,
            robot: Robot::new(STATIONS),
            stations: [0, 1, 0].map(Station::new).into(),
            down,
            up,
            given: BTreeMap::new(),
            in_control: 0,
            epoch: 1,
            robot_epoch: 1,
            seen: 0,
            returns: Vec::new(),
            late_joined: None,
            fills: Vec::new(),
            tick: Tick { at: Duration::ZERO, bytes: 0, traffic: Traffic::default(), head: 0 },
            measures: Measures::default(),
            operators: Operators::default(),
            random,
        }
    }

    fn go(&mut self) -> Result<(), String> {
        let end = self.plan.length + Duration::from_mins(5);
        while self.now < end && !self.is_over() {
            self.step()?;
        }
        for station in &self.stations[..STATIONS] {
            let replica = &station.disk.events;
            self.measures.missing += self.head - replica.contiguous();
            let last = replica.ranges().next_back().map_or(0, |range| *range.end());
            self.measures.extra += last.saturating_sub(self.head);
        }
        self.measures.different += self.stations.iter().map(|it| it.different).sum::<u64>();
        match self.measures {
            Measures { missing: 0, extra: 0, different: 0, late_or_twice: 0, .. } => Ok(()),
            _ => Err(format!(
                "{} events are missing, {} too many, {} different; {} commands late or twice",
                self.measures.missing,
                self.measures.extra,
                self.measures.different,
                self.measures.late_or_twice
            )),
        }
    }

    fn is_over(&self) -> bool {
        let is_complete = |station: &Station| station.disk.events.contiguous() >= self.head;
        self.now > self.plan.length + GROUP && self.stations[..STATIONS].iter().all(is_complete)
    }

    fn step(&mut self) -> Result<(), String> {
        self.now = self.next();
        while let Some((_, action)) = self.plan.actions.get(self.next_action).copied()
            && self.plan.actions[self.next_action].0 <= self.now
        {
            self.next_action += 1;
            self.act(action);
        }
        if self.mission.time(self.head + 1).is_some_and(|at| at + GROUP <= self.now) {
            self.head = self.mission.head(self.now);
        }
        let is_over = self.now >= self.plan.length + GROUP;
        self.robot.follow(self.now, &self.mission, self.head, is_over);
        self.deliver();
        self.send()?;
        self.count();
        self.check()
    }

    fn next(&self) -> Duration {
        let action = self.plan.actions.get(self.next_action).map(|(at, _)| *at);
        let stations = self.stations.iter().map(|station| station.next(self.now));
        let robot = (0..STATIONS).map(|station| self.robot.next(self.now, station));
        let carriers = self.down.iter().chain(&self.up).map(Carrier::next);
        let event = self.mission.time(self.head + 1).map(|at| at + GROUP);
        let length = self.plan.length + GROUP;
        let end = (self.now < length).then_some(length);
        let others = [action, event, end, Some(self.tick.at + TICK)];
        let next = stations.chain(robot).chain(carriers).chain(others).flatten().min();
        next.unwrap_or(self.tick.at + TICK).max(self.now)
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::StartRobot => {
                let clock = self.clock();
                self.robot.start(clock, &self.profile, self.head);
            }
            Action::KillRobot => {
                self.measures.kills += 1;
                self.robot.kill();
            }
            Action::StartStation(station) => {
                let clock = self.clock();
                self.stations[station].start(clock, &self.profile);
                if station == 0 {
                    self.operators.ask_again();
                    self.ask();
                }
                if station == LATE {
                    self.late_joined = Some(self.now);
                }
            }
            Action::KillStation(station) => {
                self.measures.kills += 1;
                self.stations[station].kill();
            }
            Action::FillDisk(station) => self.stations[station].disk.is_full = true,
            Action::FreeDisk(station) => self.stations[station].disk.is_full = false,
            Action::SetCalendar(ms) => self.robot.calendar.jump(self.now, ms),
            Action::Watch => {
                self.operators.join(&self.mission.branches);
                self.ask();
            }
            Action::Command => self.command(self.in_control),
            Action::TakeControl => {
                self.in_control = 1 - self.in_control;
                self.epoch += 1;
                self.command(self.in_control);
            }
        }
    }

    /// The clock of a process that starts now.
    fn clock(&mut self) -> LocalClock {
        LocalClock::new(self.now, self.random.small(100) - 50)
    }

    fn ask(&mut self) {
        if self.stations[0].server.is_some()
            && let Some((number, body)) = self.operators.wish()
        {
            self.stations[0].watch(number, body);
        }
    }

    fn command(&mut self, station: usize) {
        let mut id = [0; 16];
        id[..8].copy_from_slice(&(self.given.len() as u64).to_be_bytes());
        let id = CommandId(id);
        let valid = Duration::from_secs([3, 8, 30, 120][self.random.below(4)]);
        let command =
            NewCommand { id, valid, wait: None, epoch: self.epoch, body: b"hold".to_vec() };
        if self.stations[station].command(self.now, command) {
            let until = self.now + valid;
            let given = Given { at: self.now, until, epoch: self.epoch, carried_out: false };
            self.given.insert(id, given);
        }
    }

    fn deliver(&mut self) {
        for station in 0..self.down.len() {
            while let Some(datagram) = self.down[station].arrive(self.now) {
                self.stations[station].receive(self.now, &self.mission, datagram);
            }
        }
        for station in 0..STATIONS {
            while let Some(datagram) = self.up[station].arrive(self.now) {
                for done in self.robot.receive(self.now, station, datagram) {
                    self.carried_out(done);
                }
            }
        }
    }

    fn carried_out(&mut self, CarriedOut { id, epoch }: CarriedOut) {
        let now = self.now;
        self.measures.commands += 1;
        let is_whole = self.is_whole(now, DELAY + TICK);
        let is_obsolete = epoch < self.robot_epoch;
        self.robot_epoch = self.robot_epoch.max(epoch);
        let Some(given) = self.given.get_mut(&id) else {
            self.measures.late_or_twice += 1;
            return;
        };
        let is_wrong = given.carried_out || now > given.until || given.epoch != epoch;
        self.measures.late_or_twice += u64::from(is_wrong || is_obsolete);
        given.carried_out = true;
        if is_whole {
            self.measures.hold.push(now.saturating_sub(given.at + DELAY));
        }
    }

    fn send(&mut self) -> Result<(), String> {
        for station in 0..STATIONS {
            while let Some(datagram) = self.robot.transmit(self.now, station, &self.mission)? {
                if station == 0 && self.stations[LATE].server.is_some() {
                    self.down[LATE].send(self.now, datagram.clone());
                }
                self.down[station].send(self.now, datagram);
            }
            if self.robot.next(self.now, station).is_some_and(|next| next <= self.now) {
                return Err(format!("the robot has nothing to send to station {station}, at once"));
            }
        }
        for station in 0..self.stations.len() {
            while let Some(datagram) = self.stations[station].transmit(self.now)? {
                if let Some(up) = self.up.get_mut(station) {
                    up.send(self.now, datagram);
                }
            }
            if self.stations[station].next(self.now).is_some_and(|next| next <= self.now) {
                return Err(format!("station {station} has nothing to send, at once"));
            }
        }
        Ok(())
    }

    /// True if both directions are whole and the servers run, and this has been so for a while and remains so for `after`.
    fn is_whole(&self, time: Duration, after: Duration) -> bool {
        self.is_whole_down(time, after)
            && !self.plan.one_way.iter().any(|it| it.wider(after, RECOVERY).has(time))
    }

    fn is_whole_down(&self, time: Duration, after: Duration) -> bool {
        let cuts = self.plan.cuts.iter().map(|(window, _)| window);
        let down = self.plan.down.iter().map(|(window, _)| window);
        let start = Window { from: Duration::ZERO, to: RECOVERY };
        !cuts.chain(down).chain([&start]).any(|it| it.wider(after, RECOVERY).has(time))
    }

    fn count(&mut self) {
        let view = self.stations[0].server.as_ref().map_or(0, |server| server.view);
        for sequence in self.seen + 1..=view {
            let Some(at) = self.mission.time(sequence) else { continue };
            let latency = self.now.saturating_sub(at).saturating_sub(DELAY);
            if self.is_whole(at, DELAY) {
                self.measures.latency.push(latency);
            }
            let without = self.plan.one_way.iter().any(|it| it.has(at));
            if without && self.is_whole_down(at, DELAY) {
                self.measures.one_way_latency.push(latency);
            }
        }
        self.seen = self.seen.max(view);
        let expected = self.mission.head(self.now.saturating_sub(DELAY + LIVE));
        if view >= expected {
            let now = self.now;
            for Waited { since } in self.returns.extract_if(.., |it| it.since + DELAY <= now) {
                self.measures.live_after_return.push(now.saturating_sub(since + DELAY));
            }
        }
        let late = self.stations[LATE].server.as_ref().map_or(0, |server| server.view);
        if let Some(since) = self.late_joined.filter(|_| late > 0 && late >= expected) {
            self.measures.late_joiner.push(self.now.saturating_sub(since + DELAY));
            self.late_joined = None;
        }
        let contiguous = self.stations[0].contiguous();
        for fill in self.fills.extract_if(.., |fill| contiguous >= fill.until) {
            self.measures.backfill.push((self.now.saturating_sub(fill.since), fill.bar));
        }
        if self.tick.at + TICK <= self.now {
            self.count_second();
        }
    }

    fn count_second(&mut self) {
        let second = Window { from: self.tick.at, to: self.tick.at + TICK };
        let bytes = self.down[0].bytes - self.tick.bytes;
        let traffic = self.robot.sent(0);
        let quiet = self.plan.quiet;
        if self.is_whole(second.from, DELAY) && !quiet.wider(TICK, TICK).has(second.from) {
            self.measures.bytes += bytes;
            self.measures.add_traffic(&traffic, &self.tick.traffic);
            self.measures.events += self.head - self.tick.head;
        }
        let idle = quiet.from + TICK * 20..quiet.to.saturating_sub(TICK * 2);
        if idle.contains(&second.from) {
            self.measures.idle_bits += bytes * 8;
            self.measures.idle += TICK;
        }
        let ended = self.plan.cuts.iter().filter(|(cut, _)| second.has(cut.to));
        for (cut, _) in ended {
            self.returns.push(Waited { since: cut.to });
            if cut.from + Duration::from_mins(10) < cut.to {
                let until = self.mission.head(cut.to);
                let from = self.stations[0].contiguous() + 1;
                let bits = self.mission.items(from.min(until), until).1.len() as u64 * 8;
                let takes = Duration::from_millis(bits * 1_150 / self.profile.down_bits_per_s);
                let bar = takes + DELAY * 2 + TICK;
                self.fills.push(Fill { since: cut.to, until, bar });
            }
        }
        let bytes = self.down[0].bytes;
        self.tick = Tick { at: second.to, bytes, traffic, head: self.head };
    }

    fn check(&self) -> Result<(), String> {
        for (number, station) in self.stations.iter().enumerate() {
            if station.different > 0 {
                return Err(format!("station {number} received an event with other bytes"));
            }
            let view = station.server.as_ref().map_or(0, |server| server.view);
            if view > self.head {
                return Err(format!("station {number} shows event {view} of {}", self.head));
            }
            if !station.knows_its_disk() {
                return Err(format!("station {number} lacks what is on its disk"));
            }
            self.check_calendar(number, station)?;
        }
        if self.measures.late_or_twice > 0 {
            return Err("a command was carried out late, twice, or under an old epoch".to_owned());
        }
        Ok(())
    }
    /// Checks that the robot's calendar is, or was recently, within the bounds that a station knows.
    fn check_calendar(&self, number: usize, station: &Station) -> Result<(), String> {
        let Some((start, earliest, latest)) = station.robot_calendar(self.now) else {
            return Ok(());
        };
        if start != self.robot.starts() {
            return Ok(());
        }
        let now = u64::try_from(self.now.as_millis()).unwrap_or_default();
        // Clocks run at different rates; the calendar follows the world.
        let drift = 2 + now / 10_000;
        let settings = &self.robot.calendar.settings;
        // On a whole link, the station soon knows the current calendar.
        let is_whole = self.is_whole(self.now, DELAY);
        let old = settings.partition_point(|(at, _)| is_whole && *at + RECOVERY < self.now);
        let lately = old.max(1) - 1;
        let is_so = |(_, more): &(Duration, u64)| {
            let calendar = more + now;
            earliest <= calendar + drift && latest.is_none_or(|latest| calendar <= latest + drift)
        };
        if settings[lately..].iter().any(is_so) {
            return Ok(());
        }
        Err(format!(
            "station {number} takes the robot's calendar to be from {earliest} to {latest:?}, and it is {}",
            settings.last().map_or(0, |(_, more)| more + now)
        ))
    }
}
