//! Edits that a server had confirmed and that the next one could not apply.

use serde::{Deserialize, Serialize};

/// Unsaved edits of a machine that were set aside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SetAsideDraft {
    /// Names it in requests.
    pub id: String,
    /// ms since 1970, UTC; 0 if an earlier version of the server set it aside.
    pub at_ms: u64,
    /// Reason why the edits cannot be applied.
    pub reason: String,
    /// The number of its edits.
    pub count: u64,
    /// The edits, the oldest first; the first 1,000 of them.
    pub edits: Vec<SetAsideEdit>,
}

/// One edit that was set aside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SetAsideEdit {
    /// The user.
    pub author: String,
    /// ms since 1970, UTC.
    pub at_ms: u64,
    /// The name of the step.
    pub name: String,
    /// Description of the change.
    pub what: String,
}
