//! The server as a whole, and its refusals.

use super::{MachineSummary, RunSummary};
use serde::{Deserialize, Serialize};

/// Proof that the server is running. It needs no login.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Health {
    /// Name of the program: always `rafcon`.
    pub program: String,
    /// Version of the server.
    pub version: String,
}

/// Current status of everything that the server manages.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ServerStatus {
    /// Number that changes with every change of a project or library file. Clients then request the trees again.
    pub files_revision: u64,
    /// All open machines, saved or not.
    pub machines: Vec<MachineSummary>,
    /// Active runs, and runs that changed since the server started, the newest first.
    pub runs: Vec<RunSummary>,
}

/// Reason for a refused request: cause, location and remedy.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Refusal {
    /// Stable code in `snake_case`, for programs.
    pub code: String,
    /// Cause, location and remedy, for people.
    pub message: String,
}
