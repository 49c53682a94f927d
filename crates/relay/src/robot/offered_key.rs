//! The key that a robot offers its station: offered when it lies ready, stored once the station has it, and then used.

use super::disk::RobotDisk;
use crate::pairing::Pairing;
use rafcon_link::RobotSession;

/// The key that is to replace the one in force.
#[derive(Debug, Default)]
pub(super) struct OfferedKey {
    next: Option<Pairing>,
    /// The disk replaces the pairing.
    is_replacing: bool,
}

impl OfferedKey {
    /// True while the station does not use an offered key.
    pub(super) fn is_pending(&self) -> bool {
        self.next.is_some()
    }

    /// Offers the station a key that lies ready.
    pub(super) fn offer(&mut self, next: Pairing, session: &mut RobotSession) {
        if self.next.is_none() && next.key_id != session.key_id() {
            session.offer_key(next.key_id, &next.key);
            self.next = Some(next);
        }
    }

    /// Replaces the pairing once the station has the key.
    pub(super) fn renew(&mut self, session: &RobotSession, disk: &RobotDisk) {
        if let Some(next) = &self.next
            && !self.is_replacing
            && session.is_offer_taken()
        {
            self.is_replacing = true;
            disk.replace_key(next.clone());
        }
    }

    /// Uses the key once it is on the disk.
    pub(super) fn replaced(
        &mut self,
        replaced: Result<(), String>,
        session: &mut RobotSession,
        tell: fn(&str),
    ) {
        self.is_replacing = false;
        match replaced {
            Ok(()) => {
                session.use_offered();
                self.next = None;
                tell("the station uses the new key, and so does this robot");
            }
            Err(error) => tell(&format!("the new key is not used yet: {error}")),
        }
    }
}
