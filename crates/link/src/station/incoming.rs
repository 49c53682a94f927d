//! An open stream: what is here of it, and what it needs to be decoded.

use super::large::LargeEvents;
use super::streams::Settled;
use crate::assembly::{Assembly, LENGTH_MAX};
use crate::coding::{Contexts, LastCoder, OfferedSnapshots};
use crate::deflate::inflate;
use crate::frame::Packing;
use crate::range_set::RangeSet;
use crate::session_time::SessionTime;

/// A report of a run that is over and complete is sent this often after the last news of it.
pub(super) const LAST_REPORTS: u8 = 8;
/// Capacity of a run in gaps. Events beyond another gap are treated as lost.
pub(crate) const GAPS_MAX: usize = 4_096;
/// Capacity of incomplete items, in bytes.
pub(crate) const PARTS_MAX: usize = 64 << 20;

#[derive(Debug, Default)]
pub(super) struct Incoming {
    pub(super) received: RangeSet,
    pub(super) safe: u64,
    pub(super) head: u64,
    pub(super) is_over: bool,
    pub(super) snapshot: Assembly,
    pub(super) snapshot_sequence: u64,
    pub(super) large: LargeEvents,
    pub(super) contexts: Contexts,
    pub(super) coder: LastCoder,
    pub(super) snapshots: OfferedSnapshots,
    /// Number of remaining reports.
    pub(super) reports: u8,
    /// When the robot named it last.
    pub(super) named_at: SessionTime,
}

impl Incoming {
    /// Reopens a settled stream.
    pub(super) fn resumed(Settled { events, is_over }: Settled) -> Self {
        let received = RangeSet::up_to(events);
        let (safe, head, reports) = (events, events, LAST_REPORTS);
        Self { received, safe, head, is_over, reports, ..Self::default() }
    }

    /// The items of an event of which all parts are here. `None` if they cannot be decoded: the robot sends the event again.
    pub(super) fn unpack(&mut self, packing: Packing, packed: Vec<u8>) -> Option<Vec<u8>> {
        match packing {
            Packing::Plain => Some(packed),
            Packing::Deflated => inflate(&packed, LENGTH_MAX as usize),
            Packing::Coded { context, length } => {
                let known = self.contexts.find(context)?;
                self.coder.with(context, known).decode(&packed, length as usize)
            }
        }
    }

    pub(super) fn is_complete(&self) -> bool {
        self.is_over && self.received.contiguous() >= self.head
    }
}
