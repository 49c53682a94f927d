//! What is asked about the past of a run, and how it is answered page by page. Times of a run count from its start.

use crate::{LogLevel, Stream};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Which events are wanted. What is left out limits nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct EventQuery {
    /// The first that is looked at; counts from 1.
    pub from: u64,
    /// At most so many; 1000 is the most, and what is given if it is left out.
    pub count: Option<u32>,
    /// With inputs and outputs of states, their errors as a whole, and the events that are nothing but a value.
    pub values: bool,
    /// Of states with this in their path of names or ids; with `*` or `?`, that are this as a whole.
    pub state: Option<String>,
    /// Of these kinds, joined by commas.
    pub kinds: Option<String>,
    /// Ends by this outcome: name or id.
    pub outcome: Option<String>,
    /// With this text in them, whatever its case.
    pub text: Option<String>,
    /// From this time on, in ms.
    pub since_ms: Option<u64>,
    /// Up to this time, in ms.
    pub until_ms: Option<u64>,
}

/// Which lines of the log are wanted. What is left out limits nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct LogQuery {
    /// The first event that is looked at; counts from 1.
    pub from: u64,
    /// At most so many lines; 1000 is the most, and what is given if it is left out.
    pub count: Option<u32>,
    /// That matter at least so much.
    pub level: Option<LogLevel>,
    /// Of states with this in their path of names or ids; with `*` or `?`, that are this as a whole.
    pub state: Option<String>,
    /// With this text in them, whatever its case.
    pub text: Option<String>,
}

/// A page of a run's log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LogPage {
    /// The lines, in order.
    pub lines: Vec<LogLine>,
    /// Where the next page begins: everything before was looked at. Beyond `last`, there is no more so far.
    pub next: u64,
    /// The last event that there is so far.
    pub last: u64,
}

/// One line of a run's log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LogLine {
    /// The event.
    pub sequence: u64,
    /// Time since the start of the run, in ns.
    pub t_ns: u64,
    /// The state that wrote it: ids joined by `/`; empty if none did.
    pub path: String,
    /// The same by names.
    pub names: String,
    /// How much it matters.
    pub level: LogLevel,
    /// Where it came from.
    pub stream: Stream,
    /// The text.
    pub message: String,
}

/// Which moment is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct MomentQuery {
    /// The one at this time, in ms; if it is left out, the last.
    pub t_ms: Option<u64>,
    /// The same in ns.
    pub t_ns: Option<u64>,
}

/// Which machine of a run is meant.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct KeptMachineQuery {
    /// Its hash, as an event `root` or a moment says it; if it is left out, the one that the run began with.
    pub root: Option<String>,
    /// Instead of the machine itself, the content of a library that it uses: path and name of the library, joined by `/`.
    pub library: Option<String>,
}

/// How a run is written, and which of its events are; what is left out limits nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct ExportQuery {
    /// In which format.
    #[cfg_attr(feature = "schema", param(inline))]
    pub format: ExportFormat,
    /// Lines and tables: of states with this in their path of names or ids; with `*` or `?`, that are this as a whole.
    pub state: Option<String>,
    /// Lines and tables: of these kinds, joined by commas.
    pub kinds: Option<String>,
    /// Lines and tables: ends by this outcome, name or id.
    pub outcome: Option<String>,
    /// Lines and tables: with this text in them, whatever its case.
    pub text: Option<String>,
    /// Lines and tables: of lines of the log those that matter at least so much.
    pub level: Option<LogLevel>,
    /// Lines and tables: from this time on, in ns.
    pub since_ns: Option<u64>,
    /// Lines and tables: up to this time, in ns.
    pub until_ns: Option<u64>,
}

/// A format of other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum ExportFormat {
    /// Every event as a JSON object on a line.
    Jsonl,
    /// A table for spreadsheets.
    Csv,
    /// A recording for Foxglove and Lichtblick.
    Mcap,
}

/// One event with all that is kept of its values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EventDetail {
    /// The event, with values.
    #[serde(flatten)]
    pub entry: super::HistoryEntry,
    /// The names of the state that it is about; empty if it is about none.
    pub names: String,
    /// What it names, in the order of the ports; without what stands in the event itself.
    pub values: Vec<NamedValue>,
}

/// A value by what an event calls it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NamedValue {
    /// The port or variable; empty if it has no name.
    pub name: String,
    /// The value.
    pub value: KeptValue,
}

/// A value that a run has kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct KeptValue {
    /// Counts from 1.
    pub number: u64,
    /// The name of its Python type.
    pub type_name: String,
    /// What can be shown of it: bounded.
    pub view: Value,
    /// From what a runner can make it again.
    #[serde(flatten)]
    pub kept: KeptAs,
}

/// From what a value can be made again. Its bytes are read by runners only, and never sent.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "kept", rename_all = "snake_case")]
pub enum KeptAs {
    /// The view is all of it.
    View,
    /// A pickle.
    Pickle {
        /// Its size in bytes.
        bytes: u64,
    },
    /// A pickle that the robot has, and its station does not: it can be fetched.
    OnRobot {
        /// Its size in bytes.
        bytes: u64,
        /// What it costs on the link, in bytes with all headers, if nothing is lost; none if this station does not receive that robot.
        link_bytes: Option<u64>,
        /// How long it takes with what the link has left now, in ms; none if the robot is not heard.
        takes_ms: Option<u64>,
        /// How far it is, if it is being fetched or was last.
        fetch: Option<ValueFetch>,
    },
    /// Nothing.
    Nothing {
        /// Why.
        reason: String,
    },
}

/// How far a large value is on its way from a robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ValueFetch {
    /// So many of its bytes are here.
    pub here: u64,
    /// So many bytes may still come before the fetch ends.
    pub budget: u64,
    /// Why it ended, if it did; what is here stays for another one.
    pub failed: Option<String>,
}

/// Asks for a large value of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct FetchValue {
    /// So many of its bytes may be sent, those that are lost on the way included; none: a quarter more than it has.
    #[serde(default)]
    pub budget: Option<u64>,
}
