//! Runs: how they begin, how they stand, who commands them, what they leave.

use super::{MachineFile, RunWait};
use crate::{
    Afterwards, Answer, Breakpoint, Event, Keeping, LinkHealth, OnCrash, Outcome, Snapshot,
};
use serde::{Deserialize, Serialize};

/// Starts a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StartRun {
    /// Chosen by the sender; the same id starts one run.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// The machine, as it lies on disk.
    pub machine: MachineFile,
    /// Values for input ports of the root, by name.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub inputs: crate::Values,
    /// Global variables that are there before the first state runs, by name.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub globals: crate::Values,
    /// State path to begin at.
    #[serde(default)]
    pub start_from: Option<String>,
    /// What happens once that state was left: `go_on`, `hold` or `stop`.
    #[serde(default)]
    pub afterwards: Afterwards,
    /// How much is kept: `full` or `status`.
    #[serde(default)]
    pub keeping: Keeping,
    /// Whether an event is on disk before the script that follows it runs.
    #[serde(default)]
    pub strict: bool,
    /// Whether the run is held before its first state.
    #[serde(default)]
    pub hold: bool,
    /// Breakpoints that are there from the start.
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
    /// What becomes of interrupted scripts if the runner dies; none: what the machine says, else *ask*.
    #[serde(default)]
    pub on_crash: Option<OnCrash>,
    /// The journal's size, in bytes, beyond which old detail is given up.
    #[serde(default)]
    pub size_max: Option<u64>,
}

/// Resumes a run whose runner died.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ResumeRun {
    /// Chosen by the sender; the same id is carried out once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// What becomes of interrupted scripts.
    #[serde(default)]
    pub policy: OnCrash,
    /// Begin at this event of the history instead of where the run ended: an `entered`.
    #[serde(default)]
    pub from: Option<u64>,
}

/// What has become of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "phase", rename_all = "snake_case")]
pub enum RunPhase {
    /// Its runner was started and has not begun yet.
    Starting,
    /// It is in progress.
    Live,
    /// It came to its end.
    Finished {
        /// By this outcome.
        outcome: Outcome,
        /// States that it ran.
        states_run: u64,
    },
    /// Its runner ended before it did: it can be resumed.
    Crashed,
    /// It is a replica, and the run at its robot has another history: it takes nothing more.
    Diverged {
        /// Why, and the way out.
        reason: String,
    },
    /// It never began.
    NotStarted {
        /// Why.
        reason: String,
    },
    /// Its folder cannot be read.
    Unreadable {
        /// Why.
        reason: String,
    },
}

/// One run in one line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunSummary {
    /// The name of its folder.
    pub id: String,
    /// The root state's name.
    pub name: String,
    /// Its machine, if it lies in a project.
    pub machine: Option<MachineFile>,
    /// Who asked for it; none if it was started without the server.
    pub author: Option<String>,
    /// When it began: ms since 1970, UTC.
    pub started_ms: u64,
    /// What has become of it.
    #[serde(flatten)]
    pub phase: RunPhase,
    /// Its length, in ms; so far, while it is in progress.
    pub length_ms: u64,
    /// How many events it has.
    pub events: u64,
    /// What it takes on disk, in bytes.
    pub bytes: u64,
    /// How much of it is kept.
    pub keeping: Keeping,
    /// what it waits for, if it is in progress and none of its branches is at work.
    #[serde(default)]
    pub waits: Option<RunWait>,
    /// When its runner was heard last, or its robot if that is far away: ms since 1970, UTC, by the server's clock. None while it is
    /// heard, before it was, and of a run that is over.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub unheard_since_ms: Option<u64>,
    /// The robot that it runs on, if that is far away and this is a replica.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub robot: Option<String>,
}

/// The latest truth about one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunNow {
    /// In one line.
    pub run: RunSummary,
    /// What its runner goes by; none before it said so, and of a run that was over before the server began.
    #[serde(default)]
    pub loaded: Option<LoadedMachine>,
    /// Between server and runner.
    pub link: LinkState,
    /// What the runner said last; none if it never did.
    pub snapshot: Option<Snapshot>,
    /// When the runner said it: ms since 1970, UTC, by the server's clock.
    pub snapshot_ms: Option<u64>,
    /// When the runner was heard last: ms since 1970, UTC, by the server's clock; none if it never was. While the link is up it is
    /// heard all the time, and this is told beside other news only.
    #[serde(default)]
    pub runner_heard_ms: Option<u64>,
    /// The server's clock when it answers, and in a status of a subscription when it changed: ms since 1970, UTC.
    pub now_ms: u64,
    /// Who commands.
    pub control: Control,
    /// How the link to its robot is; none if the run is not far away. Told while someone looks on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub robot: Option<LinkHealth>,
}

/// The machine of a run, as its runner has read it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LoadedMachine {
    /// How many states it has.
    pub states: u64,
    /// Faults that did not keep it from being read, one line each.
    pub problems: Vec<String>,
}

/// The connection between server and runner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LinkState {
    /// It stands.
    Up,
    /// It stands, but the runner does not answer: it is stopped, swapped out or hangs, and what it said last may be old.
    Silent,
    /// It stands and the runner answers, but its engine has not taken inputs for some seconds: nothing moves on, and no command is
    /// carried out. `runner_heard_ms` is when the engine was reached last.
    Stuck,
    /// It is gone, or being made.
    Down,
    /// The run is over: there is nothing to connect to.
    #[default]
    Over,
}

/// Who holds control of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Control {
    /// The user; none: the first who commands takes it.
    pub holder: Option<String>,
    /// Since when: ms since 1970, UTC.
    pub since_ms: u64,
    /// When the holder was heard last: ms since 1970, UTC.
    pub heard_ms: u64,
    /// After how many ms of the holder's silence anyone with the right may take over.
    pub silence_ms: u64,
    /// Who asks for it, the first first.
    pub requests: Vec<String>,
    /// The user to whom the holder offers it, and who has not accepted yet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub offered_to: Option<String>,
    /// The epoch of authority: it rises each time control passes.
    #[serde(default)]
    pub epoch: u64,
}

/// What someone wants about control.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "move", rename_all = "snake_case")]
pub enum ControlMove {
    /// Ask for it; given at once if no one holds it.
    Request,
    /// Take back the own request; the holder takes back the offer.
    Withdraw,
    /// Give it to a user: at once if that user requested it, else as an offer, which the user accepts or declines. The holder
    /// keeps control until then.
    HandOver {
        /// To this user.
        to: String,
    },
    /// Hold it no more.
    Release,
    /// Take it from a holder who is silent.
    TakeOver,
    /// Accept the holder's offer.
    Accept,
    /// Decline the holder's offer.
    Decline,
    /// Take it from any holder at once. Needs the right to administer, and is on record.
    Override,
}

/// Which active state is asked about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct StateAt {
    /// Its path: ids joined by `/`.
    pub path: String,
}

/// How much of a run's output is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct OutputEnd {
    /// So many of the last bytes; left out: 65,536; at most 1,048,576.
    #[serde(default)]
    pub bytes: Option<u64>,
}

/// The end of what a runner and its scripts wrote past the capture of script output.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunOutput {
    /// The text; what is not UTF-8 is replaced.
    pub text: String,
    /// How many bytes come before it.
    pub from: u64,
    /// How many bytes there are in all.
    pub bytes: u64,
}

/// The values at the end of a run, by name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RunResults {
    /// The outputs of the root.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub outputs: crate::Values,
    /// Global variables at the end.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub globals: crate::Values,
    /// The scoped variables of the root.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub scoped_variables: crate::Values,
}

/// What became of a command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CommandAnswer {
    /// The command's id.
    pub id: String,
    /// The answer.
    #[serde(flatten)]
    pub answer: Answer,
}

/// One event of a run's history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct HistoryEntry {
    /// Counts from 1.
    pub sequence: u64,
    /// Time since the start of the run, in ns.
    pub t_ns: u64,
    /// What happened.
    pub event: Event,
}

/// A page of a run's history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EventPage {
    /// The events, in order.
    pub events: Vec<HistoryEntry>,
    /// Where the next page begins: everything before was looked at. Beyond `last`, there is no more so far.
    pub next: u64,
    /// The last event that there is so far.
    pub last: u64,
}

/// Which runs are kept; what is left out has no limit. The 10 newest stay whatever they take, and so does every run in progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(default)]
pub struct Retention {
    /// So many of the newest.
    pub count: Option<u32>,
    /// Those of the last so many days.
    pub days: Option<u32>,
    /// The newest that take so many bytes together.
    pub bytes: Option<u64>,
}

/// A run that was given up.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Pruned {
    /// Its id.
    pub id: String,
    /// What it took on disk, in bytes.
    pub bytes: u64,
}
