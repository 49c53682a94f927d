//! Reports to the robot: what is here of its runs.

use super::StationSession;
use super::incoming::Incoming;
use super::streams::Settled;
use crate::coding::{Contexts, LastCoder, OfferedSnapshots};
use crate::frame::{Frame, Received, StreamId};
use crate::payload_writer::PayloadWriter;
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::session_time::SessionTime;

impl StationSession {
    pub(super) fn report_at(&self) -> SessionTime {
        let Profile { report_every, .. } = self.profile;
        let every = if self.has_news { report_every } else { self.profile.report_idle_every() };
        self.reported_at.map_or(SessionTime::BEGIN, |at| at + every)
    }

    pub(super) fn write_report(&mut self, now: SessionTime, payload: &mut PayloadWriter) {
        let clocks = [self.end.heard.frame(now), self.end.heard.arrived()];
        if !payload.try_frames(clocks.iter().flatten()) {
            // Commands need all of this datagram; the report is due again with the next one.
            return;
        }
        self.write_settled(payload);
        let begun = payload.len();
        let (from, codes) = (self.report_from, self.profile.codes_new());
        self.report_from = StreamId(0);
        let round_trip = self.round_trip.unwrap_or(self.profile.round_trip);
        let streams: Vec<_> = self.streams.open.keys().copied().collect();
        let begin = streams.partition_point(|stream| *stream < from);
        for stream in streams[begin..].iter().chain(&streams[..begin]) {
            let Some(incoming) = self.streams.open.get_mut(stream) else { continue };
            let is_complete = incoming.is_complete();
            if is_complete && incoming.reports == 0 {
                (incoming.contexts, incoming.coder) = (Contexts::default(), LastCoder::default());
                incoming.snapshots = OfferedSnapshots::default();
                continue;
            }
            let length = payload.len();
            let events = incoming.received.clone();
            let is_coded = codes && !is_complete;
            let context = if is_coded { incoming.contexts.offer() } else { None };
            let snapshot = is_coded.then(|| incoming.snapshots.offer(now, round_trip)).flatten();
            incoming.large.drop_received(&incoming.received);
            let partial = if is_complete { Vec::new() } else { incoming.large.report() };
            let stream = *stream;
            let Incoming { safe, is_over, .. } = *incoming;
            let received = Received { stream, is_over, safe, events, context, snapshot, partial };
            if length == begun {
                // The first stream has no more room in a later report.
                received.write_shortened(payload);
            } else {
                payload.try_frame(&Frame::Received(received));
            }
            if payload.len() == length {
                // Streams without room begin the next report.
                self.report_from = stream;
                break;
            }
            incoming.reports = incoming.reports.saturating_sub(1);
        }
        self.streams.settle_complete();
        (self.reported_at, self.has_news) = (Some(now), false);
    }

    /// Reports settled streams that the robot has named, in at most half of the datagram.
    fn write_settled(&mut self, payload: &mut PayloadWriter) {
        let rest = payload.left().div_ceil(2);
        for (stream, Settled { events: safe, is_over }) in self.streams.asked() {
            let events = RangeSet::up_to(safe);
            let (context, snapshot, partial) = (None, None, Vec::new());
            let received = Received { stream, is_over, safe, events, context, snapshot, partial };
            if !payload.try_frame_leaving(rest, &Frame::Received(received)) {
                return;
            }
            self.streams.reported(stream);
        }
    }
}
