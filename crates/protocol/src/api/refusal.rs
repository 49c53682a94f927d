//! The answer to a request that cannot be served.

use serde::{Deserialize, Serialize};

/// Why a request was refused: what, where, and the way out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Refusal {
    /// For programs: a stable word in `snake_case`.
    pub code: String,
    /// For people.
    pub message: String,
}
