//! Open machines. Several people can edit one together.

use super::{LibraryName, MachineFile, RevisionKind};
use serde::{Deserialize, Serialize};

/// Summary of an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineSummary {
    /// Id for requests. It stays valid if the folder is closed and opened again.
    pub id: String,
    /// Location of the machine. Empty if it was never saved.
    pub file: Option<MachineFile>,
    /// Name of the root state.
    pub name: String,
    /// Revision number. It increases by one with every edit, undo, redo, reload and jump. A number is never reused for a machine,
    /// even after the machine is closed or the server restarts.
    pub revision: u64,
    /// Revision that is saved on disk.
    pub saved_revision: u64,
    /// True if the machine has unsaved edits.
    pub is_changed: bool,
    /// Changes of its files by other programs.
    pub disk: DiskState,
    /// True if it has unsaved edits that a previous server process had confirmed.
    pub is_recovered: bool,
    /// Number of drafts set aside because their edits could not be applied.
    #[serde(default)]
    pub set_aside: u64,
}

/// Changes of an open machine's files by other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum DiskState {
    /// The files are unchanged.
    #[default]
    Same,
    /// The files hold another machine now. Reload it or overwrite it.
    Changed,
    /// The files no longer exist.
    Missing,
}

/// Request to open the machine in a folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineAt {
    /// Folder of the machine.
    pub file: MachineFile,
}

/// Request to create and open a new machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NewMachine {
    /// Folder of the machine, which must not exist.
    pub file: MachineFile,
    /// Name of the root state.
    pub name: String,
}

/// Request to save an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SaveMachine {
    /// New folder of the machine. Empty for its current folder.
    #[serde(default)]
    pub file: Option<MachineFile>,
    /// True to overwrite files that another program changed.
    #[serde(default)]
    pub overwrite: bool,
    /// True to write a copy to `file` and keep the current folder.
    #[serde(default)]
    pub copy: bool,
}

/// Request to save a state of an open machine as a machine. Below a library root, that machine is a library.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SaveState {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Folder of the new machine.
    pub file: MachineFile,
    /// True to overwrite a machine in that folder.
    #[serde(default)]
    pub overwrite: bool,
}

/// Location of a saved state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SavedState {
    /// Folder of the saved state.
    pub file: MachineFile,
    /// Library name for use in library states. Empty outside library roots.
    pub library: Option<LibraryName>,
}

/// Request to close an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CloseMachine {
    /// True to discard unsaved edits.
    #[serde(default)]
    pub discard: bool,
}

/// Content of an open machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineDocument {
    /// Revision of the content.
    pub revision: u64,
    /// The machine as a document.
    pub document: crate::document::Document,
}

/// Request to reload the files of an open machine. An undo restores the previous content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ReloadMachine {
    /// Id chosen by the sender. Repeated requests with one id are executed once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
}

/// Request to copy states of an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CopyStates {
    /// Path of the parent container.
    pub path: String,
    /// Ids of the states.
    pub states: Vec<String>,
    /// Ids of the scoped variables to copy as well.
    #[serde(default)]
    pub scoped_variables: Vec<i64>,
}

/// Confirmation of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Done {
    /// Revision that the request created, or that is on disk now.
    pub revision: u64,
}

/// Revisions of an open machine, from a cursor on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RevisionPage {
    /// True if the requested revisions no longer exist. The page is then empty, and the client must fetch the whole machine.
    pub is_reset: bool,
    /// Revisions in order, without a gap. Empty if there are no new ones.
    pub revisions: Vec<Revision>,
    /// First revision of the next page.
    pub next: u64,
}

/// Selects the first requested revision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct RevisionsFrom {
    /// First revision that the client has not seen.
    pub from: u64,
}

/// Request to edit an open machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EditMachine {
    /// Id chosen by the sender. Repeated requests with one id are executed once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// Revision that the sender had seen, for the record.
    #[serde(default)]
    pub base: Option<u64>,
    /// Name of the step in the history, such as "Rename state".
    pub name: String,
    /// The edit to apply (`docs/edits.md`).
    pub edit: crate::edit::Edit,
}

/// Request to undo or redo the user's own last step.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Undo {
    /// Id chosen by the sender. Repeated requests with one id are executed once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
}

/// A change of an open machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Revision {
    /// Number of the revision.
    pub revision: u64,
    /// Id of the edit, undo or redo.
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
    /// Differences from the previous revision.
    pub changes: Vec<crate::document::Change>,
}

/// Current status of an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineStatus {
    /// Summary of the machine.
    pub summary: MachineSummary,
    /// Viewers of the machine.
    pub people: Vec<Presence>,
}

/// A viewer of an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Presence {
    /// Number of the connection, assigned by the server.
    pub connection: u64,
    /// Name of the user.
    pub user: String,
    /// Paths of the selected states.
    pub selection: Vec<String>,
}

/// A fault of a machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineProblem {
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Affected part of the state, in words.
    pub part: String,
    /// Name of the violated rule, for programs.
    pub rule: String,
    /// Severity of the fault.
    pub severity: Severity,
    /// Fault, location and remedy.
    pub message: String,
    /// Affected line of the state's script, counted from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub line: Option<u64>,
    /// Edits that repair the fault. The edit that preserves most comes first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repairs: Vec<Repair>,
}

/// An edit that repairs a fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Repair {
    /// Description for people, and name of the step in the history.
    pub name: String,
    /// The edit, for the current revision.
    pub edit: crate::edit::Edit,
}

/// Severity of a machine's fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The machine does not behave as written.
    Error,
    /// The machine may not behave as written.
    Warning,
    /// A hint for the author.
    Note,
}
