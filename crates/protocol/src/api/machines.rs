//! Open machines: what several people edit at the same time.

use super::{LibraryName, MachineFile, RevisionKind};
use serde::{Deserialize, Serialize};

/// An open machine in one line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineSummary {
    /// Names it in requests while it is open, and again when the same folder is opened again.
    pub id: String,
    /// Where it lies; none if it was never saved.
    pub file: Option<MachineFile>,
    /// The root state's name.
    pub name: String,
    /// Rises by one with every edit, undo, redo, reload and jump. No number counts twice for a machine, also not after it was closed
    /// or the server was started again.
    pub revision: u64,
    /// The revision that lies on disk.
    pub saved_revision: u64,
    /// Whether it has edits that do not lie on disk.
    pub is_changed: bool,
    /// What another program did to its files.
    pub disk: DiskState,
    /// It has unsaved edits that an earlier server had confirmed.
    pub is_recovered: bool,
    /// Number of drafts that are set aside because their edits could not be applied.
    #[serde(default)]
    pub set_aside: u64,
}

/// What another program did to the files of an open machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum DiskState {
    /// Nothing.
    #[default]
    Same,
    /// They hold another machine now: reload it, or save over it.
    Changed,
    /// They are gone.
    Missing,
}

/// Opens the machine in a folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineAt {
    /// The folder.
    pub file: MachineFile,
}

/// Makes a new machine and opens it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NewMachine {
    /// Its folder, which must not exist.
    pub file: MachineFile,
    /// The root state's name.
    pub name: String,
}

/// Saves an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SaveMachine {
    /// Save it in this folder from now on; none: where it lies.
    #[serde(default)]
    pub file: Option<MachineFile>,
    /// Save over files that another program changed.
    #[serde(default)]
    pub overwrite: bool,
    /// Write a copy to `file`, and stay where it lies.
    #[serde(default)]
    pub copy: bool,
}

/// Saves a state of an open machine as a machine of its own: a library, if it lies below a library root.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SaveState {
    /// The state: ids joined by `/`.
    pub path: String,
    /// Its folder.
    pub file: MachineFile,
    /// Save over a machine that lies there.
    #[serde(default)]
    pub overwrite: bool,
}

/// Where a state was saved.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct SavedState {
    /// Its folder.
    pub file: MachineFile,
    /// How library states name it; none if it lies below no library root.
    pub library: Option<LibraryName>,
}

/// Closes an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CloseMachine {
    /// Give up edits that do not lie on disk.
    #[serde(default)]
    pub discard: bool,
}

/// The whole of an open machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineDocument {
    /// As it was at this revision.
    pub revision: u64,
    /// The machine.
    pub document: crate::document::Document,
}

/// Reads the files of an open machine again. What the machine was before can be had back by an undo.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ReloadMachine {
    /// Chosen by the sender; the same id is carried out once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
}

/// Copies states of an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct CopyStates {
    /// The path of the container around them.
    pub path: String,
    /// Their ids.
    pub states: Vec<String>,
    /// Ids of scoped variables that go with them.
    #[serde(default)]
    pub scoped_variables: Vec<i64>,
}

/// Something was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Done {
    /// The revision that it made, or that lies on disk now.
    pub revision: u64,
}

/// Revisions of an open machine from a cursor on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RevisionPage {
    /// Whether those that were asked for are gone: then there are none here, and the whole machine is to be asked for.
    pub is_reset: bool,
    /// In order, without a gap; none if there is nothing new.
    pub revisions: Vec<Revision>,
    /// Where the next page begins.
    pub next: u64,
}

/// From where on revisions are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct RevisionsFrom {
    /// The first revision that has not been seen.
    pub from: u64,
}

/// One edit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct EditMachine {
    /// Chosen by the sender; the same id is carried out once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
    /// The revision that the sender had seen; for the record.
    #[serde(default)]
    pub base: Option<u64>,
    /// What the step is called in the history: "Rename state".
    pub name: String,
    /// The edit (`docs/edits.md`).
    pub edit: crate::edit::Edit,
}

/// Takes back, or makes again, one's own last step.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Undo {
    /// Chosen by the sender; the same id is carried out once.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 128))]
    pub id: String,
}

/// A step in the life of an open machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Revision {
    /// Its number.
    pub revision: u64,
    /// The id of the edit, undo or redo.
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
    /// What is different now.
    pub changes: Vec<crate::document::Change>,
}

/// The latest truth about an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineStatus {
    /// In one line.
    pub summary: MachineSummary,
    /// Who else looks at it.
    pub people: Vec<Presence>,
}

/// Someone who looks at an open machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Presence {
    /// The connection, by a number of the server's.
    pub connection: u64,
    /// The user.
    pub user: String,
    /// Paths of the selected states.
    pub selection: Vec<String>,
}

/// A fault of a machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineProblem {
    /// The state: ids joined by `/`.
    pub path: String,
    /// Which part of it, in words.
    pub part: String,
    /// The rule, for programs.
    pub rule: String,
    /// How bad it is.
    pub severity: Severity,
    /// What, where, and the way out.
    pub message: String,
    /// The line of the state's script that it is about, counted from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub line: Option<u64>,
    /// Edits that would mend it, the one that keeps most first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repairs: Vec<Repair>,
}

/// An edit that mends a fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Repair {
    /// What it does, for people; also the name of the step.
    pub name: String,
    /// The edit, as the machine is now.
    pub edit: crate::edit::Edit,
}

/// How bad a problem is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The machine does not do what it says.
    Error,
    /// It may not.
    Warning,
    /// Worth knowing.
    Note,
}
