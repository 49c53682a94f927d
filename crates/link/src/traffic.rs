//! Sent and received bytes of a side, by type of frame.

use crate::frame::Frame;
use crate::profile::CARRIER_OVERHEAD;
use std::collections::BTreeMap;

/// The datagrams of one direction since the session began.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Traffic {
    /// Number of datagrams, of all types.
    pub datagrams: u64,
    /// Their bytes, with the headers of IP and UDP.
    pub bytes: u64,
    /// The bytes of frames, by their kind. What is not among them are the headers.
    pub by_kind: BTreeMap<&'static str, u64>,
}

impl Traffic {
    /// Counts a datagram of this length.
    pub(crate) fn count_datagram(&mut self, length: usize) {
        self.datagrams += 1;
        self.bytes += (length + CARRIER_OVERHEAD) as u64;
    }

    /// Counts a frame of that datagram.
    pub(crate) fn count_frame(&mut self, kind: &'static str, length: usize) {
        *self.by_kind.entry(kind).or_default() += length as u64;
    }
}

impl Frame<'_> {
    /// Its kind, as people call it.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Events { stream, .. }
            | Self::Coded { stream, .. }
            | Self::Large { stream, .. }
                if stream.is_files() =>
            {
                "machines"
            }
            Self::Events { .. } | Self::Coded { .. } | Self::Large { .. } => "events",
            Self::Status { .. } => "status",
            Self::Snapshot { .. } | Self::CodedSnapshot { .. } => "snapshots",
            Self::CommandState { .. } | Self::PartsHere(_) => "states of commands",
            Self::Calendar { .. } | Self::Heard { .. } => "clocks",
            Self::NewKey { .. } => "keys",
            Self::Command(_) | Self::CommandPart(_) => "commands",
            Self::Arrived { .. } | Self::Received(_) => "reports",
            Self::Value(frame) => frame.kind(),
        }
    }
}
