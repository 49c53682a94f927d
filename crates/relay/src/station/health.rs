//! How the link to one robot is, as its station knows it.

use crate::ids;
use crate::report::{Rate, traffic};
use rafcon_link::{Profile, StationSession};
use rafcon_protocol::{ClockOffset, LinkHealth, LinkReport, LinkRun};
use rafcon_supervisor::clock;
use std::time::Duration;

/// What is measured of the link to one robot.
#[derive(Debug)]
pub(super) struct StationHealth {
    robot: String,
    profile: Profile,
    down: Rate,
    up: Rate,
    unusable: u64,
    unusable_because: Option<String>,
}

impl StationHealth {
    pub(super) fn new(robot: &str, profile: &Profile) -> Self {
        let (robot, profile) = (robot.to_owned(), profile.clone());
        let (down, up) = (Rate::default(), Rate::default());
        Self { robot, profile, down, up, unusable: 0, unusable_because: None }
    }

    /// A datagram could not be used.
    pub(super) fn note_unusable(&mut self, why: String) {
        self.unusable += 1;
        self.unusable_because = Some(why);
    }

    /// How the link is; events are counted by whoever knows the runs.
    pub(super) fn of(&mut self, session: &StationSession, now: Duration) -> LinkHealth {
        let (sent, received) = session.traffic();
        self.down.note(now, received.bytes);
        self.up.note(now, sent.bytes);
        let (today, before) = (clock::since_1970_ms(), session.heard_before(now));
        let ago = |time: Duration| today.saturating_sub(millis(time));
        let calendar = session.robot_calendar(now);
        let offset = |robot_ms: u64| robot_ms.cast_signed() - today.cast_signed();
        LinkHealth {
            robot: self.robot.clone(),
            is_heard: before.is_some_and(|before| before < self.profile.silence()),
            heard_ms: before.map(ago),
            expected_every_ms: millis(self.profile.status_every),
            reached_ms: session.reached_before(now).map(ago),
            round_trip_ms: session.round_trip().map(millis),
            down_bytes_per_s: self.down.per_s,
            up_bytes_per_s: self.up.per_s,
            missing: 0,
            commands: Vec::new(),
            clock: calendar.map(|(least, most)| ClockOffset {
                least_ms: offset(least),
                most_ms: most.map(offset),
            }),
        }
    }

    /// The same, and what was sent and received, of these runs.
    pub(super) fn report<'r>(
        &mut self,
        session: &StationSession,
        now: Duration,
        runs: impl Iterator<Item = &'r str>,
    ) -> LinkReport {
        let runs: Vec<_> = runs.map(|id| run(session, id)).collect();
        let (sent, received) = session.traffic();
        let (sent, received) = (traffic(sent), traffic(received));
        let missing = runs.iter().map(|run| run.missing).sum();
        LinkReport {
            is_station: true,
            profile: self.profile.name.to_owned(),
            now_ms: clock::since_1970_ms(),
            health: LinkHealth { missing, ..self.of(session, now) },
            sent,
            received,
            unusable: self.unusable,
            unusable_because: self.unusable_because.clone(),
            runs,
        }
    }
}

/// What the station knows of a run.
pub(super) fn run(session: &StationSession, id: &str) -> LinkRun {
    let progress = session.progress(ids::events_of(id));
    let (head, missing) =
        progress.map_or((0, 0), |(head, here)| (head, head.saturating_sub(here.count())));
    LinkRun { id: id.to_owned(), head, missing }
}

pub(super) fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
