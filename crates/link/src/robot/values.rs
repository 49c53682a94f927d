//! Large values that the station has asked for, on their way to it: whatever nothing else needs of the rate, and never more bytes
//! than it allowed.

use super::outgoing::TransmitContext;
use super::source::RunSource;
use crate::assembly::PART_MIN;
use crate::frame::{Fetch, Frame, NoValue, ValueFrame, ValueName, ValuePart};
use crate::payload_writer::PayloadWriter;
use crate::profile::Profile;
use crate::range_set::RangeSet;
use crate::seal::OVERHEAD;
use crate::session_time::SessionTime;
use std::collections::VecDeque;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Capacity in values. One more replaces the value with the oldest request.
const VALUES_MAX: usize = 8;
/// Limit of parts in flight, which bounds the memory of a value.
const ON_THE_WAY_MAX: usize = 2_048;

/// The large values on their way.
#[derive(Debug, Default)]
pub(super) struct Values {
    /// The one that was asked for longest ago first.
    sending: VecDeque<Sending>,
}

#[derive(Debug)]
struct Sending {
    value: ValueName,
    /// When the station asked for it last.
    asked_at: SessionTime,
    length: Option<u64>,
    /// Which bytes the station has; the first one is 1.
    here: RangeSet,
    /// Sent parts without a report.
    sent: VecDeque<(SessionTime, RangeInclusive<u64>)>,
    sent_set: RangeSet,
    /// Bytes that may be in flight or lost.
    budget: u64,
    lost: u64,
    /// The station has a request that is to be refused.
    refusal: Option<NoValue>,
}

impl Profile {
    /// Bytes of a large value in a datagram without other frames.
    pub fn value_part_bytes(&self) -> u64 {
        const TIME_MAX: usize = 5;
        (self.down_bytes_max - OVERHEAD - TIME_MAX - ValuePart::HEAD_MAX) as u64
    }
}

impl Values {
    /// Applies a request of the station, with its received bytes. `echo` is the newest time that it received, with the delay of
    /// reordered datagrams.
    pub(super) fn wanted(
        &mut self,
        now: SessionTime,
        fetch: Fetch,
        echo: Option<(u64, u64)>,
        profile: &Profile,
    ) {
        let Fetch { value, budget, here } = fetch;
        let place = self.sending.iter().position(|sending| sending.value == value);
        let before = place.and_then(|place| self.sending.remove(place));
        let mut sending = before.unwrap_or_else(|| Sending::of(value));
        if budget == 0 {
            return;
        }
        (sending.asked_at, sending.budget, sending.refusal) = (now, budget, None);
        sending.report(here, echo, profile);
        self.sending.push_back(sending);
        if self.sending.len() > VALUES_MAX {
            self.sending.pop_front();
        }
    }

    /// Removes values without a recent request.
    pub(super) fn forget(&mut self) {
        self.sending.clear();
    }

    /// When a part can be sent.
    pub(super) fn due_at(&self) -> Option<SessionTime> {
        self.sending.iter().any(Sending::has_next).then_some(SessionTime::BEGIN)
    }

    /// Fills the rest of the datagram with parts.
    pub(super) fn write(
        &mut self,
        turn: TransmitContext<'_>,
        source: &mut impl RunSource,
        payload: &mut PayloadWriter,
    ) {
        // A station repeats the request for a value with each report.
        self.sending.retain(|sending| turn.now < sending.asked_at + turn.profile.silence());
        for sending in &mut self.sending {
            while sending.has_next() {
                let Some(room) = payload.left().checked_sub(ValuePart::HEAD_MAX + PART_MIN) else {
                    return;
                };
                sending.write_next(turn.now, source, room + PART_MIN, payload);
            }
        }
    }
}

impl Sending {
    fn of(value: ValueName) -> Self {
        Self {
            value,
            asked_at: SessionTime::BEGIN,
            length: None,
            here: RangeSet::default(),
            sent: VecDeque::new(),
            sent_set: RangeSet::default(),
            budget: 0,
            lost: 0,
            refusal: None,
        }
    }

    /// Parts sent before the newest one received are lost unless they are reported.
    fn report(&mut self, here: RangeSet, echo: Option<(u64, u64)>, profile: &Profile) {
        self.here = here;
        let Some((newest_ms, late_ms)) = echo else { return };
        let late = Duration::from_millis(late_ms) + profile.repeat_after;
        let lost_before = SessionTime::from_millis(newest_ms) - late;
        let (here, lost) = (&self.here, &mut self.lost);
        // The station counts the bytes that it has.
        self.sent.retain(|(at, range)| {
            let is_here = here.contains(range);
            let is_lost = !is_here && *at < lost_before;
            *lost += if is_lost { range.end() - range.start() + 1 } else { 0 };
            !is_here && !is_lost
        });
        self.sent_set = self.sent.iter().map(|(_, range)| range.clone()).collect();
    }

    /// True if bytes are missing that are not in flight. True while the length is unknown.
    fn has_next(&self) -> bool {
        let is_open = |length| self.here.first_gap(&self.sent_set, 1, length).is_some();
        let has_room = self.sent.len() < ON_THE_WAY_MAX;
        self.refusal.is_none() && has_room && self.length.is_none_or(is_open)
    }

    fn write_next(
        &mut self,
        now: SessionTime,
        source: &mut impl RunSource,
        bytes_max: usize,
        payload: &mut PayloadWriter,
    ) {
        let id = self.value.id;
        let mut refuse = |why, payload: &mut PayloadWriter| {
            self.refusal = Some(why);
            payload.fitting_frame(&Frame::Value(ValueFrame::NoValue(id, why)));
        };
        let Some(length) = self.length.or_else(|| source.value_length(&self.value)) else {
            return refuse(NoValue::Gone, payload);
        };
        self.length = Some(length);
        let Some(gap) = self.here.first_gap(&self.sent_set, 1, length) else { return };
        let wanted = (gap.end() - gap.start() + 1).min(bytes_max as u64);
        if self.lost + self.sent_set.count() + wanted > self.budget {
            return refuse(NoValue::OverBudget, payload);
        }
        let bytes_max = usize::try_from(wanted).unwrap_or(bytes_max);
        let offset = gap.start() - 1;
        let bytes = source.value_bytes(&self.value, offset, bytes_max);
        let Some(bytes) = bytes.filter(|bytes| !bytes.is_empty()) else {
            return refuse(NoValue::Gone, payload);
        };
        let range = *gap.start()..=offset + bytes.len() as u64;
        payload.fitting_frame(&Frame::Value(ValueFrame::ValuePart(ValuePart {
            id,
            offset,
            bytes: &bytes,
        })));
        self.sent_set.insert(range.clone());
        self.sent.push_back((now, range));
    }
}
