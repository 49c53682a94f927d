//! What was done to an open machine: a tree of steps, and the way to any of them.

use serde::{Deserialize, Serialize};

/// What made a revision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum RevisionKind {
    /// An edit.
    Edit,
    /// Its author took a step back.
    Undo,
    /// Its author made a step again.
    Redo,
    /// The files were read again.
    Reload,
    /// The machine became what it was at an earlier revision.
    Jump,
}

/// The steps of an open machine that are known: a tree, for whoever goes back and on takes another branch. A node is a revision
/// without `same_as`, or the start; it hangs on the node of the revision before.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineSteps {
    /// The revision as which the machine was read: the root of the tree.
    pub start: u64,
    /// In order; without a gap, but the oldest go when there are too many.
    pub steps: Vec<MachineStep>,
}

/// A revision of an open machine, without what it changed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineStep {
    /// Its number.
    pub revision: u64,
    /// The id of the edit, undo, redo, reload or jump.
    pub id: String,
    /// Who made it.
    pub author: String,
    /// What it is called; an undo has the name of what it takes back.
    pub name: String,
    /// When: ms since 1970, UTC.
    pub at_ms: u64,
    /// What it was.
    pub kind: RevisionKind,
    /// The earliest revision that is known at which the machine was the very same; none if it never was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_as: Option<u64>,
    /// Whether the machine can still become what it was then.
    pub is_kept: bool,
}

/// Makes an open machine what it was at another revision: a step like any other, which its author can take back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct JumpMachine {
    /// Chosen by the sender; the same id is carried out once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// The revision.
    pub revision: u64,
    /// Also if that takes steps of other people away.
    #[serde(default)]
    pub over_others: bool,
}
