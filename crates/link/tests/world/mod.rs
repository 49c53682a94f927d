//! A robot with one run over a disturbed link, and its station, in virtual time.

use rafcon_link::{
    CommandId, EventBlock, EventBlockRef, FromRobot, Identity, KeyId, PairingKey, Profile,
    RobotSession, RunSource, SenderStart, SessionTime, StationSession, StreamId,
};
use rafcon_testkit::link_world::{Carrier, Conditions};
use std::collections::BTreeMap;
use std::time::Duration;

/// The run.
pub(crate) const RUN: StreamId = StreamId(1);

/// Bytes of the event with this number.
pub(crate) type Item = fn(u64) -> Vec<u8>;

struct Journal {
    item: Item,
}

impl RunSource for Journal {
    fn events(&mut self, _: StreamId, first: u64, last: u64, max: usize) -> Option<EventBlock> {
        let (mut items, mut count) = ((self.item)(first), 1);
        while first + count <= last {
            let next = (self.item)(first + count);
            if items.len() + next.len() > max {
                break;
            }
            (items, count) = ([items, next].concat(), count + 1);
        }
        Some(EventBlock { first_sequence: first, count, time_before: 0, bytes: items })
    }

    fn snapshot(&mut self, _: StreamId) -> Option<(u64, Vec<u8>)> {
        None
    }
}

/// A robot whose run has an event each `every`, and its station.
pub(crate) struct World {
    item: Item,
    every: Duration,
    pub(crate) now: Duration,
    pub(crate) robot: RobotSession,
    pub(crate) station: StationSession,
    pub(crate) down: Carrier,
    pub(crate) up: Carrier,
    pub(crate) head: u64,
    /// Delay of each event that arrived, with the time of the event.
    pub(crate) delays: Vec<(Duration, Duration)>,
    pub(crate) files: u64,
    /// Longest datagram that passes.
    pub(crate) carries: usize,
    pub(crate) carried_out: Vec<CommandId>,
}

impl World {
    pub(crate) fn new(
        profile: &Profile,
        (down, up): (Conditions, Conditions),
        every: Duration,
        item: Item,
    ) -> Self {
        let key = PairingKey::from_bytes([7; 32]);
        let (key_id, start) = (KeyId(1), SenderStart::new(1, 0));
        let identity = Identity { key_id, key: &key, robot: "scout", start, heard: None };
        let mut robot = RobotSession::new(&identity, profile.clone());
        robot.begin(RUN, 0);
        Self {
            item,
            every,
            now: Duration::ZERO,
            robot,
            station: StationSession::new(&identity, profile.clone()),
            down: Carrier::new(down, 1),
            up: Carrier::new(up, 2),
            head: 0,
            delays: Vec::new(),
            files: 0,
            carries: usize::MAX,
            carried_out: Vec::new(),
        }
    }

    /// The time of both sessions.
    pub(crate) fn session_time(&self) -> SessionTime {
        SessionTime::after(self.now)
    }

    /// Lets time pass.
    pub(crate) fn go_on(&mut self, until: Duration) {
        let mut journal = Journal { item: self.item };
        while self.now < until {
            self.now += Duration::from_millis(1);
            let now = self.session_time();
            while self.every * u32::try_from(self.head + 1).expect("few") <= self.now {
                self.head += 1;
                let items = (self.item)(self.head);
                let block = EventBlockRef {
                    first_sequence: self.head,
                    count: 1,
                    time_before: 0,
                    bytes: &items,
                };
                self.robot.append(RUN, block);
            }
            while let Some(datagram) = self.robot.poll_transmit(now, &mut journal).expect("room") {
                if datagram.len() <= self.carries {
                    self.down.send(self.now, datagram);
                }
            }
            while let Some(datagram) = self.station.poll_transmit(now).expect("room") {
                if datagram.len() <= self.carries {
                    self.up.send(self.now, datagram);
                }
            }
            while let Some(mut datagram) = self.up.arrive(self.now) {
                let all = &mut self.carried_out;
                let _doubled =
                    self.robot.handle_datagram(now, &mut datagram, |command| all.push(command.id));
            }
            while let Some(mut datagram) = self.down.arrive(self.now) {
                self.receive(&mut datagram);
            }
        }
    }

    /// The station receives a datagram.
    fn receive(&mut self, datagram: &mut [u8]) {
        let (now, every, delays, files) = (self.now, self.every, &mut self.delays, &mut self.files);
        let delay = |event| {
            let at = every * u32::try_from(event).expect("few");
            (at, now.saturating_sub(at))
        };
        let show = |shown: FromRobot<'_>| match shown {
            FromRobot::Events { stream: RUN, block } => {
                delays.extend(block.sequences().map(delay));
            }
            FromRobot::Events { block, .. } => *files += block.count,
            _ => {}
        };
        let _doubled = self.station.handle_datagram(SessionTime::after(now), datagram, show);
    }

    /// The longest delay of the 99 % fastest events of this time, beyond that of the link.
    pub(crate) fn p99(&self, from: Duration, to: Duration) -> Duration {
        self.quantile(990, from, to)
    }

    /// The longest delay of this share of the fastest events of this time, beyond that of the link. An event counts when it first arrived.
    pub(crate) fn quantile(&self, per_mille: usize, from: Duration, to: Duration) -> Duration {
        let mut delays = BTreeMap::new();
        for (at, delay) in self.delays.iter().filter(|(at, _)| (from..to).contains(at)) {
            delays.entry(*at).or_insert(*delay);
        }
        let mut delays: Vec<_> = delays.into_values().collect();
        delays.sort();
        delays[delays.len() * per_mille / 1_000].saturating_sub(self.down.conditions().delay)
    }
}
