//! Where a run holds by itself.

use serde::{Deserialize, Serialize};

/// A breakpoint. It belongs to the run and outlives every viewer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Breakpoint {
    /// Chosen by whoever sets it; the same id replaces the earlier one.
    pub id: u64,
    /// The state: ids joined by `/`.
    pub path: String,
    /// On which side of the state.
    #[serde(default)]
    pub when: When,
    /// A Python expression over `inputs`, `outputs` (after exit), `scoped` (dicts by port name), `outcome` (after exit) and
    /// `gvm`; it holds only if this is true, or cannot be evaluated.
    #[serde(default)]
    pub condition: Option<String>,
    /// Holds from the n-th time on that it is passed and its condition is true; 0 and 1 mean each time.
    #[serde(default)]
    pub hit_count: u32,
    /// What is held.
    #[serde(default)]
    pub scope: Scope,
    /// What happens while no one is connected.
    #[serde(default)]
    pub unattended: Unattended,
    /// The same happens once nobody on the ground was heard for so many ms; `None`: silence makes no difference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost_link_ms: Option<u64>,
    /// A disabled one does nothing and is kept.
    #[serde(default = "yes")]
    pub enabled: bool,
}

fn yes() -> bool {
    true
}

/// On which side of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// Before it is entered.
    #[default]
    Before,
    /// After it was left, before what follows.
    After,
}

/// What a breakpoint holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// The branch that came to it.
    #[default]
    Branch,
    /// All branches, as a pause does.
    Run,
}

/// What a breakpoint does while no one is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Unattended {
    /// Holds all the same.
    #[default]
    Hold,
    /// Holds nothing, and releases what it held when the last viewer was lost.
    Continue,
    /// Stops the run.
    Stop,
}
