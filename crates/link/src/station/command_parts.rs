//! The parts of a command that does not fit into one datagram: which are sent, and which have arrived.

use crate::assembly::PART_MIN;
use crate::frame::{CommandId, CommandPart, Frame, PartsHere};
use crate::payload_writer::PayloadWriter;
use crate::range_set::RangeSet;
use crate::session_time::SessionTime;
use std::time::Duration;

/// Bytes of a command, numbered from 1.
#[derive(Debug, Default)]
pub(super) struct CommandParts {
    /// As the robot reported. A report names a limited number of ranges.
    arrived: RangeSet,
    /// Sent in this round, or arrived.
    sent: RangeSet,
    /// Time of the last round that a report began.
    resent_at: Option<SessionTime>,
    is_round_over: bool,
}

impl CommandParts {
    /// Bytes that have arrived.
    pub(super) fn arrived(&self) -> u64 {
        self.arrived.ranges().map(|range| range.end() - range.start() + 1).sum()
    }

    /// Takes a report of the robot; true if a new round begins. With the head there, parts that were sent and have not arrived are
    /// lost; reports of the last round trip may be older than the parts that were sent again.
    pub(super) fn report(
        &mut self,
        now: SessionTime,
        here: &PartsHere,
        length: u64,
        round_trip: Duration,
    ) -> bool {
        for range in here.bytes.ranges() {
            self.arrived.insert(range);
        }
        let is_whole = |bytes: &RangeSet| bytes.contiguous() >= length;
        if here.has_head && is_whole(&self.arrived) && !is_whole(&here.bytes) {
            // The robot has dropped what it had reported before.
            self.arrived = here.bytes.clone();
        }
        let is_old = self.resent_at.is_some_and(|at| now < at + round_trip);
        let begins = here.has_head && !is_old;
        if begins {
            self.resent_at = Some(now);
            self.begin_round();
        }
        begins
    }

    /// The robot has started again, without any parts.
    pub(super) fn robot_started(&mut self) {
        self.arrived = RangeSet::default();
        self.begin_round();
    }

    /// True once all parts of this round are sent.
    pub(super) fn is_round_over(&self) -> bool {
        self.is_round_over
    }

    /// Sends again all that is not known to have arrived.
    pub(super) fn begin_round(&mut self) {
        (self.sent, self.is_round_over) = (self.arrived.clone(), false);
    }

    /// Writes the next parts as far as they fit; true once all are sent.
    pub(super) fn write(
        &mut self,
        id: CommandId,
        body: &[u8],
        payload: &mut PayloadWriter,
    ) -> bool {
        let length = u32::try_from(body.len()).unwrap_or(u32::MAX);
        while let Some(gap) = self.sent.first_gap(&self.arrived, 1, u64::from(length)) {
            let bytes_max = CommandPart::bytes_max(payload.left());
            let start = usize::try_from(gap.start() - 1).unwrap_or(usize::MAX);
            let end = usize::try_from(*gap.end()).unwrap_or(usize::MAX).min(start + bytes_max);
            let is_last = end as u64 == *gap.end();
            if bytes_max < PART_MIN && !(is_last && bytes_max > 0) {
                return false;
            }
            let Some(bytes) = body.get(start..end).filter(|bytes| !bytes.is_empty()) else { break };
            let offset = u32::try_from(start).unwrap_or(u32::MAX);
            payload.fitting_frame(&Frame::CommandPart(CommandPart { id, length, offset, bytes }));
            self.sent.insert(*gap.start()..=end as u64);
        }
        self.is_round_over = true;
        true
    }
}
