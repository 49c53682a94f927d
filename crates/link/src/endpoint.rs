//! Common part of both sides of a link: sealing at a rate, opening, and the state of the other side.

use crate::bytes::BrokenFrame;
use crate::frame::{Frame, read_payload};
use crate::heard::Heard;
use crate::path_size::PathSize;
use crate::payload_writer::PayloadWriter;
use crate::profile::{Pacer, Profile};
use crate::seal::{
    Direction, For, Generation, Horizon, KeyId, OVERHEAD, Opened, Opener, PairingKey, Rejected,
    SealError, Sealer, SenderStart,
};
use crate::session_time::SessionTime;
use crate::traffic::Traffic;
use std::time::Duration;

/// Identity of a link, equal on both sides.
#[derive(Debug, Clone)]
pub struct Identity<'k> {
    /// The number of the pairing key.
    pub key_id: KeyId,
    /// The pairing key.
    pub key: &'k PairingKey,
    /// The name of the robot.
    pub robot: &'k str,
    /// This start, whose number is on the disk.
    pub start: SenderStart,
    /// Datagrams of the other side that the last start received.
    pub heard: Option<Horizon>,
}

/// Reason why a datagram had no or only part of its effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Unusable {
    /// It was not opened.
    #[error(transparent)]
    Rejected(#[from] Rejected),
    /// The other side made it, and it cannot be read: another version made it.
    #[error(transparent)]
    Broken(#[from] BrokenFrame),
}

/// One side of the link, without its content.
#[derive(Debug)]
pub(crate) struct Endpoint {
    pub(crate) start: SenderStart,
    pub(crate) pacer: Pacer,
    pub(crate) path: PathSize,
    pub(crate) heard: Heard,
    sealer: Sealer,
    opener: Opener,
    key_id: KeyId,
    /// Key of the last datagram opened.
    heard_key: Option<KeyId>,
    /// Other accepted keys: the next one and the previous one.
    others: Vec<OtherKey>,
    /// The robot's name, and which way this side sends.
    way: (String, Direction),
    sent: Traffic,
    received: Traffic,
}

#[derive(Debug)]
struct OtherKey {
    id: KeyId,
    sealer: Sealer,
    opener: Opener,
}

/// A datagram of the other side.
pub(crate) struct Arrived<'d> {
    pub(crate) generation: Generation,
    /// The time of its sender.
    pub(crate) at_ms: u64,
    /// True if this is the first datagram of a new start.
    pub(crate) is_new_start: bool,
    /// Silence of the other side before this datagram.
    pub(crate) silence: Option<Duration>,
    /// Its frames, up to the first broken one.
    pub(crate) frames: Vec<Result<Frame<'d>, BrokenFrame>>,
}

impl Endpoint {
    /// The side that sends in this direction.
    pub(crate) fn new(identity: &Identity<'_>, sends: Direction, profile: &Profile) -> Self {
        let Identity { key_id, key, robot, start, heard } = identity.clone();
        let receives = sends.back();
        let (bits_per_s, datagram_max) = match sends {
            Direction::Down => (profile.down_bits_per_s, profile.down_bytes_max),
            Direction::Up => (profile.up_bits_per_s, profile.up_bytes_max),
        };
        Self {
            key_id,
            heard_key: None,
            others: Vec::new(),
            way: (robot.to_owned(), sends),
            start,
            pacer: Pacer::new(bits_per_s),
            path: PathSize::new(datagram_max),
            heard: Heard::default(),
            sealer: Sealer::new(key_id, key, robot, sends, start),
            opener: Opener::new(key_id, key, robot, receives, heard),
            sent: Traffic::default(),
            received: Traffic::default(),
        }
    }

    /// The key with which this side seals.
    pub(crate) fn key_id(&self) -> KeyId {
        self.key_id
    }

    /// The key with which the other side sealed what was opened last.
    pub(crate) fn heard_key(&self) -> Option<KeyId> {
        self.heard_key
    }

    /// From now on, what is sealed with this key is opened, too.
    pub(crate) fn add_key(&mut self, id: KeyId, key: &PairingKey) {
        let (robot, sends) = &self.way;
        let sealer = Sealer::new(id, key, robot, *sends, self.start);
        let opener = Opener::new(id, key, robot, sends.back(), None);
        self.others.retain(|other| other.id != id);
        self.others.push(OtherKey { id, sealer, opener });
    }

    /// From now on, this side seals with a key that was added.
    pub(crate) fn use_key(&mut self, id: KeyId) {
        if let Some(other) = self.others.iter_mut().find(|other| other.id == id) {
            other.sealer.follow(&self.sealer);
            std::mem::swap(&mut self.sealer, &mut other.sealer);
            std::mem::swap(&mut self.opener, &mut other.opener);
            std::mem::swap(&mut self.key_id, &mut other.id);
        }
    }

    /// Opens a datagram with the key that its header names.
    fn open_sealed<'d>(&mut self, datagram: &'d mut [u8]) -> Result<Opened<'d>, Rejected> {
        let is_own = self.opener.is_named_by(datagram);
        let is_named = |other: &&mut OtherKey| other.opener.is_named_by(datagram);
        let mut named: Vec<_> = self.others.iter_mut().filter(is_named).collect();
        if let [only] = &mut named[..]
            && !is_own
        {
            let opened = only.opener.open(datagram).map_err(|failed| match failed {
                Rejected::TooShort(_) | Rejected::Version(_) => failed,
                _ => Rejected::Key(only.id),
            })?;
            self.heard_key = Some(only.id);
            return Ok(opened);
        }
        // Two bits of a short header can name several keys, and a failed attempt changes the bytes.
        let opened = named.into_iter().find_map(|other| {
            let mut copy = datagram.to_vec();
            let Opened { generation, number, payload } = other.opener.open(&mut copy).ok()?;
            Some((other.id, generation, number, payload.to_vec()))
        });
        if let Some((id, generation, number, plain)) = opened {
            self.heard_key = Some(id);
            let payload = &mut datagram[..plain.len()];
            payload.copy_from_slice(&plain);
            return Ok(Opened { generation, number, payload });
        }
        let opened = self.opener.open(datagram)?;
        self.heard_key = Some(self.key_id);
        Ok(opened)
    }

    /// Latest state of the other side, for the disk.
    pub(crate) fn horizon(&self) -> Option<Horizon> {
        self.opener.heard()
    }

    /// Datagrams and bytes sent and received.
    pub(crate) fn traffic(&self) -> (&Traffic, &Traffic) {
        (&self.sent, &self.received)
    }

    /// Maximum bytes of the header and the tag of the next datagram.
    pub(crate) fn overhead(&self, is_heard: bool) -> usize {
        self.sealer.overhead(if is_heard { For::Listener } else { For::Anyone })
    }

    /// The other side acknowledged this datagram of this start.
    pub(crate) fn confirm(&mut self, number: u64) {
        self.sealer.confirm(number);
    }

    /// The datagram with this payload, which is sent now.
    pub(crate) fn seal(
        &mut self,
        now: SessionTime,
        whom: For,
        payload: &PayloadWriter,
    ) -> Result<Vec<u8>, SealError> {
        let mut datagram = Vec::with_capacity(payload.len() + OVERHEAD);
        self.sealer.seal(whom, payload.bytes(), &mut datagram)?;
        self.sent.count_datagram(datagram.len());
        for (kind, length) in payload.frames() {
            self.sent.count_frame(kind, *length);
        }
        self.pacer.spend(now, datagram.len());
        self.path.sent(now, datagram.len());
        Ok(datagram)
    }

    /// Opens a datagram of the other side.
    pub(crate) fn open<'d>(
        &mut self,
        now: SessionTime,
        datagram: &'d mut [u8],
    ) -> Result<Arrived<'d>, Unusable> {
        let length = datagram.len();
        let Opened { generation, number, payload } = self.open_sealed(datagram)?;
        let (at_ms, frames) = read_payload(payload)?;
        self.received.count_datagram(length);
        let received = &mut self.received;
        let counted = frames.map(|frame| {
            let (frame, length) = frame?;
            received.count_frame(frame.kind(), length);
            Ok(frame)
        });
        let frames = counted.collect();
        let silence = self.heard.before(now);
        let is_new_start = self.heard.hear((generation, number), at_ms, length, now);
        if is_new_start {
            self.sealer.forget_confirmed();
        }
        Ok(Arrived { generation, at_ms, is_new_start, silence, frames })
    }
}
