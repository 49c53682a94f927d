//! Writes the next datagram to the station, by rank.

use super::outgoing::TransmitContext;
use super::watched::Behind;
use super::{RobotSession, RunSource, STATE_SENDS, SentState};
use crate::frame::Frame;
use crate::path_size::LENGTH_MIN;
use crate::payload_writer::PayloadWriter;
use crate::profile::CARRIER_OVERHEAD;
use crate::seal::{For, SealError};
use crate::session_time::SessionTime;
use std::time::Duration;

impl RobotSession {
    /// The next datagram, if one is due.
    pub fn poll_transmit(
        &mut self,
        now: SessionTime,
        source: &mut impl RunSource,
    ) -> Result<Option<Vec<u8>>, SealError> {
        let is_heard = self.is_heard(now);
        if !is_heard && now >= SessionTime::after(self.profile.silence()) {
            self.rate.unheard();
        }
        let is_urgent = self.urgent_at(is_heard) <= now;
        // An urgent datagram may leave somewhat before its turn, so that it does not wait behind bulk.
        let may_send =
            self.end.pacer.free_at() <= now + if is_urgent { self.slack() } else { Duration::ZERO };
        if !may_send {
            return Ok(None);
        }
        let room = self.end.path.next_max(is_heard) - self.end.overhead(is_heard);
        let mut payload = PayloadWriter::new(now, room);
        self.write_states(now, &mut payload);
        self.incomplete.write(now, self.profile.repeat_after, &mut payload);
        self.write_offer(now, &mut payload);
        let turn = TransmitContext { now, profile: &self.profile, is_heard };
        let was_silent = self.alive_at() <= now;
        let mut shows_status = was_silent;
        for stream in self.streams.values_mut() {
            shows_status |= stream.write_urgent(turn, source, &mut payload);
        }
        if shows_status {
            let calendar = self.calendar_ms.map(|began_ms| Frame::Calendar { began_ms });
            let arrived =
                self.end.heard.arrived().filter(|_| self.profile.up_bytes_max > LENGTH_MIN);
            let frames = [self.end.heard.frame(now), arrived, calendar];
            for frame in frames.into_iter().flatten() {
                // A frame that does not fit is sent with the next status.
                payload.try_frame(&frame);
            }
        }
        if self.end.pacer.free_at() <= now {
            // The present state of no run waits for the history of another.
            for stream in self.streams.values_mut() {
                stream.write_snapshot(turn, source, &mut payload);
            }
            for (id, stream) in &self.streams {
                let behind = Behind { is_heard, from: stream.lacks_from() };
                self.watched.write(*id, behind, turn, &mut payload);
            }
            self.bulk.write((&mut self.streams, &mut self.values), turn, source, &mut payload);
        }
        if payload.is_empty() && !was_silent {
            return Ok(None);
        }
        self.sent_at = Some(now);
        // A new receiver with the key learns the present start from the status.
        let whom = match (is_heard, shows_status) {
            (true, false) => For::Confirmed,
            (true, true) => For::Listener,
            (false, _) => For::Anyone,
        };
        self.end.pacer.set_rate(self.rate.bits_per_s());
        let datagram = self.end.seal(now, whom, &payload)?;
        self.rate.sent(now, datagram.len() + CARRIER_OVERHEAD);
        Ok(Some(datagram))
    }

    /// When something may be due next; earlier if anything is received or appended. `None` if never.
    pub fn poll_timeout(&self, now: SessionTime) -> Option<SessionTime> {
        let is_heard = self.is_heard(now);
        let free_at = self.end.pacer.free_at();
        let urgent = self.urgent_at(is_heard).max(free_at - self.slack());
        let bulk = self.streams.values().map(|stream| stream.bulk_at(is_heard, &self.profile));
        let watched = self.watched.due_at(|stream| self.behind(stream, is_heard));
        let values = self.values.due_at().filter(|_| is_heard);
        let bulk = SessionTime::earliest(bulk.chain([watched, values])).map(|at| at.max(free_at));
        Some(urgent.or_earlier([bulk, self.scheduled.due_at()]).max(now))
    }

    /// Time of the next keep-alive, from which a restarted station learns the robot's address.
    fn alive_at(&self) -> SessionTime {
        self.sent_at.map_or(SessionTime::BEGIN, |at| at + self.profile.status_every * 4)
    }

    /// When urgent data is due, at the latest the keep-alive.
    fn urgent_at(&self, is_heard: bool) -> SessionTime {
        let states = self.states.values().filter(|state| state.sends < STATE_SENDS);
        let states = states.map(|state| state.due).min();
        let streams = self.streams.values().map(|stream| stream.urgent_at(&self.profile, is_heard));
        let offer = self.offered.as_ref().map(|(.., due)| *due);
        let others = [states, self.incomplete.due_at(), offer];
        self.alive_at().or_earlier(streams.chain(others))
    }

    /// Send time of two full datagrams.
    fn slack(&self) -> Duration {
        let bits = self.profile.down_bytes_max as u64 * 2 * 8;
        Duration::from_nanos(bits * 1_000_000_000 / self.rate.bits_per_s())
    }

    fn write_offer(&mut self, now: SessionTime, payload: &mut PayloadWriter) {
        if let Some((id, key, due)) = self.offered.as_mut().filter(|(.., due)| *due <= now)
            && payload.try_frame(&Frame::NewKey { id: *id, key: key.clone() })
        {
            *due = now + self.profile.status_every * 4;
        }
    }

    fn write_states(&mut self, now: SessionTime, payload: &mut PayloadWriter) {
        let due =
            self.states.iter_mut().filter(|(_, sent)| sent.sends < STATE_SENDS && sent.due <= now);
        for (id, sent) in due {
            let SentState { state, reason, .. } = &*sent;
            if !payload.try_frame(&Frame::CommandState { id: *id, state: *state, reason }) {
                break;
            }
            sent.sends += 1;
            sent.due = now + self.profile.repeat_after;
        }
    }
}
