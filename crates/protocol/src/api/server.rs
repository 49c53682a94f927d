//! The server as a whole, and its refusals.

use super::{MachineSummary, RunSummary};
use serde::{Deserialize, Serialize};

/// Whether the server is there; told to anyone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Health {
    /// Always `rafcon`.
    pub program: String,
    /// Its version.
    pub version: String,
}

/// The latest truth about everything that the server looks after.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ServerStatus {
    /// Changes whenever a file of a project or library does: ask for the trees again.
    pub files_revision: u64,
    /// Open machines.
    pub machines: Vec<MachineSummary>,
    /// Runs in progress, and those that changed since the server began; the newest first.
    pub runs: Vec<RunSummary>,
}

/// Why a request was refused: what, where, and the way out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Refusal {
    /// For programs: a stable word in `snake_case`.
    pub code: String,
    /// For people.
    pub message: String,
}
