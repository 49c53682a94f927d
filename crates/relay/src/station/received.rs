//! Content of a robot's datagram in the types of the station, and the content that arrives before its run is open.

use super::disk::OpenRun;
use super::viewers::Shared;
use crate::words::ReportedRunState;
use crate::{sent_snapshot, watch_words};
use rafcon_link::{
    CommandId, CommandState, EventHash, FromRobot, KeyId, NoValue, PairingKey, StreamId, ValueId,
};
use rafcon_protocol::{Snapshot, WatchedValue};
use rafcon_storage::journal::EventBlock;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Capacity of the statuses of runs that are not open yet: the session opens no more streams.
const REPORTED_MAX: usize = 4_096;
/// Capacity of their snapshots. Of more the newest are dropped: a run is shown once its state changes.
const SNAPSHOTS_MAX: usize = 64;

/// Content of a datagram, applied after the borrow of the session ends.
pub(super) enum Received {
    Events(StreamId, EventBlock),
    /// State of a run, and the hash of its events with the time of the robot's session.
    Stands(StreamId, ReportedRunState, Option<(u64, EventHash)>),
    Snapshot(StreamId, Box<Snapshot>),
    NewKey(KeyId, PairingKey),
    State(CommandId, CommandState, String),
    Started,
    Watched(StreamId, Vec<WatchedValue>),
    Part(ValueId, u64, Vec<u8>),
    NoValue(ValueId, NoValue),
}

impl Received {
    /// `None` if it cannot be parsed.
    pub(super) fn of(shown: FromRobot<'_>) -> Option<Self> {
        Some(match shown {
            FromRobot::Events { stream, block } => Self::Events(stream, block.to_block()),
            FromRobot::Status { stream, state, chain, at_ms, .. } => {
                let reported = serde_json::from_slice(state).unwrap_or_default();
                Self::Stands(stream, reported, chain.map(|chain| (at_ms, chain)))
            }
            FromRobot::Snapshot { stream, bytes, .. } => {
                Self::Snapshot(stream, Box::new(sent_snapshot::read(&bytes)?))
            }
            FromRobot::CommandState { id, state, reason } => {
                Self::State(id, state, String::from_utf8_lossy(reason).into_owned())
            }
            FromRobot::NewKey { id, key } => Self::NewKey(id, key),
            FromRobot::Started => Self::Started,
            FromRobot::Watched { stream, values, .. } => {
                let read = |bytes: &Vec<u8>| watch_words::read_value(bytes);
                Self::Watched(stream, values.iter().filter_map(read).collect())
            }
            FromRobot::ValuePart { id, offset, bytes } => Self::Part(id, offset, bytes.to_vec()),
            FromRobot::NoValue { id, why } => Self::NoValue(id, why),
        })
    }
}

/// A run that is open to viewers.
pub(super) struct StationRun {
    pub(super) id: String,
    pub(super) shared: Arc<Shared>,
    pub(super) safe: u64,
    /// Last reported epoch of authority.
    pub(super) epoch: u64,
    pub(super) is_over: bool,
    /// The disk was asked to close it.
    pub(super) is_closing: bool,
}

impl StationRun {
    pub(super) fn new(OpenRun { id, safe, shared }: OpenRun) -> Self {
        Self { id, shared, safe, epoch: 0, is_over: false, is_closing: false }
    }
}

/// Last content of runs that are not open yet. The robot does not repeat it soon.
#[derive(Default)]
pub(super) struct Early {
    reported: BTreeMap<StreamId, ReportedRunState>,
    snapshots: BTreeMap<StreamId, Snapshot>,
}

impl Early {
    pub(super) fn reported(&mut self, run: StreamId, reported: ReportedRunState) {
        if self.reported.len() < REPORTED_MAX || self.reported.contains_key(&run) {
            self.reported.insert(run, reported);
        }
    }

    pub(super) fn snapshot(&mut self, run: StreamId, snapshot: Snapshot) {
        if self.snapshots.len() < SNAPSHOTS_MAX || self.snapshots.contains_key(&run) {
            self.snapshots.insert(run, snapshot);
        }
    }

    /// A run is open now, or never will be.
    pub(super) fn take(&mut self, run: StreamId) -> (Option<ReportedRunState>, Option<Snapshot>) {
        (self.reported.remove(&run), self.snapshots.remove(&run))
    }
}
