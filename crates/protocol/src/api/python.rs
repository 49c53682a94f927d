//! What Python's own parser says about a script.

use super::{Repair, Severity};
use serde::{Deserialize, Serialize};

/// Asks what Python's parser says about a script. Nothing of it runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CheckScript {
    /// The text.
    pub script: String,
    /// The state whose script it is to be; with it, the outcomes and ports in the text are compared with those of the state.
    #[serde(default)]
    pub state: Option<ScriptPlace>,
}

/// A state of an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ScriptPlace {
    /// The id of the open machine.
    pub machine: String,
    /// The state: ids joined by `/`.
    pub path: String,
}

/// A place in a script that Python's parser does not take, or warns of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ScriptProblem {
    /// The line, from 1 on.
    pub line: u32,
    /// The column, from 1 on; counted as JavaScript counts (UTF-16).
    pub column: u32,
    /// The line where it ends, if the parser says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_line: Option<u32>,
    /// The column behind its end, if the parser says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_column: Option<u32>,
    /// What the parser says.
    pub message: String,
    /// An error keeps the script from running, or its state from ending as it should.
    pub severity: Severity,
    /// Edits of the machine that mend it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repairs: Vec<Repair>,
}
