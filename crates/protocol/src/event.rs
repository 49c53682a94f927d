//! Events and snapshots that a run sends to its viewers.

use crate::{Answer, Breakpoint, Closing, Crash, Envelope, OnCrash, Question};
use serde::{Deserialize, Serialize};

/// Values by name, encoded as in `docs/protocol.md`.
pub type Values = serde_json::Map<String, serde_json::Value>;

/// The reason why a branch is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum HeldBy {
    /// A pause of the run.
    Pause,
    /// The end of a step.
    Step,
    /// The target of a *run to* command.
    RunTo,
    /// A breakpoint that was hit.
    Breakpoint {
        /// Id of the breakpoint.
        id: u64,
    },
    /// The start of the run or of the branch.
    Start,
    /// A policy of a state: the ground was silent for too long.
    Loss {
        /// The kind of loss that the policy measures.
        loss: Loss,
    },
}

/// The kind of lost link that a policy measures (see "Lost link" in `docs/semantics.md`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Loss {
    /// Nothing was received from the ground.
    Link,
    /// No command was received.
    Command,
}

/// The outcome of a state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Outcome {
    /// Id of the outcome, unique in the state.
    pub id: i64,
    /// Name of the outcome.
    pub name: String,
}

/// Severity of a log line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LogLevel {
    /// More detailed than debug.
    Verbose,
    /// Details for finding a fault.
    Debug,
    /// Normal operation, for all users.
    Info,
    /// A possible fault that needs attention.
    Warning,
    /// A fault of a script, the machine or the run.
    Error,
}

/// Source of a log line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Stream {
    /// Standard output: of scripts (`sys.stdout`), native code and child processes.
    Stdout,
    /// Standard error: of scripts (`sys.stderr`), native code and child processes, if it is a separate file.
    Stderr,
    /// A record of a Python logger.
    Logger,
    /// A message of the engine or the runner.
    Engine,
}

/// One event of a run. Paths are state ids joined by `/`. Values are encoded as in `docs/protocol.md`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Event {
    /// A state was entered.
    Entered {
        /// Path of the state.
        path: String,
        /// Inputs by port name. Empty if the run does not keep them or the reader did not request values.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
        inputs: Option<Values>,
        /// Number of the entry that this backward entry undoes (counted from 1 over all entries of the run).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        undoes: Option<u64>,
    },
    /// A state ended, or a step back left it backward.
    Left {
        /// Path of the state.
        path: String,
        /// Outcome by which the state ended.
        outcome: Outcome,
        /// Outputs by port name, without ports that the script left out. Empty if the run does not keep them or the reader did not
        /// request values.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
        outputs: Option<Values>,
        /// Error of the state, if it has one. Shortened if the reader did not request values.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        error: Option<serde_json::Value>,
        /// Number of the entry that this backward step undid. The state's data is again as before that entry.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        undoes: Option<u64>,
    },
    /// A scoped variable received a value.
    Scoped {
        /// Path of the container.
        path: String,
        /// Name of the variable.
        name: String,
        /// Value of the variable.
        value: serde_json::Value,
    },
    /// A global variable received a value or was deleted.
    Global {
        /// Name of the variable.
        name: String,
        /// Value of the variable. `None` if it was deleted.
        value: Option<serde_json::Value>,
    },
    /// The persistent data of a state changed. The state keeps it between its executions.
    Persistent {
        /// Path of the state.
        path: String,
        /// The whole persistent data.
        value: serde_json::Value,
    },
    /// A branch is held.
    Held {
        /// Path of the container that is held.
        path: String,
        /// The next state, if there is one. The container is held before it.
        next: Option<String>,
        /// Reason for the hold.
        by: HeldBy,
    },
    /// A breakpoint was reached and its condition was true.
    Hit {
        /// Id of the breakpoint.
        breakpoint: u64,
        /// Path of the breakpoint's state.
        path: String,
        /// Number of hits, including this one.
        hits: u32,
        /// True if the breakpoint held the branch.
        held: bool,
    },
    /// A breakpoint was set or changed.
    BreakpointSet {
        /// The breakpoint with its new settings.
        breakpoint: Breakpoint,
    },
    /// A breakpoint was removed.
    BreakpointRemoved {
        /// Id of the breakpoint.
        id: u64,
    },
    /// A user chose the outcome of a state that waited or was held.
    Forced {
        /// Path of the state.
        path: String,
        /// Outcome that the user chose.
        outcome: Outcome,
    },
    /// An active state ended without an outcome, because the run started again elsewhere.
    Dropped {
        /// Path of the state.
        path: String,
    },
    /// The run uses this machine from now on. The first `root` event names the machine at the start.
    Root {
        /// Hash of the machine's content, as in the journal.
        hash: String,
        /// Description of the change. Empty for the first `root` event.
        change: String,
    },
    /// A change of the machine is delayed until a state is left.
    ChangeWaits {
        /// Path of the state.
        path: String,
        /// Description of the pending change.
        change: String,
    },
    /// A command was received and answered.
    Commanded {
        /// The command with its metadata.
        envelope: Box<Envelope>,
        /// Result of the command.
        answer: Answer,
    },
    /// A state asks a question.
    Asked {
        /// The question and its form.
        question: Box<Question>,
    },
    /// A question was closed.
    Closed {
        /// Id of the question.
        id: u64,
        /// Reason for the closing.
        how: Closing,
        /// The answer, if the question has one.
        answer: Option<serde_json::Value>,
        /// User who answered. Empty if nobody did.
        author: String,
    },
    /// A state exceeded its deadline and is preempted.
    DeadlinePassed {
        /// Path of the state.
        path: String,
        /// The deadline, in ms from the state's entry.
        deadline_ms: u64,
    },
    /// The silence of the ground reached a limit of a policy, breakpoint or question, or it ended.
    Silence {
        /// Time since the last contact with the ground, in ms. 0 if contact was just restored.
        link_ms: u64,
        /// Time since the last command, in ms.
        command_ms: u64,
    },
    /// A state is preempted by its policy, because the silence lasted too long.
    LossRecovery {
        /// Path of the state.
        path: String,
        /// The kind of loss that the policy measures.
        loss: Loss,
    },
    /// A preempted script did not end within its grace period. The runner ends.
    CutOff {
        /// Path of the state.
        path: String,
        /// The grace period, in ms.
        grace_ms: u64,
    },
    /// Another runner resumed the run after a crash.
    Resumed {
        /// Number of this runner. The first runner of the run has number 1.
        life: u32,
        /// Reason for the end of the last runner.
        crash: Crash,
        /// Policy for interrupted scripts.
        policy: OnCrash,
    },
    /// The run starts again at an entry of its history, with the data of that moment.
    WentBack {
        /// Sequence number of the `entered` event.
        sequence: u64,
    },
    /// Detail before this event was deleted to limit the size of the journal.
    Thinned {
        /// Sequence number of the first event with full detail.
        before: u64,
    },
    /// Some events cannot be read because the journal is damaged. Journal readers create this event; runners never send it.
    Damaged {
        /// Sequence number of the first unreadable event.
        first: u64,
        /// Sequence number of the last unreadable event, and of this event.
        last: u64,
        /// Location of the damage, for people.
        what: String,
    },
    /// A log line of a script or of the engine.
    Log {
        /// Path of the state that wrote the line. Empty if no state did.
        path: String,
        /// Severity of the line.
        level: LogLevel,
        /// Source of the line.
        stream: Stream,
        /// Text without the trailing newline.
        message: String,
    },
    /// A state cannot continue until the machine is changed or stopped.
    Waiting {
        /// Path of the state.
        path: String,
        /// Cause of the wait, and how to proceed.
        reason: String,
    },
    /// The run was paused or resumed.
    Paused {
        /// True if the run is paused now.
        paused: bool,
    },
    /// A stop of the run was requested.
    Stopping,
    /// The run ended. This is its last event.
    Finished {
        /// Outcome of the root state.
        outcome: Outcome,
        /// Outputs of the root, by port name.
        outputs: serde_json::Map<String, serde_json::Value>,
        /// Final global variables, by name.
        globals: serde_json::Map<String, serde_json::Value>,
        /// Final scoped variables of the root, by name.
        scoped_variables: serde_json::Map<String, serde_json::Value>,
        /// Number of states executed. A library state counts once, by the root of its content.
        states_run: u64,
    },
}

/// Status of a run as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum RunStatus {
    /// The run as a whole is neither held nor ending.
    Running,
    /// Hierarchies are held before their next child.
    Paused,
    /// Hierarchies are held before their next child, in step mode.
    Stepping,
    /// A stop was requested, and active states are ending.
    Stopping,
    /// The run is over.
    Finished,
}

/// Phase of an active state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Its script or its children are running.
    Running,
    /// It cannot continue without intervention.
    Waiting,
    /// A crash interrupted its script, and no decision about it has been made.
    Interrupted,
    /// It is held before its next child.
    Held,
    /// It was asked to end.
    Preempted,
}

/// An active state in a snapshot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ActiveState {
    /// Ids joined by `/`.
    pub path: String,
    /// Name of the state.
    pub name: String,
    /// Current phase of the state.
    pub phase: Phase,
    /// Time since the state was entered, in ms.
    pub since_ms: u64,
    /// Child of a concurrency state whose branch contains this state. Empty on the root's branch.
    #[serde(default)]
    pub branch: String,
    /// Cause of the wait, in words.
    #[serde(default)]
    pub detail: Option<String>,
    /// Holds on this state. A concurrency state may be held before several of its children.
    #[serde(default)]
    pub held: Vec<Hold>,
}

/// One hold on an active state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Hold {
    /// The next state, if there is one. The active state is held before it.
    pub next: Option<String>,
    /// Reason for the hold.
    pub by: HeldBy,
}

/// Current status of a run, sent at most every 100 ms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Snapshot {
    /// Status of the whole run.
    pub status: RunStatus,
    /// Active states, a parent before its children.
    pub active: Vec<ActiveState>,
    /// Number of states executed.
    pub states_run: u64,
    /// Time since the start of the run, in ms.
    pub elapsed_ms: u64,
    /// Sequence number of the last event that happened.
    #[serde(default)]
    pub sequence: u64,
    /// Sequence number of the last event that survives a power cut. Later events are not sent yet. 0 without a journal.
    #[serde(default)]
    pub disk_safe: u64,
    /// Reason why the journal cannot be written. Empty while it can be.
    #[serde(default)]
    pub journal_problem: Option<String>,
    /// All breakpoints of the run.
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
    /// Questions without an answer.
    #[serde(default)]
    pub questions: Vec<Question>,
}
