//! How the link to the station is, as the robot knows it.

use super::RobotSettings;
use crate::ids;
use crate::report::{Rate, traffic};
use rafcon_link::{Profile, RobotSession};
use rafcon_protocol::{LinkHealth, LinkReport, LinkRun};
use rafcon_supervisor::clock;
use std::time::Duration;

/// What is measured of the link to the station.
#[derive(Debug)]
pub(super) struct RobotHealth {
    robot: String,
    profile: Profile,
    down: Rate,
    up: Rate,
    unusable: u64,
    unusable_because: Option<String>,
}

impl RobotHealth {
    pub(super) fn new(settings: &RobotSettings) -> Self {
        let (robot, profile) = (settings.pairing.robot.clone(), settings.profile.clone());
        let (down, up) = (Rate::default(), Rate::default());
        Self { robot, profile, down, up, unusable: 0, unusable_because: None }
    }

    /// A datagram could not be used.
    pub(super) fn note_unusable(&mut self, why: String) {
        self.unusable += 1;
        self.unusable_because = Some(why);
    }

    /// How the link is, what was sent and received, and these runs.
    pub(super) fn report<'r>(
        &mut self,
        session: &RobotSession,
        now: Duration,
        runs: impl Iterator<Item = &'r str>,
    ) -> LinkReport {
        let (sent, received) = session.traffic();
        self.down.note(now, sent.bytes);
        self.up.note(now, received.bytes);
        let runs: Vec<_> = runs.filter_map(|id| run(session, id)).collect();
        let (today, before) = (clock::since_1970_ms(), session.heard_before(now));
        let health = LinkHealth {
            robot: self.robot.clone(),
            is_heard: before.is_some_and(|before| before < self.profile.silence()),
            heard_ms: before.map(|before| today.saturating_sub(millis(before))),
            expected_every_ms: millis(self.profile.report_idle_every()),
            down_bytes_per_s: self.down.per_s,
            up_bytes_per_s: self.up.per_s,
            missing: runs.iter().map(|run| run.missing).sum(),
            ..LinkHealth::default()
        };
        LinkReport {
            is_station: false,
            profile: self.profile.name.to_owned(),
            now_ms: today,
            health,
            sent: traffic(sent),
            received: traffic(received),
            unusable: self.unusable,
            unusable_because: self.unusable_because.clone(),
            runs,
        }
    }
}

fn run(session: &RobotSession, id: &str) -> Option<LinkRun> {
    let (head, missing) = session.progress(ids::events_of(id))?;
    Some(LinkRun { id: id.to_owned(), head, missing })
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
