//! Messages of a robot, as its station receives them.

use crate::frame::{CommandId, CommandState, EventHash, NoValue, StreamId, ValueId};
use crate::seal::{KeyId, PairingKey};
use rafcon_events::EventBlockRef;

/// Received content.
#[derive(Debug, PartialEq, Eq)]
pub enum FromRobot<'b> {
    /// The robot has restarted, or this is its first datagram. Earlier reports of commands and clocks are void.
    Started,
    /// Events of which at least one is new.
    Events {
        /// The run.
        stream: StreamId,
        /// The events.
        block: EventBlockRef<'b>,
    },
    /// Progress of a run.
    Status {
        /// The run.
        stream: StreamId,
        /// The number of its last event.
        head: u64,
        /// True if the run has ended.
        is_over: bool,
        /// Snapshot of the run.
        state: &'b [u8],
        /// The hash of all events up to one of the newest.
        chain: Option<EventHash>,
        /// When it was so, in ms of the robot's session.
        at_ms: u64,
    },
    /// The state of a run.
    Snapshot {
        /// The run.
        stream: StreamId,
        /// After this event.
        sequence: u64,
        /// The state.
        bytes: Vec<u8>,
    },
    /// The robot offers this key.
    NewKey {
        /// Its number.
        id: KeyId,
        /// The key.
        key: PairingKey,
    },
    /// Fate of a command.
    CommandState {
        /// Its id.
        id: CommandId,
        /// Fate of the command.
        state: CommandState,
        /// Reason of a refusal.
        reason: &'b [u8],
    },
    /// The newest values of those that are watched.
    Watched {
        /// The run.
        stream: StreamId,
        /// Number of the list in force.
        number: u64,
        /// Each with its name, in the words of the servers.
        values: Vec<Vec<u8>>,
    },
    /// Bytes of a large value that were not here.
    ValuePart {
        /// The value.
        id: ValueId,
        /// Offset of the bytes.
        offset: u64,
        /// The bytes.
        bytes: &'b [u8],
    },
    /// A large value, or the rest of it, does not come.
    NoValue {
        /// The value.
        id: ValueId,
        /// Reason of the refusal.
        why: NoValue,
    },
}
