//! Outgoing snapshots of one run: whole in one datagram if they can be coded from one that the station has, otherwise deflated
//! and in parts.

use super::outgoing::{TransmitContext, next_part, small};
use super::source::RunSource;
use super::tail::Tail;
use crate::assembly::LENGTH_MAX;
use crate::coding::{ContextName, SentSnapshots};
use crate::deflate::deflate;
use crate::frame::{Frame, StreamId};
use crate::payload_writer::PayloadWriter;
use crate::profile::Profile;
use crate::session_time::SessionTime;
use std::time::Duration;

/// Interval of snapshots while the up-link works, in status intervals. The station may need one for reasons unknown to the
/// robot.
const STATUSES: u32 = 480;
/// Rounds in which a snapshot is sent without reports before a newer one replaces it. Parts of all rounds complete it.
const ROUNDS: u32 = 4;
/// Number of datagrams up to which a snapshot usually arrives whole. A newer one replaces such a snapshot in the next round.
const SHORT: usize = 2;
/// Without reports, a whole snapshot is sent in this time, as long as that takes at most half of the rate.
const EVERY: Duration = Duration::from_millis(200);

/// True if a snapshot is needed in addition to the periodic ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Need {
    None,
    /// The source has a newer one: as soon as the rate allows it.
    Newer,
    /// Events were lost: at once.
    Now,
}

/// The snapshots of one run on their way to the station.
#[derive(Debug)]
pub(super) struct Snapshots {
    /// When the last one, or its last round, began.
    begun_at: Option<SessionTime>,
    need: Need,
    /// The one that is being sent in parts.
    parts: Option<Parts>,
    sent: SentSnapshots,
}

#[derive(Debug)]
struct Parts {
    sequence: u64,
    /// As the source has it.
    plain: Vec<u8>,
    deflated: Vec<u8>,
    /// Progress in this round.
    sent: usize,
    rounds: u32,
}

impl Snapshots {
    pub(super) fn new() -> Self {
        Self { begun_at: None, need: Need::Now, parts: None, sent: SentSnapshots::default() }
    }

    /// The source has a newer one than before.
    pub(super) fn set_changed(&mut self) {
        self.need = self.need.max(Need::Newer);
    }

    /// One is needed at once, unless it is on its way.
    pub(super) fn need_now(&mut self) {
        if self.parts.as_ref().is_none_or(|parts| parts.sent == 0) {
            self.need = Need::Now;
        }
    }

    /// The station has this one to code from, or none.
    pub(super) fn offer(&mut self, offered: Option<ContextName>) {
        self.sent.offer(offered);
    }

    /// When the next one, or the next part, is sent even if nothing else is: one that is only newer waits a little for events, so that
    /// it costs no datagram.
    pub(super) fn alone_at(&self, is_heard: bool, profile: &Profile) -> SessionTime {
        let is_patient = is_heard && self.need == Need::Newer && self.begun_at.is_some();
        let wait = if is_patient { profile.repeat_after } else { Duration::ZERO };
        self.due_at(is_heard, profile) + wait
    }

    /// When the next one, or the next part, is due.
    fn due_at(&self, is_heard: bool, profile: &Profile) -> SessionTime {
        let is_between = self.parts.as_ref().is_none_or(|parts| parts.sent == 0);
        let Some(at) = self.begun_at.filter(|_| is_between && self.need != Need::Now) else {
            return SessionTime::BEGIN;
        };
        let bits = self.parts.as_ref().map_or(0, |parts| parts.deflated.len() as u64 * 8);
        let takes = Duration::from_millis(bits * 1_000 / profile.down_bits_per_s.max(1));
        let every = match is_heard {
            true if self.need == Need::Newer => (takes * 4).max(profile.snapshot_every),
            true => profile.status_every * STATUSES,
            false => (takes * 2).max(EVERY),
        };
        at + every
    }

    /// Writes the next one that is due, or a part of it.
    pub(super) fn write(
        &mut self,
        (run, head, tail): (StreamId, u64, &mut Tail),
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) {
        let TransmitContext { now, profile, is_heard } = turn;
        let is_alone = payload.is_empty();
        let due_at = if is_alone { Self::alone_at } else { Self::due_at };
        if due_at(self, is_heard, profile) > now {
            return;
        }
        let bytes_max = payload.bytes_max();
        let goes_on = |parts: &Parts| {
            let is_long = parts.deflated.len() > bytes_max * SHORT;
            let again = !is_heard && is_long && parts.rounds < ROUNDS;
            parts.sent > 0 || again && tail.continues(parts.sequence, head)
        };
        if self.need == Need::Now || !self.parts.as_ref().is_some_and(goes_on) {
            let taken = source.snapshot(run);
            let taken = taken.filter(|(_, bytes)| bytes.len() <= LENGTH_MAX as usize);
            let Some((sequence, plain)) = taken else {
                (self.need, self.parts, self.begun_at) = (Need::None, None, Some(now));
                return;
            };
            let coded = if is_heard { self.sent.encode(&plain) } else { None };
            if let Some((context, coded)) = coded
                && coded.len() < bytes_max / 2
            {
                let (length, bytes) = (small(plain.len()), coded.as_slice());
                let frame = Frame::CodedSnapshot { context, stream: run, sequence, length, bytes };
                if self.write_coded(&frame, turn, payload) {
                    self.sent.note(sequence, plain);
                }
                return;
            }
            self.need = Need::None;
            let deflated = deflate(&plain);
            self.parts = Some(Parts { sequence, plain, deflated, sent: 0, rounds: 0 });
        }
        self.begun_at.get_or_insert(now);
        self.write_part(run, tail, turn, payload);
    }

    /// Returns false if the frame does not fit: it fits into the next datagram.
    fn write_coded(
        &mut self,
        frame: &Frame<'_>,
        turn: TransmitContext<'_>,
        payload: &mut PayloadWriter,
    ) -> bool {
        if !payload.try_frame(frame) {
            return false;
        }
        (self.need, self.parts, self.begun_at) = (Need::None, None, Some(turn.now));
        true
    }

    fn write_part(
        &mut self,
        stream: StreamId,
        tail: &mut Tail,
        turn: TransmitContext<'_>,
        payload: &mut PayloadWriter,
    ) {
        let TransmitContext { now, profile, is_heard } = turn;
        let Some(Parts { sequence, plain, deflated, sent, rounds }) = &mut self.parts else {
            return;
        };
        let (offset, part) = next_part(deflated, *sent, payload.left());
        if part.is_empty() && !deflated.is_empty() {
            return;
        }
        if offset == 0 {
            self.begun_at = Some(now);
            // Later events are sent with each round, so that the state is current.
            if !is_heard {
                tail.send_again_after(*sequence);
            }
        }
        let (sequence, length) = (*sequence, small(deflated.len()));
        payload.fitting_frame(&Frame::Snapshot { stream, sequence, length, offset, bytes: part });
        *sent += part.len();
        if *sent >= deflated.len() {
            (*sent, *rounds) = (0, *rounds + 1);
            if *rounds == 1 && profile.codes_new() {
                self.sent.note(sequence, std::mem::take(plain));
            }
        }
    }
}
