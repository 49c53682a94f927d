//! Takes the frames of the robot.

use super::incoming::{GAPS_MAX, Incoming, LAST_REPORTS, PARTS_MAX};
use super::{FromRobot, StationSession};
use crate::assembly::{Assembly, LENGTH_MAX};
use crate::coding::OfferedSnapshots;
use crate::deflate::inflate;
use crate::endpoint::{Arrived, Unusable};
use crate::frame::{CommandState, Frame, StreamId, ValueFrame};
use crate::session_time::SessionTime;
use rafcon_events::EventBlockRef;
use std::time::Duration;

impl StationSession {
    /// Handles a received datagram. `show` receives its new content.
    pub fn handle_datagram(
        &mut self,
        now: SessionTime,
        datagram: &mut [u8],
        mut show: impl FnMut(FromRobot<'_>),
    ) -> Result<(), Unusable> {
        let Arrived { generation, at_ms, is_new_start, silence, frames } =
            self.end.open(now, datagram)?;
        self.now = now;
        if is_new_start {
            (self.round_trip, self.reached_ms, self.calendar_ms) = (None, None, None);
            self.value_requests.repeat();
            self.commands.robot_started();
            // The robot does not have what it sent before.
            let streams = self.streams.open.values_mut();
            streams.for_each(|incoming| incoming.snapshots = OfferedSnapshots::default());
            show(FromRobot::Started);
        }
        if silence.is_none_or(|silence| silence > self.profile.silence()) {
            // After a silence, the robot learns at once what is missing.
            (self.has_news, self.reported_at) = (true, None);
            self.commands.ask_again(now);
        }
        self.clock.receive(generation, at_ms, now.as_millis());
        for frame in frames {
            self.take(now, at_ms, &frame?, &mut show);
        }
        Ok(())
    }

    fn take(
        &mut self,
        now: SessionTime,
        at_ms: u64,
        frame: &Frame<'_>,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        match *frame {
            Frame::Events { stream, block } => self.take_events(stream, block, show),
            Frame::Coded { .. } => self.take_coded(frame, show),
            Frame::Large { .. } => self.take_large(frame, show),
            Frame::Status { .. } => self.take_status(at_ms, frame, show),
            Frame::Snapshot { .. } => self.take_snapshot_part(frame, show),
            Frame::CodedSnapshot { context, stream, sequence, length, bytes } => {
                if self.touch_settled(stream, sequence) {
                    return;
                }
                let Some(incoming) = self.incoming(stream) else { return };
                let (snapshots, length) = (&mut incoming.snapshots, length as usize);
                let Some(bytes) = snapshots.decode(context, bytes, length) else { return };
                self.take_snapshot(stream, sequence, bytes, show);
            }
            Frame::CommandState { id, state, reason } => {
                self.commands.answered(now, id, state, self.answer_time());
                show(FromRobot::CommandState { id, state, reason });
            }
            Frame::PartsHere(ref here) => {
                self.commands.parts_here(now, here, self.answer_time());
            }
            Frame::Heard { start, number, newest_ms, held_ms, late_ms }
                if start == self.end.start.generation =>
            {
                self.end.confirm(number);
                self.echo_ms = Some(newest_ms.saturating_sub(late_ms));
                let heard_at = at_ms.saturating_sub(held_ms);
                self.clock.robot_heard(heard_at, newest_ms, now.as_millis());
                let since = now.as_millis().saturating_sub(newest_ms).saturating_sub(held_ms);
                self.round_trip = Some(Duration::from_millis(since));
                self.reached_ms = self.reached_ms.max(Some(newest_ms));
                self.expire_unheard(at_ms, SessionTime::from_millis(newest_ms), show);
            }
            Frame::Arrived { bytes, longest } => {
                let longest = usize::try_from(longest).unwrap_or(usize::MAX);
                if let Some(echo_ms) = self.echo_ms.take()
                    && self.end.path.report(now, longest, bytes, echo_ms)
                {
                    self.commands.shorten(self.command_bytes_max());
                }
            }
            Frame::NewKey { id, ref key } if id != self.end.key_id() => {
                show(FromRobot::NewKey { id, key: key.clone() });
            }
            Frame::Calendar { began_ms } => self.calendar_ms = Some(began_ms),
            Frame::Value(ref frame) => {
                self.has_news |= matches!(frame, ValueFrame::ValuePart(_));
                self.value_requests.answered(frame, show);
            }
            _ => {}
        }
    }

    /// Expires commands that did not reach the robot in time.
    fn expire_unheard(
        &mut self,
        at_ms: u64,
        heard: SessionTime,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        let Some(clock) = self.robot_clock(self.now) else { return };
        for id in self.commands.take_unheard(clock.start, at_ms, heard) {
            show(FromRobot::CommandState { id, state: CommandState::Expired, reason: b"" });
        }
    }

    /// Takes a part of an event.
    fn take_large(&mut self, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Large { stream, first, time_before, packing, length, offset, bytes } = *frame
        else {
            return;
        };
        self.has_news = true;
        if self.touch_settled(stream, first) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        if incoming.received.contains(&(first..=first)) {
            return;
        }
        if !incoming.large.has(first, length, packing) {
            self.make_room(length);
        }
        let Some(incoming) = self.incoming(stream) else { return };
        let whole = incoming.large.add((first, length, packing), offset, bytes);
        let Some(items) = whole.and_then(|packed| incoming.unpack(packing, packed)) else { return };
        let (first_sequence, time_before) = (first, time_before);
        let block = EventBlockRef { first_sequence, count: 1, time_before, bytes: &items };
        self.take_events(stream, block, show);
    }

    fn take_status(&mut self, at_ms: u64, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Status { stream, head, is_over, state, chain } = *frame else { return };
        if self.touch_settled(stream, head) {
            if is_over {
                self.streams.end_settled(stream);
            }
        } else {
            let Some(incoming) = self.incoming(stream) else { return };
            incoming.reports = LAST_REPORTS;
            incoming.head = incoming.head.max(head);
            incoming.is_over |= is_over;
            self.has_news = true;
        }
        show(FromRobot::Status { stream, head, is_over, state, chain, at_ms });
    }

    /// Takes a part of a snapshot.
    fn take_snapshot_part(&mut self, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Snapshot { stream, sequence, length, offset, bytes } = *frame else { return };
        if self.touch_settled(stream, sequence) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        if sequence < incoming.snapshot_sequence {
            return;
        }
        if !incoming.snapshot.is_of(sequence, length) {
            self.make_room(length);
        }
        let Some(incoming) = self.incoming(stream) else { return };
        let whole = incoming.snapshot.add(sequence, length, offset, bytes);
        if let Some(bytes) = whole.and_then(|whole| inflate(&whole, LENGTH_MAX as usize)) {
            self.take_snapshot(stream, sequence, bytes, show);
        }
    }

    fn take_snapshot(
        &mut self,
        stream: StreamId,
        sequence: u64,
        bytes: Vec<u8>,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        let codes = self.profile.codes_new();
        let Some(incoming) = self.incoming(stream) else { return };
        if sequence < incoming.snapshot_sequence {
            return;
        }
        incoming.snapshot_sequence = sequence;
        if codes {
            incoming.snapshots.note(sequence, &bytes);
        }
        show(FromRobot::Snapshot { stream, sequence, bytes });
    }

    fn take_coded(&mut self, frame: &Frame<'_>, show: &mut impl FnMut(FromRobot<'_>)) {
        let Frame::Coded { context, length, stream, block } = *frame else { return };
        if self.touch_settled(stream, block.last_sequence()) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        if incoming.received.contains(&block.sequences()) {
            return self.take_events(stream, EventBlockRef { bytes: &[], ..block }, show);
        }
        let Incoming { contexts, coder, .. } = incoming;
        // Events that cannot be decoded after a restart of this side are treated as lost.
        let coder = contexts.find(context).map(|known| coder.with(context, known));
        let bytes = coder.and_then(|coder| coder.decode(block.bytes, length as usize));
        if let Some(bytes) = bytes {
            self.take_events(stream, EventBlockRef { bytes: &bytes, ..block }, show);
        }
    }

    /// The open stream of this number; `None` if too many are open.
    fn incoming(&mut self, stream: StreamId) -> Option<&mut Incoming> {
        self.streams.incoming(self.now, stream)
    }

    /// True if a stream is settled and has this event. Then a report of it is due.
    fn touch_settled(&mut self, stream: StreamId, last: u64) -> bool {
        let is_settled = self.streams.touch_settled(stream, last);
        self.has_news |= is_settled;
        is_settled
    }

    /// Parts of another thing begin to arrive: if too many wait already, they are sent again in their turn.
    fn make_room(&mut self, length: u32) {
        if length > LENGTH_MAX {
            return;
        }
        let waiting = self.streams.open.values();
        let waiting = waiting.map(|it| it.snapshot.length() + it.large.length()).sum::<usize>();
        if waiting + length as usize > PARTS_MAX {
            for incoming in self.streams.open.values_mut() {
                incoming.snapshot = Assembly::default();
                incoming.large.clear();
            }
        }
    }

    fn take_events(
        &mut self,
        stream: StreamId,
        block: EventBlockRef<'_>,
        show: &mut impl FnMut(FromRobot<'_>),
    ) {
        let codes = self.profile.codes_new();
        self.has_news = true;
        if self.touch_settled(stream, block.last_sequence()) {
            return;
        }
        let Some(incoming) = self.incoming(stream) else { return };
        let is_scattered = incoming.received.ranges_count() >= GAPS_MAX;
        if is_scattered && incoming.received.end_at(block.first_sequence - 1).is_none() {
            return;
        }
        incoming.head = incoming.head.max(block.last_sequence());
        incoming.reports = LAST_REPORTS;
        if codes && !block.bytes.is_empty() {
            incoming.contexts.note(block);
        }
        if !incoming.received.contains(&block.sequences()) {
            incoming.received.insert(block.sequences());
            show(FromRobot::Events { stream, block });
        }
    }
}
