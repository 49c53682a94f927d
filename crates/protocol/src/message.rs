//! Everything that is said after the hello.

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
    /// What to run; the first message after the hello.
    Launch(Launch),
    /// Join a run that is going on; the first message after the hello instead of a launch.
    Join(Join),
    /// A command.
    Command(Envelope),
    /// A question about one active state.
    Inspect {
        /// Named in the answer.
        id: String,
        /// The state.
        path: String,
    },
    /// A wish about control of a run far away: its robot decides. Answered like a command; for stations only.
    MoveControl {
        /// Named in the answer.
        id: String,
        /// Who wants it.
        author: String,
        /// What.
        wanted: ControlMove,
    },
    /// This user, who holds control of a run far away, is here. For stations only.
    Present {
        /// The user.
        user: String,
    },
    /// Whoever carries the run to the ground says when the ground was heard: policies of states count from there.
    Ground {
        /// How long ago, in ms; `None`: not since the sender began, which is no news.
        heard_ms_ago: Option<u64>,
    },
    /// Which values of a run far away this viewer watches from now on. For stations only: a runner tells of its values by events.
    Watch {
        /// What, in place of what was watched before.
        targets: Vec<WatchTarget>,
    },
    /// Are you there?
    Ping {
        /// Named in the answer.
        id: u64,
    },
}

/// What a viewer that joins wants to be told.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Join {
    /// The number of the first event that it has not seen; 0: from now on.
    #[serde(default)]
    pub from: u64,
    /// Whether it wants every event, or only snapshots and what is rare.
    #[serde(default)]
    pub every_event: bool,
}

/// From the runner to a viewer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "snake_case")]
pub enum ToViewer {
    /// The machine could not be loaded; the runner ends.
    LoadFailed {
        /// What, where, and the way out.
        reason: String,
    },
    /// The machine was loaded and the run begins.
    Loaded {
        /// The root state's name.
        name: String,
        /// States of the machine.
        states: u64,
        /// Faults of the machine, one line each, that did not keep it from loading.
        problems: Vec<String>,
        /// The run's id: the name of its folder; empty if it has none.
        #[serde(default)]
        run: String,
    },
    /// What one active state holds.
    Inspection {
        /// The id of the request.
        id: String,
        /// The state.
        path: String,
        /// Its data; `None` if it is not active.
        data: Option<StateData>,
    },
    /// Something happened. Runners send events as bytes ([`crate::FrameKind::Events`]); this is one that was read.
    #[serde(skip)]
    Event {
        /// Counts from 1, without gaps.
        sequence: u64,
        /// Time since the start of the run by a monotonic clock, in ns.
        t_ns: u64,
        /// What.
        event: Event,
    },
    /// How things stand.
    Snapshot(Snapshot),
    /// Who holds control of a run far away, as its robot says. Of stations only.
    Control(Control),
    /// The newest of those values that the viewer watches, and whether its robot knows what is watched. Of stations only.
    Watched {
        /// Whether the robot knows.
        watching: Watching,
        /// Values that are new.
        values: Vec<WatchedValue>,
    },
    /// What became of a command.
    Answer {
        /// The command's id.
        id: String,
        /// The answer.
        #[serde(flatten)]
        answer: Answer,
    },
    /// The runner is there: the answer to a ping.
    Pong {
        /// The id of the ping.
        id: u64,
        /// The runner's clock: ms since 1970, UTC.
        now_ms: u64,
        /// Whether the engine takes inputs; runners of other builds may not say.
        #[serde(default)]
        engine: Option<EnginePulse>,
        /// How the link to the robot is, if it is a station that answers for the runner.
        #[serde(default)]
        link: Option<Box<LinkHealth>>,
    },
}

/// Whether the engine of a run takes inputs, as the runner found out for this answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct EnginePulse {
    /// For how long the engine could not be reached, in ms; 0: it was reached just now. While it cannot be, nothing moves on and
    /// no command is carried out.
    pub unreached_ms: u64,
    /// How long ago the engine moved last, in ms: long if the scripts that run take long, or all wait.
    pub still_ms: u64,
    /// How many scripts run; not known while the engine cannot be reached.
    #[serde(default)]
    pub scripts: Option<u32>,
}

impl EnginePulse {
    /// An engine that could not be reached for so long stands still, in ms.
    const STILL_AFTER_MS: u64 = 3_000;

    /// Whether the engine counts as reached by this answer: one that was does so for three seconds, one that was not only once
    /// it is reached just now.
    pub fn is_reached(self, was_reached: bool) -> bool {
        if was_reached { self.unreached_ms < Self::STILL_AFTER_MS } else { self.unreached_ms == 0 }
    }
}

/// The data of one active state, by port name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StateData {
    /// Its inputs.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub inputs: Values,
    /// The defaults of its outputs.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub outputs: Values,
    /// Its scoped variables, if it is a container.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub scoped_variables: Values,
}
