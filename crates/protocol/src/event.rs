//! What a run tells its viewers.

use crate::{Answer, Breakpoint, Closing, Crash, Envelope, OnCrash, Question};
use serde::{Deserialize, Serialize};

/// Values by name, each as `docs/protocol.md` encodes it.
pub type Values = serde_json::Map<String, serde_json::Value>;

/// What holds a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum HeldBy {
    /// A pause.
    Pause,
    /// A step has come to its end.
    Step,
    /// The state that it was to run to.
    RunTo,
    /// A breakpoint.
    Breakpoint {
        /// Its id.
        id: u64,
    },
    /// It is where the run, or its branch, begins.
    Start,
    /// The policy of a state: nobody on the ground was heard for too long.
    Loss {
        /// By which measure.
        loss: Loss,
    },
}

/// What a run has lost when nobody commands it any more (`docs/semantics.md`, Lost link).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Loss {
    /// The ground is not heard.
    Link,
    /// No command comes.
    Command,
}

/// The outcome of a state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Outcome {
    /// Its id in the state.
    pub id: i64,
    /// Its name.
    pub name: String,
}

/// How much a log line matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LogLevel {
    /// Below debug.
    Verbose,
    /// For whoever looks for a fault.
    Debug,
    /// For everyone.
    Info,
    /// Could be wrong.
    Warning,
    /// Is wrong.
    Error,
}

/// Where script output came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
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
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Event {
    /// A state began.
    Entered {
        /// The state.
        path: String,
        /// Its inputs by port name, if they are kept and were asked for.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
        inputs: Option<Values>,
        /// It is entered backwards, to undo the entry with this number (counted from 1 over all entries of the run).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        undoes: Option<u64>,
    },
    /// A state ended.
    Left {
        /// The state.
        path: String,
        /// How.
        outcome: Outcome,
        /// Its outputs by port name, if they are kept and were asked for. Ports that its script left out are missing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
        outputs: Option<Values>,
        /// Its error, if it left one; in few words if no values were asked for.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        error: Option<serde_json::Value>,
        /// It is left backwards: to where it stood before the entry with this number.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        undoes: Option<u64>,
    },
    /// A scoped variable got a value.
    Scoped {
        /// The container.
        path: String,
        /// The variable's name.
        name: String,
        /// Its value.
        value: serde_json::Value,
    },
    /// A global variable got a value, or was deleted.
    Global {
        /// Its name.
        name: String,
        /// Its value; `None` if it was deleted.
        value: Option<serde_json::Value>,
    },
    /// What a state keeps from one run to the next changed.
    Persistent {
        /// The state.
        path: String,
        /// All of it.
        value: serde_json::Value,
    },
    /// A branch is held.
    Held {
        /// The container that is held.
        path: String,
        /// The state before which it is held, if there is one.
        next: Option<String>,
        /// By what.
        by: HeldBy,
    },
    /// A breakpoint was passed while its condition was true.
    Hit {
        /// The breakpoint.
        breakpoint: u64,
        /// Its state.
        path: String,
        /// How often by now.
        hits: u32,
        /// Whether it held anything.
        held: bool,
    },
    /// A breakpoint was set or changed.
    BreakpointSet {
        /// As it is now.
        breakpoint: Breakpoint,
    },
    /// A breakpoint was removed.
    BreakpointRemoved {
        /// Its id.
        id: u64,
    },
    /// Someone chose the outcome of a state that waited or was held.
    Forced {
        /// The state.
        path: String,
        /// The outcome.
        outcome: Outcome,
    },
    /// A state was active when the run was begun again elsewhere; it has no outcome.
    Dropped {
        /// The state.
        path: String,
    },
    /// The run goes by this machine from now on. The first one is that of the start.
    Root {
        /// Hash of its content, as the journal keeps it.
        hash: String,
        /// What was changed, for people; empty for the first.
        change: String,
    },
    /// A change of the machine waits until a state is left.
    ChangeWaits {
        /// The state.
        path: String,
        /// What is to be changed, for people.
        change: String,
    },
    /// Someone asked for something, and this was the answer.
    Commanded {
        /// The command.
        envelope: Box<Envelope>,
        /// What became of it.
        answer: Answer,
    },
    /// A state asks people.
    Asked {
        /// What it asks.
        question: Box<Question>,
    },
    /// A question is closed.
    Closed {
        /// Its id.
        id: u64,
        /// How.
        how: Closing,
        /// The answer, if there is one.
        answer: Option<serde_json::Value>,
        /// Who answered; empty if no one did.
        author: String,
    },
    /// A state went past its deadline and is preempted.
    DeadlinePassed {
        /// The state.
        path: String,
        /// The deadline, in ms from its entry.
        deadline_ms: u64,
    },
    /// The ground is silent for as long as the policy of a state, a breakpoint or a question names; or it was heard again.
    Silence {
        /// For how long the ground was not heard, in ms; 0: it was heard just now.
        link_ms: u64,
        /// For how long no command came, in ms.
        command_ms: u64,
    },
    /// A state is preempted, as its policy says: the silence has lasted too long.
    LossRecovery {
        /// The state.
        path: String,
        /// By which measure.
        loss: Loss,
    },
    /// A script did not end within its grace period after it was asked to; the runner ends.
    CutOff {
        /// The state.
        path: String,
        /// The grace period, in ms.
        grace_ms: u64,
    },
    /// A runner took the run up again after another had ended in the middle of it.
    Resumed {
        /// How many runners there were, this one included.
        life: u32,
        /// How the last one ended.
        crash: Crash,
        /// What becomes of interrupted scripts.
        policy: OnCrash,
    },
    /// The run begins again at an entry of its history, with the data of then.
    WentBack {
        /// Number of the `entered`.
        sequence: u64,
    },
    /// Detail before this event was given up to keep the journal within its size.
    Thinned {
        /// The first event with full detail.
        before: u64,
    },
    /// Some events cannot be read any more: their journal is damaged. No runner tells it, only who reads the journal.
    Damaged {
        /// The first of them.
        first: u64,
        /// The last; the event itself has its number.
        last: u64,
        /// Where the damage lies, for people.
        what: String,
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
    /// A state cannot continue until the machine is changed or stopped.
    Waiting {
        /// The state.
        path: String,
        /// For what, and the way out.
        reason: String,
    },
    /// The run was paused or continues.
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
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum RunStatus {
    /// Scripts run.
    Running,
    /// Hierarchies hold before their next child.
    Paused,
    /// The same, from step to step.
    Stepping,
    /// Asked to stop, states are ending.
    Stopping,
    /// Over.
    Finished,
}

/// What one active state is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Its script or its children run.
    Running,
    /// It cannot continue.
    Waiting,
    /// A crash interrupted its script, and no one has decided what becomes of it.
    Interrupted,
    /// Held before the next state.
    Held,
    /// Asked to end.
    Preempted,
}

/// One active state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ActiveState {
    /// Ids joined by `/`.
    pub path: String,
    /// Its name.
    pub name: String,
    /// What it does.
    pub phase: Phase,
    /// Time since it was entered, in ms.
    pub since_ms: u64,
    /// The child of a concurrency state whose branch it belongs to; empty on the root's branch.
    #[serde(default)]
    pub branch: String,
    /// For what it waits.
    #[serde(default)]
    pub detail: Option<String>,
    /// What it is held by; a concurrency state may be held before several of its children.
    #[serde(default)]
    pub held: Vec<Hold>,
}

/// One place where an active state is held.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Hold {
    /// The state before which it is held, if there is one.
    pub next: Option<String>,
    /// By what.
    pub by: HeldBy,
}

/// The latest truth about a run: coalesced, at most every 100 ms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Snapshot {
    /// The run as a whole.
    pub status: RunStatus,
    /// Active states, a parent before its children.
    pub active: Vec<ActiveState>,
    /// States run so far.
    pub states_run: u64,
    /// Time since the start, in ms.
    pub elapsed_ms: u64,
    /// Number of the last event that happened.
    #[serde(default)]
    pub sequence: u64,
    /// Number of the last event that survives a power cut; no later one is told yet. 0 without a journal.
    #[serde(default)]
    pub disk_safe: u64,
    /// Why the journal cannot be written, while it cannot.
    #[serde(default)]
    pub journal_problem: Option<String>,
    /// All breakpoints.
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
    /// Questions that no one has answered yet.
    #[serde(default)]
    pub questions: Vec<Question>,
}
