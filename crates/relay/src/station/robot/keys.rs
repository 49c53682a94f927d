//! The keys of one robot: the pairing in force, and the one that is to replace it.

use crate::pairing::{Paired, Pairing};
use crate::rights::PairingRights;
use crate::station::disk::{Disk, KeyWork};
use rafcon_link::{KeyId, PairingKey, StationSession};
use std::sync::Arc;

/// Pairings of a station with one robot.
pub(super) struct PairingKeys {
    disk: Arc<Disk>,
    pairing: Pairing,
    /// The pairing that is used and does not replace the one before yet.
    new: Option<Pairing>,
}

impl PairingKeys {
    /// Uses the newest key on the disk.
    pub(super) fn begin(paired: &Paired, disk: Arc<Disk>, session: &mut StationSession) -> Self {
        let pairing = paired.pairing.clone();
        let new = paired.read_next().filter(|new| new.key_id != pairing.key_id);
        if let Some(Pairing { key_id, key, .. }) = &new {
            session.use_key(*key_id, key);
        }
        Self { disk, pairing, new }
    }

    /// Stores a key that the robot offers. The disk reports it before it is used.
    pub(super) fn offered(&self, key_id: KeyId, key: PairingKey) {
        self.disk.keep_key(KeyWork::Next(Pairing { key_id, key, ..self.pairing.clone() }));
    }

    /// Uses a key that is on the disk.
    pub(super) fn kept(&mut self, new: Pairing, session: &mut StationSession) {
        session.use_key(new.key_id, &new.key);
        self.new = Some(new);
    }

    /// Replaces the pairing once the robot uses the new key.
    pub(super) fn confirm(&mut self, session: &StationSession) {
        if let Some(new) = self.new.take_if(|_| session.is_key_confirmed()) {
            self.disk.keep_key(KeyWork::Replace(new));
        }
    }

    /// Tags of the pairings that the robot may use, the one in force first.
    pub(super) fn tags(&self) -> Vec<String> {
        self.new.iter().chain([&self.pairing]).map(Pairing::tag).collect()
    }

    /// Rights of this station's users, by the pairing.
    pub(super) fn rights(&self) -> PairingRights {
        self.pairing.rights
    }
}
