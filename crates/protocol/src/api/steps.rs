//! History of an open machine: a tree of steps, each of which can be restored.

use serde::{Deserialize, Serialize};

/// Cause of a revision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum RevisionKind {
    /// An edit by a user.
    Edit,
    /// The author undid a step.
    Undo,
    /// The author redid a step.
    Redo,
    /// The files were reloaded.
    Reload,
    /// An earlier revision was restored.
    Jump,
}

/// Known steps of an open machine. They form a tree, because an edit after an undo starts a new branch. A node is the start, or a
/// revision without `same_as`. Its parent is the node of the previous revision.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineSteps {
    /// Revision at which the machine was loaded: the root of the tree.
    pub start: u64,
    /// Steps in order, without gaps. The oldest are deleted if there are too many.
    pub steps: Vec<MachineStep>,
}

/// A revision of an open machine, without its changes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineStep {
    /// Number of the revision.
    pub revision: u64,
    /// The id of the edit, undo, redo, reload or jump.
    pub id: String,
    /// User who made the change.
    pub author: String,
    /// Name of the step. An undo has the name of the step that it undoes.
    pub name: String,
    /// Time of the change: ms since 1970, UTC.
    pub at_ms: u64,
    /// Origin of the change: edit, undo, redo, reload or jump.
    pub kind: RevisionKind,
    /// Earliest known revision with identical content, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_as: Option<u64>,
    /// True if the machine can still be restored to this revision.
    pub is_kept: bool,
}

/// Request to restore another revision of an open machine. It creates a step that its author can undo.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct JumpMachine {
    /// Id chosen by the sender. Repeated requests with one id are executed once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// Number of the revision to restore.
    pub revision: u64,
    /// True to restore even if this undoes steps of other users.
    #[serde(default)]
    pub over_others: bool,
}
