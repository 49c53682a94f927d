//! What runs leave: how they stood at a moment, where two part, what their states took. Asked for as `history.rs` says.

use crate::{Breakpoint, HeldBy, Outcome, Question, RunStatus, Values};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// How a run stood after one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Moment {
    /// The event; 0: before the first.
    pub sequence: u64,
    /// When it happened, in ns since the start of the run.
    pub t_ns: u64,
    /// The run as a whole.
    pub status: RunStatus,
    /// How it ended, once it has.
    pub outcome: Option<Outcome>,
    /// Hash of the machine that it went by, if it was kept.
    pub root: Option<String>,
    /// How many runners there were.
    pub life: u32,
    /// States run so far.
    pub states_run: u64,
    /// Active states, each after the state around it.
    pub active: Vec<MomentState>,
    /// Branches that are held.
    pub held: Vec<Holding>,
    /// States that wait, by path, and for what.
    pub waiting: BTreeMap<String, String>,
    /// Global variables by name.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub globals: Values,
    /// What states keep from one run to the next, by path.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub persistent: Values,
    /// All breakpoints.
    pub breakpoints: Vec<Breakpoint>,
    /// Questions without an answer.
    pub questions: Vec<Question>,
}

/// One active state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MomentState {
    /// Ids joined by `/`.
    pub path: String,
    /// Names joined by `/`.
    pub names: String,
    /// How many states are around it.
    pub depth: usize,
    /// The event that it was entered by.
    pub entered: u64,
    /// When it was entered, in ns since the start of the run.
    pub since_ns: u64,
    /// Its inputs by name; none if they were not kept.
    #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
    pub inputs: Option<Values>,
    /// Its scoped variables by name.
    #[cfg_attr(feature = "schema", schema(value_type = Object), ts(type = "Record<string, unknown>"))]
    pub scoped: Values,
    /// How its children ended last, in that order.
    pub ended: Vec<MomentEnd>,
}

/// How a child ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MomentEnd {
    /// Ids joined by `/`.
    pub path: String,
    /// Names joined by `/`.
    pub names: String,
    /// Its outcome.
    pub outcome: Outcome,
    /// Its outputs by name; none if they were not kept.
    #[cfg_attr(feature = "schema", schema(value_type = Option<Object>), ts(type = "Record<string, unknown> | null"))]
    pub outputs: Option<Values>,
    /// Its error, if it left one.
    pub error: Option<Value>,
    /// The event that says so.
    pub sequence: u64,
}

/// A branch that is held.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Holding {
    /// The container that is held.
    pub path: String,
    /// The state before which it is held.
    pub next: Option<String>,
    /// By what.
    pub by: HeldBy,
}

/// Two runs side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Comparison {
    /// Entries and ends that are the same in both.
    pub alike: u64,
    /// Where the runs part: on each branch the first place, the earliest of them first, at most 64. None if they do not part.
    pub parted: Vec<Parting>,
    /// On how many branches they part, those included that are not told.
    pub branches_parted: usize,
    /// Data that differed up to there: the first entry and the first end of each state at which it did.
    pub changed: Vec<DataChange>,
    /// How long each state was active.
    pub timing: Vec<Timing>,
}

/// Where two runs part on a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Parting {
    /// The branch: a child of a concurrency state, or the root.
    pub branch: String,
    /// The names of that state and those around it, joined by `/`.
    pub names: String,
    /// What happened next in the one; nothing if it was over.
    pub one: Option<Happened>,
    /// What happened next in the other.
    pub other: Option<Happened>,
}

/// An entry or end of a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Happened {
    /// The event.
    pub sequence: u64,
    /// When, in ns since the start of the run.
    pub t_ns: u64,
    /// Ids joined by `/`.
    pub path: String,
    /// Names joined by `/`.
    pub names: String,
    /// How it ended; none if it was entered.
    pub outcome: Option<Outcome>,
    /// Whether it was a step back.
    pub backwards: bool,
}

/// A value that differed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct DataChange {
    /// Ids joined by `/`.
    pub path: String,
    /// Names joined by `/`.
    pub names: String,
    /// What it was.
    pub kind: DataKind,
    /// The port's name; empty for an error.
    pub port: String,
    /// The event in the one.
    pub one_sequence: u64,
    /// The value in the one; none if there was none.
    pub one: Option<Value>,
    /// The event in the other.
    pub other_sequence: u64,
    /// The value in the other.
    pub other: Option<Value>,
}

/// What a value was of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum DataKind {
    /// Of an input port.
    Input,
    /// Of an output port.
    Output,
    /// Its error.
    Error,
}

impl DataKind {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
            Self::Error => "error",
        }
    }
}

/// How long a state was active in each of two runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Timing {
    /// Ids joined by `/`.
    pub path: String,
    /// Names joined by `/`.
    pub names: String,
    /// In the one.
    pub one: TimeTaken,
    /// In the other.
    pub other: TimeTaken,
}

/// Time that a state took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TimeTaken {
    /// How often it ran to its end.
    pub count: u64,
    /// All together, in ns.
    pub total_ns: u64,
}

/// What the states of a run did and took, all of it up to one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Statistics {
    /// The event; 0: there is none.
    pub sequence: u64,
    /// When it happened, in ns since the start of the run.
    pub t_ns: u64,
    /// Every state that ended, by rising path.
    pub states: Vec<StateStatistics>,
}

/// What a state did and took. Steps back are not counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StateStatistics {
    /// Ids joined by `/`.
    pub path: String,
    /// Names joined by `/`.
    pub names: String,
    /// How often it ran to its end.
    pub count: u64,
    /// Time that it was active, all together, in ns.
    pub total_ns: u64,
    /// The shortest, in ns.
    pub min_ns: u64,
    /// Half of all took no longer, in ns; up to 2 % beside the truth.
    pub median_ns: u64,
    /// 95 of 100 took no longer, in ns; up to 2 % beside the truth.
    pub p95_ns: u64,
    /// The longest, in ns.
    pub max_ns: u64,
    /// How it ended, the most frequent first.
    pub outcomes: Vec<OutcomeCount>,
}

/// How often a state ended by an outcome.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OutcomeCount {
    /// The outcome.
    pub outcome: Outcome,
    /// How often.
    pub count: u64,
}
