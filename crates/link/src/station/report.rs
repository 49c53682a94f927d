//! Reports to the robot: what is here of its runs.

use super::StationSession;
use super::incoming::Incoming;
use super::streams::Settled;
use crate::coding::{Contexts, LastCoder, OfferedSnapshots};
use crate::frame::{Received, StreamId};
use crate::profile::Profile;
use crate::range_set::RangeSet;
use std::time::Duration;

impl StationSession {
    pub(super) fn report_at(&self) -> Duration {
        let Profile { report_every, .. } = self.profile;
        let every = if self.has_news { report_every } else { self.profile.report_idle_every() };
        self.reported_at.map_or(Duration::ZERO, |at| at + every)
    }

    pub(super) fn write_report(&mut self, now: Duration, room: usize, payload: &mut Vec<u8>) {
        let begun = payload.len();
        if let Some(heard) = self.end.heard.frame(now) {
            heard.write(payload);
        }
        if let Some(arrived) = self.end.heard.arrived() {
            arrived.write(payload);
        }
        if payload.len() > room {
            // Commands need all of this datagram; the report is due again with the next one.
            payload.truncate(begun);
            return;
        }
        self.write_settled(payload.len() + (room - payload.len()) / 2, payload);
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
            let mut received =
                Received { stream, is_over, safe, events, context, snapshot, partial };
            // The first stream has no more room in a later report.
            let is_first = length == begun;
            while !received.write_into(room, payload) && is_first && received.shorten() {}
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

    /// Reports settled streams that the robot has named, as far as they fit.
    fn write_settled(&mut self, room: usize, payload: &mut Vec<u8>) {
        for (stream, Settled { events: safe, is_over }) in self.streams.asked() {
            let events = RangeSet::up_to(safe);
            let (context, snapshot, partial) = (None, None, Vec::new());
            let received = Received { stream, is_over, safe, events, context, snapshot, partial };
            if !received.write_into(room, payload) {
                return;
            }
            self.streams.reported(stream);
        }
    }
}
