//! Results about past runs: moments, comparisons and statistics. `history.rs` has the queries.

use crate::{Breakpoint, HeldBy, Outcome, Question, RunStatus, Values};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// State of a run after one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Moment {
    /// Number of the event. 0 for the moment before the first event.
    pub sequence: u64,
    /// Time of the event, in ns since the start of the run.
    pub t_ns: u64,
    /// Status of the whole run.
    pub status: RunStatus,
    /// Outcome of the run, if it has ended.
    pub outcome: Option<Outcome>,
    /// Hash of the machine that was in use, if it was recorded.
    pub root: Option<String>,
    /// Number of runners up to this moment.
    pub life: u32,
    /// Number of states executed.
    pub states_run: u64,
    /// Active states, each after its parent.
    pub active: Vec<MomentState>,
    /// Branches that are held.
    pub held: Vec<Holding>,
    /// Paths of waiting states, and the causes of their waits.
    pub waiting: BTreeMap<String, String>,
    /// Global variables by name.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub globals: Values,
    /// Data that states keep between their executions, by path.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub persistent: Values,
    /// All breakpoints at this moment.
    pub breakpoints: Vec<Breakpoint>,
    /// Questions without an answer.
    pub questions: Vec<Question>,
}

/// A state that is active at a moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MomentState {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// Number of ancestors of the state.
    pub depth: usize,
    /// Event by which it was entered.
    pub entered: u64,
    /// Entry time, in ns since the start of the run.
    pub since_ns: u64,
    /// Inputs by name. Empty if they were not recorded.
    #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
    pub inputs: Option<Values>,
    /// Scoped variables by name.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub scoped: Values,
    /// Last end of each child, in order of time.
    pub ended: Vec<MomentEnd>,
}

/// The end of a child state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MomentEnd {
    /// Path of the child: ids joined by `/`.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// Outcome of the child.
    pub outcome: Outcome,
    /// Outputs by name. Empty if they were not recorded.
    #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
    pub outputs: Option<Values>,
    /// Error of the child, if it has one.
    pub error: Option<Value>,
    /// Sequence number of its `left` event.
    pub sequence: u64,
}

/// A branch that is held.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Holding {
    /// Path of the container that is held.
    pub path: String,
    /// The next state. The container is held before it.
    pub next: Option<String>,
    /// Reason for the hold.
    pub by: HeldBy,
}

/// Comparison of two runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Comparison {
    /// Number of entries and ends that match in both runs.
    pub alike: u64,
    /// First difference of each branch, sorted by time, at most 64. Empty if the runs match.
    pub parted: Vec<Parting>,
    /// Number of branches with a difference, including unlisted ones.
    pub branches_parted: usize,
    /// Data that differed before that: the first entry and the first end of each state with other data.
    pub changed: Vec<DataChange>,
    /// Active time of each state.
    pub timing: Vec<Timing>,
}

/// First difference of two runs on a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Parting {
    /// Path of the branch: a child of a concurrency state, or the root.
    pub branch: String,
    /// Names of the states on that path, joined by `/`.
    pub names: String,
    /// Next event in the first run. Empty if the run was over.
    pub one: Option<Happened>,
    /// Next event in the second run. Empty if the run was over.
    pub other: Option<Happened>,
}

/// An entry or the end of a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Happened {
    /// Sequence number of the event.
    pub sequence: u64,
    /// Time, in ns since the start of the run.
    pub t_ns: u64,
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// Outcome of an end. Empty for an entry.
    pub outcome: Option<Outcome>,
    /// True for a step back.
    pub backwards: bool,
}

/// A value that differs between two runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct DataChange {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// Kind of the value.
    pub kind: DataKind,
    /// Name of the port. Empty for an error.
    pub port: String,
    /// Event in the first run.
    pub one_sequence: u64,
    /// Value in the first run, if there is one.
    pub one: Option<Value>,
    /// Event in the second run.
    pub other_sequence: u64,
    /// Value in the second run, if there is one.
    pub other: Option<Value>,
}

/// Kind of a compared value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum DataKind {
    /// Value of an input port.
    Input,
    /// Value of an output port.
    Output,
    /// Error of the state.
    Error,
}

impl DataKind {
    /// Returns the kind as an English word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
            Self::Error => "error",
        }
    }
}

/// Active time of a state in each of two runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Timing {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// Time in the first run.
    pub one: TimeTaken,
    /// Time in the second run.
    pub other: TimeTaken,
}

/// Active time of a state in one run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TimeTaken {
    /// Number of completed executions.
    pub count: u64,
    /// Total active time, in ns.
    pub total_ns: u64,
}

/// Execution statistics of a run's states, up to one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Statistics {
    /// Number of the event. 0 if the run has no events.
    pub sequence: u64,
    /// Time of the event, in ns since the start of the run.
    pub t_ns: u64,
    /// States that ended at least once, sorted by path.
    pub states: Vec<StateStatistics>,
}

/// Execution statistics of a state. Steps back are not counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StateStatistics {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// Number of completed executions.
    pub count: u64,
    /// Total active time, in ns.
    pub total_ns: u64,
    /// Shortest execution, in ns.
    pub min_ns: u64,
    /// Median execution time, in ns, with an error of up to 2 %.
    pub median_ns: u64,
    /// 95th percentile of the execution time, in ns, with an error of up to 2 %.
    pub p95_ns: u64,
    /// Longest execution, in ns.
    pub max_ns: u64,
    /// Outcomes, the most frequent first.
    pub outcomes: Vec<OutcomeCount>,
}

/// Number of executions that ended by an outcome.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OutcomeCount {
    /// Outcome of the state.
    pub outcome: Outcome,
    /// Number of executions with this outcome.
    pub count: u64,
}
