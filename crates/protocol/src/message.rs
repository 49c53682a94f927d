//! Messages after the hello.

use crate::api::{Control, ControlMove};
use crate::{
    Answer, Envelope, Event, Launch, LinkHealth, Snapshot, Values, WatchTarget, WatchedValue,
    Watching,
};
use serde::{Deserialize, Serialize};

/// From a viewer (command line, server) to the runner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "snake_case")]
pub enum ToRunner {
    /// Start a run. The first message after the hello.
    Launch(Launch),
    /// Join an active run. The first message after the hello, instead of a launch.
    Join(Join),
    /// Send a command to the run.
    Command(Envelope),
    /// Request the data of one active state.
    Inspect {
        /// Id that the reply repeats.
        id: String,
        /// Path of the state.
        path: String,
    },
    /// Request a change of control of a remote run. Its robot decides and replies as to a command. Only stations accept it.
    MoveControl {
        /// Id that the reply repeats.
        id: String,
        /// User who makes the request.
        author: String,
        /// The requested change of control.
        wanted: ControlMove,
    },
    /// Report that the user in control of a remote run is present. Only stations accept it.
    Present {
        /// Name of the user.
        user: String,
    },
    /// Report the last contact with the ground, from the program that carries the run to it. Policies of states count from there.
    Ground {
        /// Time since the last contact, in ms. `None` if the sender has had no contact yet; the runner then changes nothing.
        heard_ms_ago: Option<u64>,
    },
    /// Set the values of a remote run that this viewer watches. Only stations accept it; runners send values in events.
    Watch {
        /// Targets that replace the previous ones.
        targets: Vec<WatchTarget>,
    },
    /// Check that the runner responds.
    Ping {
        /// Id that the pong repeats.
        id: u64,
    },
}

/// Start and extent of what a joining viewer receives.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Join {
    /// Number of the first event that the viewer has not seen. 0 for new events only.
    #[serde(default)]
    pub from: u64,
    /// True for every event. False for snapshots and rare events only.
    #[serde(default)]
    pub every_event: bool,
}

/// From the runner to a viewer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "snake_case")]
pub enum ToViewer {
    /// The machine could not be loaded; the runner ends.
    LoadFailed {
        /// Cause, location and remedy.
        reason: String,
    },
    /// The machine was loaded, and the run begins.
    Loaded {
        /// Name of the root state.
        name: String,
        /// Number of states of the machine.
        states: u64,
        /// Faults of the machine that did not prevent loading, one line each.
        problems: Vec<String>,
        /// Id of the run: the name of its folder. Empty if it has no folder.
        #[serde(default)]
        run: String,
    },
    /// Data of one active state.
    Inspection {
        /// Id of the request.
        id: String,
        /// Path of the state.
        path: String,
        /// Data of the state. `None` if it is not active.
        data: Option<StateData>,
    },
    /// An event. Runners send events as bytes ([`crate::FrameKind::Events`]); this variant holds a decoded one.
    #[serde(skip)]
    Event {
        /// Sequence number, counted from 1 without gaps.
        sequence: u64,
        /// Time since the start of the run by a monotonic clock, in ns.
        t_ns: u64,
        /// Content of the event, without number and time.
        event: Event,
    },
    /// Current status of the run.
    Snapshot(Snapshot),
    /// Control of a remote run, as reported by its robot. Only stations send it.
    Control(Control),
    /// Newest watched values, and whether the robot has the list of targets. Only stations send it.
    Watched {
        /// Acknowledgement of the targets by the robot.
        watching: Watching,
        /// Values that are new.
        values: Vec<WatchedValue>,
    },
    /// Result of a command.
    Answer {
        /// Id of the command.
        id: String,
        /// Result of the command.
        #[serde(flatten)]
        answer: Answer,
    },
    /// Reply to a ping.
    Pong {
        /// Id of the ping.
        id: u64,
        /// The runner's clock: ms since 1970, UTC.
        now_ms: u64,
        /// Responsiveness of the engine. Runners of other builds may omit it.
        #[serde(default)]
        engine: Option<EnginePulse>,
        /// Health of the link to the robot, if a station replies for the runner.
        #[serde(default)]
        link: Option<Box<LinkHealth>>,
    },
}

/// Responsiveness of a run's engine, measured for this reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct EnginePulse {
    /// Time since the engine was last reachable, in ms. 0 if it responded just now. An unreachable engine makes no progress and
    /// executes no commands.
    pub unreached_ms: u64,
    /// Time since the engine last made progress, in ms. High while long scripts run or all states wait.
    pub still_ms: u64,
    /// Number of running scripts. Empty while the engine is unreachable.
    #[serde(default)]
    pub scripts: Option<u32>,
}

impl EnginePulse {
    /// Time without response after which an engine counts as stuck, in ms.
    const STILL_AFTER_MS: u64 = 3_000;

    /// Returns true if the engine counts as reachable. A reachable engine stays so for three seconds without response. An
    /// unreachable one must respond to this ping.
    pub fn is_reached(self, was_reached: bool) -> bool {
        if was_reached { self.unreached_ms < Self::STILL_AFTER_MS } else { self.unreached_ms == 0 }
    }
}

/// The data of one active state, by port name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StateData {
    /// Inputs by port name.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub inputs: Values,
    /// The defaults of its outputs.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub outputs: Values,
    /// Its scoped variables, if it is a container.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub scoped_variables: Values,
}
