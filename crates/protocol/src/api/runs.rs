//! Runs: start, status, control and results.

use super::{MachineFile, RunWait};
use crate::{
    Afterwards, Answer, Breakpoint, Event, Keeping, LinkHealth, OnCrash, Outcome, Snapshot,
};
use serde::{Deserialize, Serialize};

/// Request to start a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StartRun {
    /// Id chosen by the sender. Repeated requests with one id start one run.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// The machine, as stored on disk.
    pub machine: MachineFile,
    /// Values for input ports of the root, by name.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub inputs: crate::Values,
    /// Global variables that exist before the first state runs, by name.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub globals: crate::Values,
    /// Path of the state to begin at.
    #[serde(default)]
    pub start_from: Option<String>,
    /// Action after that state was left: `go_on`, `hold` or `stop`.
    #[serde(default)]
    pub afterwards: Afterwards,
    /// Amount of the run that is recorded: `full` or `status`.
    #[serde(default)]
    pub keeping: Keeping,
    /// True to store each event on disk before the script that follows it runs.
    #[serde(default)]
    pub strict: bool,
    /// True to hold the run before its first state.
    #[serde(default)]
    pub hold: bool,
    /// Breakpoints set from the start.
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
    /// Policy for interrupted scripts if the runner dies. Empty for the machine's policy, or *ask* if it has none.
    #[serde(default)]
    pub on_crash: Option<OnCrash>,
    /// Size of the journal, in bytes, above which old detail is deleted.
    #[serde(default)]
    pub size_max: Option<u64>,
}

/// Request to resume a run whose runner died.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ResumeRun {
    /// Id chosen by the sender. Repeated requests with one id are executed once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// Policy for interrupted scripts.
    #[serde(default)]
    pub policy: OnCrash,
    /// The `entered` event at which to begin, instead of the end of the run.
    #[serde(default)]
    pub from: Option<u64>,
}

/// Phase of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "phase", rename_all = "snake_case")]
pub enum RunPhase {
    /// The runner was started, but the run has not begun yet.
    Starting,
    /// It is in progress.
    Live,
    /// The run ended regularly.
    Finished {
        /// Outcome of the root state.
        outcome: Outcome,
        /// Number of states that it executed.
        states_run: u64,
    },
    /// The runner died before the end of the run. The run can be resumed.
    Crashed,
    /// The run is a replica, and its history differs from the robot's. It accepts no further events.
    Diverged {
        /// Cause and remedy, for people.
        reason: String,
    },
    /// The run never began.
    NotStarted {
        /// Cause of the failed start, for people.
        reason: String,
    },
    /// The folder of the run cannot be read.
    Unreadable {
        /// Cause of the failed read, for people.
        reason: String,
    },
}

/// Summary of a run, for a list.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunSummary {
    /// Id of the run: the name of its folder.
    pub id: String,
    /// Name of the root state.
    pub name: String,
    /// The machine, if it is in a project.
    pub machine: Option<MachineFile>,
    /// User who started it. Empty if it was started without the server.
    pub author: Option<String>,
    /// Start time: ms since 1970, UTC.
    pub started_ms: u64,
    /// Current phase of the run.
    #[serde(flatten)]
    pub phase: RunPhase,
    /// Length of the run up to now, in ms.
    pub length_ms: u64,
    /// Number of events in the run.
    pub events: u64,
    /// Size on disk, in bytes.
    pub bytes: u64,
    /// Amount of the run that is recorded.
    pub keeping: Keeping,
    /// Cause of the wait, if the run is active and all its branches wait.
    #[serde(default)]
    pub waits: Option<RunWait>,
    /// Last contact with the runner, or with the robot of a replica: ms since 1970, UTC, by the server's clock. Empty while there
    /// is contact, before the first contact, and after the end of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub unheard_since_ms: Option<u64>,
    /// Robot that executes the run, if this is a replica.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub robot: Option<String>,
}

/// Current status of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunNow {
    /// Summary of the run.
    pub run: RunSummary,
    /// The machine as loaded by the runner. Empty before the runner reports it, and for a run that ended before the server started.
    #[serde(default)]
    pub loaded: Option<LoadedMachine>,
    /// Connection between server and runner.
    pub link: LinkState,
    /// The newest snapshot. Empty before the first one.
    pub snapshot: Option<Snapshot>,
    /// Arrival time of the snapshot: ms since 1970, UTC, by the server's clock.
    pub snapshot_ms: Option<u64>,
    /// Last contact with the runner: ms since 1970, UTC, by the server's clock. Empty before the first contact. While the link is
    /// up, contact is continuous, and this value is updated only together with other changes.
    #[serde(default)]
    pub runner_heard_ms: Option<u64>,
    /// The server's clock at the time of the reply, or, in a subscription, of the change: ms since 1970, UTC.
    pub now_ms: u64,
    /// User in control, and requests for control.
    pub control: Control,
    /// Health of the link to the robot. Empty if the run is local. Updated while the run has viewers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub robot: Option<LinkHealth>,
}

/// The machine of a run, as loaded by its runner.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LoadedMachine {
    /// Number of states in the machine.
    pub states: u64,
    /// Faults that did not prevent loading, one line each.
    pub problems: Vec<String>,
}

/// State of the connection between server and runner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LinkState {
    /// Connected, and the runner responds.
    Up,
    /// Connected, but the runner does not respond: it is stopped, swapped out or hangs. Its last snapshot may be outdated.
    Silent,
    /// Connected, and the runner responds, but its engine has accepted no input for some seconds. There is no progress, and
    /// commands are not executed. `runner_heard_ms` is the last contact with the engine.
    Stuck,
    /// The connection is lost or is being established.
    Down,
    /// The run is over, so there is no connection.
    #[default]
    Over,
}

/// Control of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Control {
    /// User in control. If empty, the first user who sends a command takes control.
    pub holder: Option<String>,
    /// Time when the holder took control: ms since 1970, UTC.
    pub since_ms: u64,
    /// Last contact with the holder: ms since 1970, UTC.
    pub heard_ms: u64,
    /// Silence of the holder, in ms, after which any user with the right may take over.
    pub silence_ms: u64,
    /// Users who request control, the oldest request first.
    pub requests: Vec<String>,
    /// User to whom the holder has offered control. Empty if no offer is open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub offered_to: Option<String>,
    /// Epoch of authority. It increases each time control passes.
    #[serde(default)]
    pub epoch: u64,
}

/// A change of control that a user requests.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "move", rename_all = "snake_case")]
pub enum ControlMove {
    /// Request control. It is granted at once if nobody holds it.
    Request,
    /// Withdraw the user's own request, or the holder's offer.
    Withdraw,
    /// Hand control to a user. If that user has requested it, control passes at once. Otherwise the user is offered control and may
    /// accept or decline; the holder keeps control until then.
    HandOver {
        /// The user who receives control.
        to: String,
    },
    /// Release control without a successor.
    Release,
    /// Take control from a silent holder.
    TakeOver,
    /// Accept the holder's offer.
    Accept,
    /// Decline the holder's offer.
    Decline,
    /// Take control from any holder at once. Requires the right to administer, and is recorded.
    Override,
}

/// Selects an active state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct StateAt {
    /// Path of the state: ids joined by `/`.
    pub path: String,
}

/// Selects the amount of a run's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct OutputEnd {
    /// Number of bytes from the end. The default is 65,536, the maximum 1,048,576.
    #[serde(default)]
    pub bytes: Option<u64>,
}

/// Tail of the output of a runner and its scripts that bypassed the capture of script output.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunOutput {
    /// The text. Bytes that are not UTF-8 are replaced.
    pub text: String,
    /// Number of bytes before the text.
    pub from: u64,
    /// Total size of the output in bytes.
    pub bytes: u64,
}

/// Final values of a run, by name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunResults {
    /// Outputs of the root.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub outputs: crate::Values,
    /// Final values of global variables.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub globals: crate::Values,
    /// Scoped variables of the root.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub scoped_variables: crate::Values,
}

/// Result of a command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CommandAnswer {
    /// Id of the command.
    pub id: String,
    /// Result of the command.
    #[serde(flatten)]
    pub answer: Answer,
}

/// One event of a run's history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct HistoryEntry {
    /// Sequence number, counted from 1.
    pub sequence: u64,
    /// Time since the start of the run, in ns.
    pub t_ns: u64,
    /// Content of the event, without number and time.
    pub event: Event,
}

/// A page of a run's history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EventPage {
    /// The events, in order.
    pub events: Vec<HistoryEntry>,
    /// First event of the next page. All earlier events have been searched. If it is beyond `last`, no more events exist yet.
    pub next: u64,
    /// Last event that exists at present.
    pub last: u64,
}

/// Retention limits for runs. Empty fields set no limit. The 10 newest runs and all active runs are always kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(default)]
pub struct Retention {
    /// Maximum number of runs to keep.
    pub count: Option<u32>,
    /// Maximum age of a run, in days.
    pub days: Option<u32>,
    /// Maximum total size of the runs, in bytes.
    pub bytes: Option<u64>,
}

/// A run that was deleted by the retention limits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Pruned {
    /// Id of the run.
    pub id: String,
    /// Size that it had on disk, in bytes.
    pub bytes: u64,
}
