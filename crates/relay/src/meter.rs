//! Measurements of one link and their report.

use crate::pairing::Pairing;
use crate::rights::PairingRights;
use rafcon_link::{Profile, SessionTime, Traffic};
use rafcon_protocol::{LinkHealth, LinkReport, LinkRun, LinkTraffic};
use rafcon_supervisor::clock;
use std::time::Duration;

/// Averaging period of rates.
const RATE_OVER: Duration = Duration::from_secs(2);

/// Measurements of one link.
#[derive(Debug)]
pub(crate) struct LinkMeter {
    robot: String,
    station: Option<String>,
    rights: PairingRights,
    profile: Profile,
    is_station: bool,
    down: Rate,
    up: Rate,
    unusable: u64,
    unusable_because: Option<String>,
}

impl LinkMeter {
    pub(crate) fn new(pairing: &Pairing, profile: &Profile, is_station: bool) -> Self {
        Self {
            robot: pairing.robot.clone(),
            station: pairing.station.clone(),
            rights: pairing.rights,
            profile: profile.clone(),
            is_station,
            down: Rate::default(),
            up: Rate::default(),
            unusable: 0,
            unusable_because: None,
        }
    }

    /// A datagram could not be used.
    pub(crate) fn note_unusable(&mut self, why: String) {
        self.unusable += 1;
        self.unusable_because = Some(why);
    }

    /// State of the link that both sides know of theirs: sent and received datagrams, and the time since the last datagram of
    /// the peer.
    pub(crate) fn health(
        &mut self,
        now: SessionTime,
        sent: &Traffic,
        received: &Traffic,
        heard_before: Option<Duration>,
    ) -> LinkHealth {
        let (down, up) = if self.is_station { (received, sent) } else { (sent, received) };
        self.down.note(now, down.bytes);
        self.up.note(now, up.bytes);
        let profile = &self.profile;
        let (expected, silence) = if self.is_station {
            (profile.status_every, profile.robot_silence())
        } else {
            (profile.report_idle_every(), profile.silence())
        };
        LinkHealth {
            robot: self.robot.clone(),
            is_heard: heard_before.is_some_and(|before| before < silence),
            heard_ms: heard_before
                .map(|before| clock::since_1970_ms().saturating_sub(millis(before))),
            expected_every_ms: millis(expected),
            down_bytes_per_s: self.down.per_s,
            up_bytes_per_s: self.up.per_s,
            // Until the robot is received, it may have another pairing than this station.
            rights: (!self.is_station || heard_before.is_some()).then(|| self.rights.into()),
            ..LinkHealth::default()
        }
    }

    /// The same with what was sent and received, and the runs.
    pub(crate) fn report(
        &self,
        health: LinkHealth,
        sent: &Traffic,
        received: &Traffic,
        runs: Vec<LinkRun>,
    ) -> LinkReport {
        let missing = runs.iter().map(|run| run.missing).sum();
        LinkReport {
            is_station: self.is_station,
            station: self.station.clone(),
            problems: Vec::new(),
            profile: self.profile.name.to_owned(),
            now_ms: clock::since_1970_ms(),
            health: LinkHealth { missing, ..health },
            send_bytes_per_s: None,
            sent: traffic(sent),
            received: traffic(received),
            unusable: self.unusable,
            unusable_because: self.unusable_because.clone(),
            runs,
        }
    }
}

/// Problem of a path that drops long datagrams.
pub(crate) fn shortened(datagrams: Option<usize>) -> Option<String> {
    let of = |bytes| {
        format!(
            "the path drops long datagrams: this side sends at most {bytes} bytes in one, which costs more of the rate; raise the MTU of the \
             path if you can"
        )
    };
    datagrams.map(of)
}

/// Rate in bytes per second.
#[derive(Debug, Default)]
struct Rate {
    at: SessionTime,
    bytes: u64,
    per_s: u64,
}

impl Rate {
    /// Adds a sample: bytes counted until now.
    fn note(&mut self, now: SessionTime, bytes: u64) {
        let time = now.since(self.at);
        if time >= RATE_OVER {
            let per_s = u128::from(bytes - self.bytes) * 1_000 / time.as_millis().max(1);
            self.per_s = u64::try_from(per_s).unwrap_or(u64::MAX);
            (self.at, self.bytes) = (now, bytes);
        }
    }
}

fn traffic(traffic: &Traffic) -> LinkTraffic {
    let Traffic { datagrams, bytes, by_kind } = traffic;
    let by_kind = by_kind.iter().map(|(kind, bytes)| ((*kind).to_owned(), *bytes)).collect();
    LinkTraffic { datagrams: *datagrams, bytes: *bytes, by_kind }
}

pub(crate) fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::LinkMeter;
    use crate::pairing::Pairing;
    use crate::rights::PairingRights;
    use rafcon_link::{Profile, SessionTime, Traffic};
    use rafcon_protocol::LinkRights;
    use std::time::Duration;

    #[test]
    fn a_side_is_heard_until_what_it_sends_regularly_is_missing() {
        let pairing = Pairing::generate("scout", None).expect("a name");
        let is_heard = |is_station, before| {
            let mut meter = LinkMeter::new(&pairing, &Profile::DELAY_2S, is_station);
            let (sent, received) = (Traffic::default(), Traffic::default());
            let before = Some(Duration::from_millis(before));
            meter.health(SessionTime::BEGIN, &sent, &received, before).is_heard
        };
        assert_eq!([3_999, 4_000].map(|before| is_heard(true, before)), [true, false]);
        assert_eq!([6_999, 7_000].map(|before| is_heard(false, before)), [true, false]);
    }

    #[test]
    fn the_rights_of_a_pairing_are_unknown_at_its_station_until_the_robot_is_received() {
        let pairing = Pairing::generate("scout", None).expect("a name");
        let pairing = Pairing { rights: PairingRights::Observe, ..pairing };
        let rights = |is_station, heard_before| {
            let mut meter = LinkMeter::new(&pairing, &Profile::DELAY_2S, is_station);
            let nothing = Traffic::default();
            meter.health(SessionTime::BEGIN, &nothing, &nothing, heard_before).rights
        };
        let (observe, hour) = (Some(LinkRights::Observe), Some(Duration::from_hours(1)));
        // The robot enforces its own copy, which it knows.
        assert_eq!([rights(false, None), rights(false, hour)], [observe; 2]);
        assert_eq!([rights(true, None), rights(true, hour)], [None, observe]);
    }
}
