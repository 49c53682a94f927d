//! Checks of scripts by Python's own parser.

use super::{Repair, Severity};
use serde::{Deserialize, Serialize};

/// Request to check a script with Python's parser. The script is not executed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CheckScript {
    /// Text of the script.
    pub script: String,
    /// State that the script is for. If set, outcomes and ports in the script are compared with those of the state.
    #[serde(default)]
    pub state: Option<ScriptPlace>,
}

/// A state of an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ScriptPlace {
    /// Id of the open machine.
    pub machine: String,
    /// Path of the state: ids joined by `/`.
    pub path: String,
}

/// An error or warning of Python's parser at a location of a script.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ScriptProblem {
    /// Line, counted from 1.
    pub line: u32,
    /// Column, counted from 1 in UTF-16 units as in JavaScript.
    pub column: u32,
    /// Last line, if the parser reports it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_line: Option<u32>,
    /// Column after the end, if the parser reports it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_column: Option<u32>,
    /// Message of the parser.
    pub message: String,
    /// Severity. An error prevents the script from running, or its state from ending correctly.
    pub severity: Severity,
    /// Edits of the machine that repair the fault.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repairs: Vec<Repair>,
}
