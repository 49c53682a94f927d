//! Edits that one server confirmed and its successor could not apply.

use serde::{Deserialize, Serialize};

/// Unsaved edits of a machine that were set aside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SetAsideDraft {
    /// Id that selects these edits in requests.
    pub id: String,
    /// Time in ms since 1970, UTC. 0 if an earlier version of the server set it aside.
    pub at_ms: u64,
    /// Reason why the edits cannot be applied.
    pub reason: String,
    /// Number of its edits.
    pub count: u64,
    /// Up to 1,000 of the edits, the oldest first.
    pub edits: Vec<SetAsideEdit>,
}

/// One edit that was set aside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SetAsideEdit {
    /// Name of the user.
    pub author: String,
    /// Time in ms since 1970, UTC.
    pub at_ms: u64,
    /// Name of the step.
    pub name: String,
    /// Description of the change.
    pub what: String,
}
