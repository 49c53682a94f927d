//! Views of a part of a long run: the state before the part, its events, and an overview at a given width. Each reply is bounded,
//! however long the run is.

use super::HistoryEntry;
use serde::{Deserialize, Serialize};

/// States that are active after one event, without their data.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Before {
    /// Number of the event. 0 for the moment before the first event.
    pub sequence: u64,
    /// Time of the event, in ns since the start of the run.
    pub t_ns: u64,
    /// Active states, each after its parent.
    pub active: Vec<ActiveSince>,
}

/// An active state and its entry.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ActiveSince {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Event by which it was entered.
    pub sequence: u64,
    /// Entry time, in ns since the start of the run.
    pub t_ns: u64,
}

/// Selects a part of a run's events.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct WindowQuery {
    /// First event, counted from 1.
    pub from: u64,
    /// Number of events to read. The default and the upper limit are 20,000. Events that only carry a value are omitted.
    pub count: Option<u32>,
}

/// A part of a run's events, and the states active before it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Window {
    /// States active before the first event.
    pub before: Before,
    /// The events in order, without values.
    pub events: Vec<HistoryEntry>,
    /// First event after the part.
    pub next: u64,
    /// Last event that exists at present.
    pub last: u64,
}

/// Activity of states up to one event, and the notable events up to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EarlierHistory {
    /// Number of the event.
    pub sequence: u64,
    /// Every state that was entered.
    pub states: Vec<EarlierState>,
    /// The newest notable events, at most 5000: failures, warnings, commands, questions, hits of breakpoints, changes of the
    /// machine and the like.
    pub notable: Vec<HistoryEntry>,
}

/// Activity of a state up to an event. Steps back are not counted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EarlierState {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Number of entries of the state.
    pub entries: u64,
    /// Number of completed executions.
    pub ends: u64,
    /// Total active time, in ns.
    pub total_ns: u64,
    /// Shortest execution, in ns.
    pub min_ns: u64,
    /// Longest execution, in ns.
    pub max_ns: u64,
    /// Last entry of the state.
    pub entered: Option<EventTime>,
    /// Last end of the state.
    pub left: Option<EndTime>,
}

/// An event and its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EventTime {
    /// Number of the event.
    pub sequence: u64,
    /// Time, in ns since the start of the run.
    pub t_ns: u64,
}

/// Time and outcome of a state's end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EndTime {
    /// Number of the event.
    pub sequence: u64,
    /// Time, in ns since the start of the run.
    pub t_ns: u64,
    /// Outcome of the state.
    pub outcome: crate::Outcome,
}

/// Selects a part of a run's time, and the width of its drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct OverviewQuery {
    /// Start of the part, in ns since the start of the run.
    pub from_ns: u64,
    /// End of the part, in ns since the start of the run. The default is the end of the run.
    pub to_ns: Option<u64>,
    /// Width in pixels, at most 10,000. Calls narrower than two pixels are merged.
    pub pixels: Option<u32>,
}

/// Calls in a part of a run's time, for a drawing of a given width.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Overview {
    /// Last event that exists at present.
    pub sequence: u64,
    /// Time of that event, in ns since the start of the run.
    pub t_ns: u64,
    /// Paths of states with children that ran concurrently.
    pub concurrent: Vec<String>,
    /// Paths of the states, to which bars refer by index.
    pub paths: Vec<String>,
    /// Rows of calls that do not overlap. Concurrent children have a row each.
    pub rows: Vec<OverviewRow>,
}

/// Successive calls of a state's children. Each concurrent child has its own row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OverviewRow {
    /// Index of one of the states called. It determines the position of the row.
    pub place: u32,
    /// Bars from left to right.
    pub bars: Vec<OverviewBar>,
}

/// A call, or several calls that are too narrow to draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OverviewBar {
    /// Start of the first call, in ns since the start of the run.
    pub from_ns: u64,
    /// End of the last call. Empty while that call is active.
    pub to_ns: Option<u64>,
    /// Number of calls in the bar.
    pub many: u64,
    /// Number of failed calls: ended by *aborted* or with an error.
    pub failed: u64,
    /// Index of the first call's state.
    pub place: u32,
    /// Event by which the first call was entered.
    pub sequence: u64,
    /// Type of end of the first call.
    pub end: CallEnd,
}

/// Type of end of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum CallEnd {
    /// The call is still active.
    Open,
    /// Ended by an outcome of its own.
    Ended,
    /// Ended by *aborted* or with an error.
    Aborted,
    /// Ended by *preempted* without an error.
    Preempted,
    /// The call was a step back or was undone by one.
    Back,
    /// The run went back, or its runner died.
    Dropped,
}

/// Selects the part of a run for statistics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct StatisticsQuery {
    /// Last event to count. The default is the last event of the run.
    pub until: Option<u64>,
}

/// Search for text in a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct HitQuery {
    /// Text to find in names of entered states, outcomes of ended states, and lines of the log, in any case.
    pub text: String,
    /// First event to search, counted from 1.
    pub from: u64,
    /// Maximum number of hits. The default and the upper limit are 1000.
    pub count: Option<u32>,
}
