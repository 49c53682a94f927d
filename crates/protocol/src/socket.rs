//! What browsers and programs say to the server over one WebSocket, and what they are told: one JSON object a text frame.
//!
//! Two kinds of subscription. A *history* is told whole, from a cursor on, at the reader's pace: after a break the reader
//! subscribes again from where it was. A *status* is the latest truth: the first change at once, then one in 100 ms.

use crate::api::{
    Before, CommandAnswer, EditMachine, HistoryEntry, MachineStatus, Refusal, Revision, RunNow,
    ServerStatus, Session, Undo,
};
use crate::{Envelope, WatchTarget, WatchedValue, Watching};
use serde::{Deserialize, Serialize};

/// The version of this vocabulary. New fields and frames do not change it: a client ignores what it does not know.
pub const VERSION: u32 = 2;

/// From a client to the server.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "frame", rename_all = "snake_case")]
pub enum ToServer {
    /// Tell me, under this number of my choice.
    Subscribe {
        /// Named in the news; a number that is in use is refused.
        subscription: u32,
        /// What about.
        topic: Topic,
    },
    /// Tell me no more; answered by [`ToClient::Ended`].
    Unsubscribe {
        /// The number.
        subscription: u32,
    },
    /// A command for a run; answered by [`ToClient::Answer`].
    Command {
        /// The run's id.
        run: String,
        /// The command. Its author is set by the server.
        envelope: Envelope,
    },
    /// An edit of an open machine; answered by [`ToClient::Edited`] or [`ToClient::Refused`].
    Edit {
        /// The machine's id.
        machine: String,
        /// The edit.
        edit: EditMachine,
    },
    /// Takes one's own last step back; answered as an edit.
    Undo {
        /// The machine's id.
        machine: String,
        /// The request.
        undo: Undo,
    },
    /// Makes it again; answered as an edit.
    Redo {
        /// The machine's id.
        machine: String,
        /// The request.
        redo: Undo,
    },
    /// What this client looks at, for the others.
    Presence {
        /// The machine's id.
        machine: String,
        /// Paths of the selected states.
        selection: Vec<String>,
    },
    /// Are you there? Also: I am here, for a holder of control.
    Ping {
        /// Comes back.
        id: u64,
    },
}

/// What a subscription is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "topic", rename_all = "snake_case")]
pub enum Topic {
    /// Every event of a run.
    RunHistory {
        /// The run's id.
        run: String,
        /// The first event that the client has not seen; counts from 1.
        #[serde(default)]
        from: u64,
        /// Whether events come with values.
        #[serde(default)]
        values: bool,
    },
    /// Every event of a run from one on, without values; if they are very many, only the newest, after a frame `skipped`.
    RunNewest {
        /// The run's id.
        run: String,
        /// The first event that the client has not seen; counts from 1.
        from: u64,
        /// So many events are told from there on.
        most: u64,
        /// If there are more, so many of the newest.
        newest: u64,
    },
    /// How a run stands.
    RunStatus {
        /// The run's id.
        run: String,
    },
    /// The newest values of a robot's run, at its station: those that are known before their events are here. Values of other runs
    /// come with their events.
    RunWatched {
        /// The run's id.
        run: String,
        /// What the client watches.
        targets: Vec<WatchTarget>,
    },
    /// Every revision of an open machine.
    MachineHistory {
        /// The machine's id.
        machine: String,
        /// The first revision that the client has not seen.
        from: u64,
    },
    /// How an open machine stands, and who looks at it.
    MachineStatus {
        /// The machine's id.
        machine: String,
    },
    /// Everything that the server looks after.
    ServerStatus,
}

/// From the server to a client.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "frame", rename_all = "snake_case")]
pub enum ToClient {
    /// The first frame.
    Welcome {
        /// The version of this vocabulary.
        protocol: u32,
        /// Who the client is.
        session: Session,
        /// The connection's number, as others see it.
        connection: u64,
        /// The server's clock: ms since 1970, UTC.
        now_ms: u64,
    },
    /// Events of a run, without gap: the first is the one that was asked for, or follows the last of the frame before.
    Events {
        /// Of this subscription.
        subscription: u32,
        /// Where the client continues after a break. Without values some numbers are left out, and this says how far it is told.
        next: u64,
        /// In order. Empty once: everything that there is so far has been told.
        events: Vec<HistoryEntry>,
    },
    /// Earlier events of a run are not told: the next that comes is the one behind.
    Skipped {
        /// Of this subscription.
        subscription: u32,
        /// What was active by then.
        before: Before,
    },
    /// Revisions of a machine, without gap.
    Revisions {
        /// Of this subscription.
        subscription: u32,
        /// In order.
        revisions: Vec<Revision>,
    },
    /// The revisions that were asked for are gone, and so the subscription has come to its end: get the whole machine, and
    /// subscribe again from there.
    Reset {
        /// Of this subscription.
        subscription: u32,
        /// The revision of the machine now.
        revision: u64,
    },
    /// How a run stands.
    RunStatus {
        /// Of this subscription.
        subscription: u32,
        /// The truth.
        status: Box<RunNow>,
    },
    /// The newest of what the client watches.
    RunWatched {
        /// Of this subscription.
        subscription: u32,
        /// Whether the robot knows what is watched; none if the run is not that of a robot.
        watching: Option<Watching>,
        /// The values, at most 256; each also comes with its event.
        values: Vec<WatchedValue>,
    },
    /// How a machine stands.
    MachineStatus {
        /// Of this subscription.
        subscription: u32,
        /// The truth.
        status: MachineStatus,
    },
    /// How the server stands.
    ServerStatus {
        /// Of this subscription.
        subscription: u32,
        /// The truth.
        status: ServerStatus,
    },
    /// Nothing more will come: a run is over and told, a machine closed, the subscription was given up or refused.
    Ended {
        /// Of this subscription.
        subscription: u32,
        /// Why, if it was refused.
        refusal: Option<Refusal>,
    },
    /// What became of a command.
    Answer(CommandAnswer),
    /// An edit, undo or redo was made.
    Edited {
        /// Its id.
        id: String,
        /// The revision that it made.
        revision: u64,
    },
    /// A command, edit or frame was refused before anyone acted on it.
    Refused {
        /// Its id, if it has one.
        id: Option<String>,
        /// Why.
        refusal: Refusal,
    },
    /// The answer to a ping.
    Pong {
        /// What the ping said.
        id: u64,
        /// The server's clock: ms since 1970, UTC.
        now_ms: u64,
    },
}
