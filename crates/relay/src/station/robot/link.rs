//! The link to one robot: its carrier, its measurements, and the contacts that are planned for it.

use super::name::RobotName;
use crate::carrier::Carrier;
use crate::clock::SessionClock;
use crate::contacts::{ContactStore, KnownContacts};
use crate::error::RelayError;
use crate::meter::{LinkMeter, shortened};
use crate::station::health::health;
use crate::station::received::Received;
use crate::value_fetch_broker::LinkRate;
use rafcon_link::{CARRIER_OVERHEAD, Profile, Rejected, StationSession, Unusable};
use rafcon_protocol::{LinkHealth, LinkReport, LinkRun};

/// The link to one robot.
pub(super) struct RobotLink {
    name: RobotName,
    clock: SessionClock,
    profile: Profile,
    meter: LinkMeter,
    contacts: ContactStore,
    /// Transport of the newest datagram of the robot.
    carrier: Option<Carrier>,
    /// Reason why the last datagram is not of this robot.
    rejected: Option<Rejected>,
}

impl RobotLink {
    pub(super) fn new(
        name: RobotName,
        clock: SessionClock,
        meter: LinkMeter,
        contacts: ContactStore,
        profile: &Profile,
    ) -> Self {
        let profile = profile.clone();
        Self { name, clock, profile, meter, contacts, carrier: None, rejected: None }
    }

    /// Sends due datagrams.
    pub(super) fn send(&self, session: &mut StationSession) -> Result<(), RelayError> {
        while let Some(datagram) = session.poll_transmit(self.clock.now())? {
            if let Some(carrier) = &self.carrier {
                carrier.send(&datagram);
            }
        }
        Ok(())
    }

    /// Content of a datagram. `None` if it is of another robot.
    pub(super) fn receive(
        &mut self,
        session: &mut StationSession,
        from: &Carrier,
        datagram: &[u8],
    ) -> Option<Vec<Received>> {
        let mut received = Vec::new();
        let before = session.horizon();
        let taken = session.handle_datagram(self.clock.now(), &mut datagram.to_vec(), |shown| {
            received.extend(Received::of(shown));
        });
        match taken {
            Ok(()) => {
                from.note_heard();
                // A delayed datagram of an old connection does not change it.
                if self.carrier.is_none() || session.horizon() != before {
                    self.carrier = Some(from.clone());
                }
            }
            Err(Unusable::Rejected(why)) => {
                self.rejected = Some(why);
                return None;
            }
            Err(Unusable::Broken(broken)) => {
                self.name.tell(&broken.to_string());
                self.meter.note_unusable(broken.to_string());
            }
        }
        Some(received)
    }

    /// No robot has made the datagram that was received last.
    pub(super) fn note_unusable(&mut self) {
        if let Some(why) = self.rejected.take() {
            self.meter.note_unusable(why.to_string());
        }
    }

    /// True while regular datagrams of the robot arrive.
    pub(super) fn is_heard(&self, session: &StationSession) -> bool {
        let before = session.heard_before(self.clock.now());
        before.is_some_and(|before| before < self.profile.silence())
    }

    /// The planned contacts, as they are known.
    pub(super) fn contacts(&self) -> KnownContacts {
        self.contacts.known(self.name.as_str()).unwrap_or_default()
    }

    /// State of the link, without the counts of events and commands.
    pub(super) fn health(&mut self, session: &StationSession) -> LinkHealth {
        let contacts = self.contacts();
        health(&mut self.meter, session, &contacts, self.clock.now())
    }

    /// Rate that the link has left for large values, which use `used_per_s` now.
    pub(super) fn value_rate(&mut self, session: &StationSession, used_per_s: u64) -> LinkRate {
        let link = self.health(session);
        let used = link.down_bytes_per_s.saturating_sub(used_per_s);
        let (most, part) = (self.profile.down_bits_per_s / 8, self.profile.value_part_bytes());
        // However busy the link is, a little is left in the end.
        let spare = most.saturating_sub(used).max(most / 20);
        let overhead = self.profile.down_bytes_max as u64 - part + CARRIER_OVERHEAD as u64;
        LinkRate { part, overhead, spare_per_s: link.is_heard.then_some(spare) }
    }

    /// Report of the link in this state, with its problems.
    pub(super) fn report(
        &self,
        link: LinkHealth,
        session: &StationSession,
        runs: Vec<LinkRun>,
    ) -> LinkReport {
        let (sent, received) = session.traffic();
        let report = self.meter.report(link, sent, received, runs);
        let problems = shortened(session.shortened_datagrams()).into_iter().collect();
        LinkReport { problems, ..report }
    }
}
