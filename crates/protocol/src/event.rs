//! What a run tells its viewers.

use serde::{Deserialize, Serialize};

/// The outcome of a state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// Its id in the state.
    pub id: i64,
    /// Its name.
    pub name: String,
}

/// How much a log line matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogLevel {
    /// Below debug.
    Verbose,
    /// For whoever looks for a fault.
    Debug,
    /// For everybody.
    Info,
    /// Could be wrong.
    Warning,
    /// Is wrong.
    Error,
}

/// Where script output came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stream {
    /// `sys.stdout`
    Stdout,
    /// `sys.stderr`
    Stderr,
    /// A logger.
    Logger,
    /// The engine's own notes.
    Engine,
}

/// One event of a run. Paths are state ids joined by `/`; values are encoded as `docs/protocol.md` says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Event {
    /// A state began.
    Entered {
        /// The state.
        path: String,
    },
    /// A state ended.
    Left {
        /// The state.
        path: String,
        /// How.
        outcome: Outcome,
    },
    /// A line of a script or of the engine.
    Log {
        /// The state that wrote it; empty if none did.
        path: String,
        /// How much it matters.
        level: LogLevel,
        /// Where it came from.
        stream: Stream,
        /// The text, without the newline at its end.
        message: String,
    },
    /// A state cannot go on until the machine is changed or stopped.
    Waiting {
        /// The state.
        path: String,
        /// For what, and the way out.
        reason: String,
    },
    /// The run was paused or goes on.
    Paused {
        /// Whether it is paused now.
        paused: bool,
    },
    /// The run was asked to stop.
    Stopping,
    /// The run is over.
    Finished {
        /// The root's outcome.
        outcome: Outcome,
        /// The root's outputs by port name.
        outputs: serde_json::Map<String, serde_json::Value>,
        /// The global variables at the end.
        globals: serde_json::Map<String, serde_json::Value>,
        /// The root's scoped variables at the end, by name.
        scoped_variables: serde_json::Map<String, serde_json::Value>,
        /// States run; library states are not counted, the roots of their content are.
        states_run: u64,
    },
}

/// What a run is doing as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunStatus {
    /// Scripts run.
    Running,
    /// Hierarchies hold before their next child.
    Paused,
    /// Asked to stop, states are ending.
    Stopping,
    /// Over.
    Finished,
}

/// What one active state is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Its script or its children run.
    Running,
    /// It cannot go on.
    Waiting,
    /// Held by a pause.
    Held,
    /// Asked to end.
    Preempted,
}

/// One active state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ActiveState {
    /// Ids joined by `/`.
    pub path: String,
    /// Its name.
    pub name: String,
    /// What it does.
    pub phase: Phase,
    /// Time since it was entered, in ms.
    pub since_ms: u64,
}

/// The latest truth about a run: coalesced, at most every 100 ms.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Snapshot {
    /// The run as a whole.
    pub status: RunStatus,
    /// Active states, a parent before its children.
    pub active: Vec<ActiveState>,
    /// States run so far.
    pub states_run: u64,
    /// Time since the start, in ms.
    pub elapsed_ms: u64,
}
