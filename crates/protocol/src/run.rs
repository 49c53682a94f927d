//! What belongs to a run as a whole: how it is kept, and how it continues after a crash.

use serde::{Deserialize, Serialize};

/// How much of a run is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Keeping {
    /// Nothing: the run cannot be replayed or resumed.
    Off,
    /// States, outcomes, commands and the log, without values; and what the run came to.
    Status,
    /// Everything.
    #[default]
    Full,
}

/// What becomes of the states whose scripts were interrupted by a crash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum OnCrash {
    /// Nothing moves until someone decides with [`crate::Command::Recover`].
    #[default]
    Ask,
    /// They end with the outcome *aborted* and the crash as their error, so that recovery transitions take over.
    Abort,
    /// They are entered again, with the inputs that they had.
    Restart,
}

/// What happens once the state at which a run began was left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Afterwards {
    /// The run is in progress.
    #[default]
    GoOn,
    /// The run is held, in step mode.
    Hold,
    /// The run stops.
    Stop,
}

/// How a run is resumed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Resume {
    /// What becomes of interrupted scripts.
    #[serde(default)]
    pub policy: OnCrash,
    /// Begin at this event of the history instead of where the run ended: an `entered`.
    #[serde(default)]
    pub from: Option<u64>,
}

/// What a runner was doing when it ended without an end of its run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Crash {
    /// The signal or exit status, in words.
    pub reason: String,
    /// Paths of the states whose scripts ran.
    pub active: Vec<String>,
}
