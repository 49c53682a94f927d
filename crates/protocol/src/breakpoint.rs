//! Breakpoints, at which a run holds by itself.

use serde::{Deserialize, Serialize};

/// A breakpoint. It belongs to the run and outlives every viewer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Breakpoint {
    /// Id chosen by the client. A breakpoint with an equal id is replaced.
    pub id: u64,
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Side of the state.
    #[serde(default)]
    pub when: When,
    /// Python expression over `inputs`, `outputs` (after exit), `scoped` (dicts by port name), `outcome` (after exit) and `gvm`.
    /// The breakpoint holds only if the expression is true or cannot be evaluated.
    #[serde(default)]
    pub condition: Option<String>,
    /// Number of passes with a true condition from which on the breakpoint holds. 0 and 1 mean each pass.
    #[serde(default)]
    pub hit_count: u32,
    /// Branches that are held.
    #[serde(default)]
    pub scope: Scope,
    /// Action while no viewer is connected.
    #[serde(default)]
    pub unattended: Unattended,
    /// Silence of the ground, in ms, after which the action `unattended` applies as well. `None` to ignore silence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost_link_ms: Option<u64>,
    /// False to keep the breakpoint without effect.
    #[serde(default = "yes")]
    pub enabled: bool,
}

fn yes() -> bool {
    true
}

/// Side of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// Before the state is entered.
    #[default]
    Before,
    /// After the state was left, before the next one.
    After,
}

/// Branches that a breakpoint holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// The branch that reached the breakpoint.
    #[default]
    Branch,
    /// All branches, as a pause does.
    Run,
}

/// Action of a breakpoint while no viewer is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Unattended {
    /// Hold, as if a viewer were connected.
    #[default]
    Hold,
    /// Do not hold. What the breakpoint holds is released when the last viewer disconnects.
    Continue,
    /// Stop the run at the breakpoint.
    Stop,
}
