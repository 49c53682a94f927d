//! A long run seen through a window: what had been before it, what it holds, and the whole run drawn so wide. Each answer is bounded,
//! however long the run is.

use super::HistoryEntry;
use serde::{Deserialize, Serialize};

/// What was active after one event, without its data.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Before {
    /// The event; 0: before the first.
    pub sequence: u64,
    /// When it happened, in ns since the start of the run.
    pub t_ns: u64,
    /// Active states, each after the state around it.
    pub active: Vec<ActiveSince>,
}

/// An active state, and since when.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ActiveSince {
    /// Ids joined by `/`.
    pub path: String,
    /// The event that it was entered by.
    pub sequence: u64,
    /// When, in ns since the start of the run.
    pub t_ns: u64,
}

/// Which part of a run's events is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct WindowQuery {
    /// The first event; counts from 1.
    pub from: u64,
    /// So many events are looked at; 20,000 is the most, and what is looked at if it is left out. Those that only carry a value are
    /// left out.
    pub count: Option<u32>,
}

/// A part of a run's events, and what was active before it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Window {
    /// What was active before the first event.
    pub before: Before,
    /// The events, in order, without values.
    pub events: Vec<HistoryEntry>,
    /// The first event behind the part.
    pub next: u64,
    /// The last event that there is so far.
    pub last: u64,
}

/// What states did up to one event, and the events up to it that are worth a mark.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EarlierHistory {
    /// The event.
    pub sequence: u64,
    /// Every state that was entered.
    pub states: Vec<EarlierState>,
    /// Failures, warnings, commands, questions, hits of breakpoints, changes of the machine and the like: at most 5000, the newest.
    pub notable: Vec<HistoryEntry>,
}

/// What a state did up to an event. Steps back are not counted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EarlierState {
    /// Ids joined by `/`.
    pub path: String,
    /// How often it was entered.
    pub entries: u64,
    /// How often it ran to its end.
    pub ends: u64,
    /// Time that it was active, all together, in ns.
    pub total_ns: u64,
    /// The shortest, in ns.
    pub min_ns: u64,
    /// The longest, in ns.
    pub max_ns: u64,
    /// Its last entry.
    pub entered: Option<EventTime>,
    /// Its last end.
    pub left: Option<EndTime>,
}

/// When something happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EventTime {
    /// The event.
    pub sequence: u64,
    /// When, in ns since the start of the run.
    pub t_ns: u64,
}

/// When and how a state ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EndTime {
    /// The event.
    pub sequence: u64,
    /// When, in ns since the start of the run.
    pub t_ns: u64,
    /// How.
    pub outcome: crate::Outcome,
}

/// Which part of a run's time is wanted, and how wide it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct OverviewQuery {
    /// From this time on, in ns since the start of the run.
    pub from_ns: u64,
    /// Up to this time; all that there is if it is left out.
    pub to_ns: Option<u64>,
    /// On so many pixels: 10,000 at most. Calls narrower than two of them come together.
    pub pixels: Option<u32>,
}

/// The calls of a part of a run's time, as wide as they are drawn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Overview {
    /// The last event that there is so far.
    pub sequence: u64,
    /// When it happened, in ns since the start of the run.
    pub t_ns: u64,
    /// States of which two children ran at once.
    pub concurrent: Vec<String>,
    /// States that the bars name, by number.
    pub paths: Vec<String>,
    /// Calls that never run side by side, a list for each place where some do.
    pub rows: Vec<OverviewRow>,
}

/// Calls of a state's children one after the other; of concurrent children a row for each.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OverviewRow {
    /// One of the states whose calls these are, by its number; the row stands where it does.
    pub place: u32,
    /// From left to right.
    pub bars: Vec<OverviewBar>,
}

/// A call, or several that are too narrow to be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OverviewBar {
    /// When the first began, in ns since the start of the run.
    pub from_ns: u64,
    /// When the last ended; none while it goes on.
    pub to_ns: Option<u64>,
    /// How many calls.
    pub many: u64,
    /// How many of them failed: ended by *aborted*, or left an error.
    pub failed: u64,
    /// The state of the first, by its number.
    pub place: u32,
    /// The event that the first was entered by.
    pub sequence: u64,
    /// How the first ended.
    pub end: CallEnd,
}

/// How a call ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum CallEnd {
    /// It goes on.
    Open,
    /// By an outcome of its own.
    Ended,
    /// By *aborted*, or with an error.
    Aborted,
    /// By *preempted*.
    Preempted,
    /// It was a step back, or was undone by one.
    Back,
    /// The run went back, or its runner died.
    Dropped,
}

/// How far the states of a run are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct StatisticsQuery {
    /// Up to this event; all that there is if it is left out.
    pub until: Option<u64>,
}

/// What is searched for in a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
#[serde(default)]
pub struct HitQuery {
    /// In names of states that are entered, outcomes of states that end, and lines of the log; whatever its case.
    pub text: String,
    /// The first event that is looked at; counts from 1.
    pub from: u64,
    /// At most so many hits; 1000 is the most, and what is given if it is left out.
    pub count: Option<u32>,
}
