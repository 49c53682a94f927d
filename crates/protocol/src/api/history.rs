//! Queries about the history of a run, and their results by page. Times count from the start of the run.

use crate::{LogLevel, Stream};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Filter for events. Empty fields do not filter.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct EventQuery {
    /// First event to search, counted from 1.
    pub from: u64,
    /// Maximum number of events. The default and the upper limit are 1000.
    pub count: Option<u32>,
    /// True to include inputs, outputs and complete errors of states, and events that only carry a value.
    pub values: bool,
    /// Text in the state's path, by ids or names. With `*` or `?`, a pattern for the whole path.
    pub state: Option<String>,
    /// Types of events, joined by commas.
    pub kinds: Option<String>,
    /// Outcome of an end, by name or id.
    pub outcome: Option<String>,
    /// Text in the event, in any case.
    pub text: Option<String>,
    /// Earliest time, in ms.
    pub since_ms: Option<u64>,
    /// Latest time, in ms.
    pub until_ms: Option<u64>,
}

/// Filter for lines of the log. Empty fields do not filter.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct LogQuery {
    /// First event to search, counted from 1.
    pub from: u64,
    /// Maximum number of lines. The default and the upper limit are 1000.
    pub count: Option<u32>,
    /// Lowest severity to include.
    pub level: Option<LogLevel>,
    /// Text in the state's path, by ids or names. With `*` or `?`, a pattern for the whole path.
    pub state: Option<String>,
    /// Text in the line, in any case.
    pub text: Option<String>,
}

/// A page of a run's log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LogPage {
    /// The lines in order.
    pub lines: Vec<LogLine>,
    /// First event of the next page. All earlier events have been searched. If it is beyond `last`, no more events exist yet.
    pub next: u64,
    /// Last event that exists at present.
    pub last: u64,
}

/// One line of a run's log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LogLine {
    /// Sequence number of the event.
    pub sequence: u64,
    /// Time since the start of the run, in ns.
    pub t_ns: u64,
    /// Path of the state that wrote it: ids joined by `/`. Empty if no state did.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// Severity of the line.
    pub level: LogLevel,
    /// Source of the line.
    pub stream: Stream,
    /// Text of the line.
    pub message: String,
}

/// Selects a moment of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct MomentQuery {
    /// Time of the moment, in ms. The default is the last moment.
    pub t_ms: Option<u64>,
    /// Time of the moment, in ns.
    pub t_ns: Option<u64>,
}

/// Selects a machine of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct KeptMachineQuery {
    /// Hash of the machine, from a `root` event or a moment. The default is the machine at the start of the run.
    pub root: Option<String>,
    /// Library whose content is requested instead of the machine: its path and name, joined by `/`.
    pub library: Option<String>,
}

/// Format of an export, and a filter for its events. Empty fields do not filter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct ExportQuery {
    /// Format of the export.
    #[cfg_attr(feature = "schema", param(inline))]
    pub format: ExportFormat,
    /// Lines and tables: text in the state's path, by ids or names. With `*` or `?`, a pattern for the whole path.
    pub state: Option<String>,
    /// Lines and tables: types of events, joined by commas.
    pub kinds: Option<String>,
    /// Lines and tables: outcome of an end, by name or id.
    pub outcome: Option<String>,
    /// Lines and tables: text in the event, in any case.
    pub text: Option<String>,
    /// Lines and tables: lowest severity of log lines to include.
    pub level: Option<LogLevel>,
    /// Lines and tables: earliest time, in ns.
    pub since_ns: Option<u64>,
    /// Lines and tables: latest time, in ns.
    pub until_ns: Option<u64>,
}

/// File format of an exported run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum ExportFormat {
    /// One JSON object per line for each event.
    Jsonl,
    /// A table for spreadsheets.
    Csv,
    /// A recording for Foxglove and Lichtblick.
    Mcap,
}

/// One event with all recorded values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EventDetail {
    /// The event with its values.
    #[serde(flatten)]
    pub entry: super::HistoryEntry,
    /// Names of the event's state and its ancestors. Empty if the event has no state.
    pub names: String,
    /// Values that the event refers to, in the order of the ports. Values within the event itself are not repeated.
    pub values: Vec<NamedValue>,
}

/// A value with its name in an event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NamedValue {
    /// Name of the port or variable. Empty if it has no name.
    pub name: String,
    /// The recorded value, with a view limited in size.
    pub value: KeptValue,
}

/// A recorded value of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct KeptValue {
    /// Number of the value, counted from 1.
    pub number: u64,
    /// Name of its Python type.
    pub type_name: String,
    /// View of the value, limited in size.
    pub view: Value,
    /// Form in which a runner can restore the value.
    #[serde(flatten)]
    pub kept: KeptAs,
}

/// Form in which a value can be restored. Only runners read its bytes; they are never sent.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "kept", rename_all = "snake_case")]
pub enum KeptAs {
    /// The view contains the complete value.
    View,
    /// A pickle in the journal.
    Pickle {
        /// Size of the pickle in bytes.
        bytes: u64,
    },
    /// A pickle on the robot that the station can fetch.
    OnRobot {
        /// Size of the pickle in bytes.
        bytes: u64,
        /// Cost on the link, in bytes with all headers, without losses. Empty if this station does not receive from the robot.
        link_bytes: Option<u64>,
        /// Transfer time at the link's currently free rate, in ms. Empty without contact to the robot.
        takes_ms: Option<u64>,
        /// Progress of the current or last fetch.
        fetch: Option<ValueFetch>,
    },
    /// No restorable form exists.
    Nothing {
        /// Reason why no form exists, for people.
        reason: String,
    },
}

/// Progress of fetching a large value from a robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ValueFetch {
    /// Number of bytes received.
    pub here: u64,
    /// Number of bytes that may still be received before the fetch ends.
    pub budget: u64,
    /// Reason for a failed fetch. The next fetch reuses the received bytes.
    pub failed: Option<String>,
}

/// Request to fetch a large value from a robot.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct FetchValue {
    /// Maximum number of bytes to send, including lost ones. The default is 125 % of the value's size.
    #[serde(default)]
    pub budget: Option<u64>,
}
