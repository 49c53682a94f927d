//! Settings of a run as a whole: recording, and resuming after a crash.

use serde::{Deserialize, Serialize};

/// Amount of a run that is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Keeping {
    /// Nothing: the run cannot be replayed or resumed.
    Off,
    /// States, outcomes, commands, the log and the final result, without other values.
    Status,
    /// States, outcomes, commands, the log and all values.
    #[default]
    Full,
}

/// Policy for states whose scripts were interrupted by a crash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum OnCrash {
    /// Wait until someone decides with [`crate::Command::Recover`].
    #[default]
    Ask,
    /// End them with the outcome *aborted* and the crash as their error, so that recovery transitions take over.
    Abort,
    /// Enter them again with their previous inputs.
    Restart,
}

/// Action after the state at which a run began was left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Afterwards {
    /// Continue behind that state.
    #[default]
    GoOn,
    /// Hold the run, in step mode.
    Hold,
    /// Stop the run behind that state.
    Stop,
}

/// Options for resuming a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Resume {
    /// Policy for interrupted scripts.
    #[serde(default)]
    pub policy: OnCrash,
    /// The `entered` event at which to begin, instead of the end of the run.
    #[serde(default)]
    pub from: Option<u64>,
}

/// Activity of a runner that died before the end of its run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Crash {
    /// Description of the signal or exit status.
    pub reason: String,
    /// Paths of the states whose scripts were running.
    pub active: Vec<String>,
}
