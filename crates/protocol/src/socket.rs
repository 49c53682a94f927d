//! Frames between clients (browsers, programs) and the server over one WebSocket: one JSON object per text frame.
//!
//! A subscription is one of two kinds. A *history* delivers every entry from a cursor on, at the reader's pace. After a break the
//! reader subscribes again from its last cursor. A *status* delivers the newest state: the first change at once, then at most one
//! update every 100 ms.

use crate::api::{
    Before, CommandAnswer, EditMachine, HistoryEntry, MachineStatus, Refusal, Revision, RunNow,
    ServerStatus, Session, Undo,
};
use crate::{Envelope, WatchTarget, WatchedValue, Watching};
use serde::{Deserialize, Serialize};

/// Version of this protocol. New fields and frames do not change it: clients ignore unknown ones.
pub const VERSION: u32 = 2;

/// From a client to the server.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "frame", rename_all = "snake_case")]
pub enum ToServer {
    /// Start to receive a topic.
    Subscribe {
        /// Number of the subscription, chosen by the client. A number in use is refused.
        subscription: u32,
        /// Topic of the subscription.
        topic: Topic,
    },
    /// End a subscription. The server replies with [`ToClient::Ended`].
    Unsubscribe {
        /// Number of the subscription.
        subscription: u32,
    },
    /// Send a command to a run. The server replies with [`ToClient::Answer`].
    Command {
        /// Id of the run.
        run: String,
        /// The command. The server sets its author.
        envelope: Envelope,
    },
    /// Edit an open machine. The server replies with [`ToClient::Edited`] or [`ToClient::Refused`].
    Edit {
        /// Id of the machine.
        machine: String,
        /// The edit to apply.
        edit: EditMachine,
    },
    /// Undo the client's own last step. The replies are those of an edit.
    Undo {
        /// Id of the machine.
        machine: String,
        /// The request, with the id of the undo.
        undo: Undo,
    },
    /// Redo the step that was undone. The replies are those of an edit.
    Redo {
        /// Id of the machine.
        machine: String,
        /// The request, with the id of the redo.
        redo: Undo,
    },
    /// Report this client's selection to the other clients.
    Presence {
        /// Id of the machine.
        machine: String,
        /// Paths of the selected states.
        selection: Vec<String>,
    },
    /// Check the connection. It also counts as a sign of life of the user in control.
    Ping {
        /// Id that the pong repeats.
        id: u64,
    },
}

/// Topic of a subscription.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "topic", rename_all = "snake_case")]
pub enum Topic {
    /// Every event of a run.
    RunHistory {
        /// Id of the run.
        run: String,
        /// First event that the client has not seen, counted from 1.
        #[serde(default)]
        from: u64,
        /// True to include values.
        #[serde(default)]
        values: bool,
    },
    /// Events of a run from one event on, without values. If there are too many, only the newest, after a frame `skipped`.
    RunNewest {
        /// Id of the run.
        run: String,
        /// First event that the client has not seen, counted from 1.
        from: u64,
        /// Number of events from `from` on above which older ones are skipped.
        most: u64,
        /// Number of newest events to send in that case.
        newest: u64,
    },
    /// Status of a run.
    RunStatus {
        /// Id of the run.
        run: String,
    },
    /// Newest values of a robot's run, at its station. They can arrive before their events. In other runs values come with their
    /// events.
    RunWatched {
        /// Id of the run.
        run: String,
        /// Values that the client watches.
        targets: Vec<WatchTarget>,
    },
    /// Every revision of an open machine.
    MachineHistory {
        /// Id of the machine.
        machine: String,
        /// First revision that the client has not seen.
        from: u64,
    },
    /// Status of an open machine, and its current viewers.
    MachineStatus {
        /// Id of the machine.
        machine: String,
    },
    /// Status of the whole server.
    ServerStatus,
}

/// From the server to a client.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "frame", rename_all = "snake_case")]
pub enum ToClient {
    /// The first frame of a connection.
    Welcome {
        /// Version of the server's protocol ([`VERSION`]).
        protocol: u32,
        /// Session of the client: user and rights.
        session: Session,
        /// Number of the connection, as other clients see it.
        connection: u64,
        /// The server's clock: ms since 1970, UTC.
        now_ms: u64,
    },
    /// Events of a run without a gap. The first is the requested one, or follows the last event of the previous frame.
    Events {
        /// Number of the subscription.
        subscription: u32,
        /// Cursor for the next subscription after a break. Without values some event numbers are missing, so the last event does
        /// not give it.
        next: u64,
        /// Events in order. One empty list marks the end of the existing events.
        events: Vec<HistoryEntry>,
    },
    /// Older events of a run are skipped. The next event sent is the one after `before`.
    Skipped {
        /// Number of the subscription.
        subscription: u32,
        /// States that are active after the last skipped event.
        before: Before,
    },
    /// Revisions of a machine, without a gap.
    Revisions {
        /// Number of the subscription.
        subscription: u32,
        /// The revisions, the oldest first.
        revisions: Vec<Revision>,
    },
    /// The requested revisions no longer exist, so the subscription ends. The client fetches the whole machine and subscribes again
    /// from its revision.
    Reset {
        /// Number of the subscription.
        subscription: u32,
        /// Current revision of the machine.
        revision: u64,
    },
    /// Status of a run.
    RunStatus {
        /// Number of the subscription.
        subscription: u32,
        /// Current status of the run.
        status: Box<RunNow>,
    },
    /// Newest values that the client watches.
    RunWatched {
        /// Number of the subscription.
        subscription: u32,
        /// Acknowledgement of the targets by the robot. Empty if the run is not that of a robot.
        watching: Option<Watching>,
        /// New values, at most 256. Each also comes with its event.
        values: Vec<WatchedValue>,
    },
    /// Status of a machine.
    MachineStatus {
        /// Number of the subscription.
        subscription: u32,
        /// Current status of the machine.
        status: MachineStatus,
    },
    /// Status of the server.
    ServerStatus {
        /// Number of the subscription.
        subscription: u32,
        /// Current status of the server.
        status: ServerStatus,
    },
    /// The subscription ended: the run is over and fully sent, the machine was closed, or the subscription was cancelled or
    /// refused.
    Ended {
        /// Number of the subscription.
        subscription: u32,
        /// Reason, if the subscription was refused.
        refusal: Option<Refusal>,
    },
    /// Result of a command.
    Answer(CommandAnswer),
    /// An edit, undo or redo was applied.
    Edited {
        /// Id of the request.
        id: String,
        /// Revision that the request created.
        revision: u64,
    },
    /// A command, edit or frame was refused before it had any effect.
    Refused {
        /// Id of the request, if it has one.
        id: Option<String>,
        /// Reason for the refusal.
        refusal: Refusal,
    },
    /// The answer to a ping.
    Pong {
        /// Id of the ping.
        id: u64,
        /// The server's clock: ms since 1970, UTC.
        now_ms: u64,
    },
}
