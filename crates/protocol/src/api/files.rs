//! Projects and libraries as they lie on disk.

use serde::{Deserialize, Serialize};

/// A folder that the server was started with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Project {
    /// Names it in requests; unique on the server.
    pub id: String,
    /// Its folder's name, for people.
    pub name: String,
    /// Where it lies, for people.
    pub folder: String,
}

/// A folder of a project.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[cfg_attr(feature = "schema", schema(no_recursion))]
pub struct FileNode {
    /// Its name.
    pub name: String,
    /// From the project's folder on, joined by `/`.
    pub path: String,
    /// What it is.
    pub kind: NodeKind,
    /// What is inside a folder; a machine is shown as one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<Self>,
    /// Whether not everything inside is told: ask for the tree from its path on.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_cut: bool,
}

/// What a folder of a project is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum NodeKind {
    /// Holds others.
    Folder,
    /// A state machine.
    Machine,
}

/// Which part of a project's tree is asked for.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct TreeFrom {
    /// From this folder on, joined by `/`; left out: the whole project.
    #[serde(default)]
    pub path: String,
}

/// Where a machine lies.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineFile {
    /// The project's id.
    pub project: String,
    /// The machine's folder, from the project's folder on, joined by `/`.
    pub path: String,
}

/// A root of libraries, as the configuration or the command line names it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryRoot {
    /// Its name: the first part of a library path.
    pub name: String,
    /// Where it lies, for people.
    pub folder: String,
    /// What is in it.
    pub children: Vec<LibraryNode>,
}

/// A library, or a folder of libraries.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[cfg_attr(feature = "schema", schema(no_recursion))]
pub struct LibraryNode {
    /// Its name: the last part of a library path.
    pub name: String,
    /// What it is.
    pub kind: LibraryNodeKind,
    /// What is inside a folder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<Self>,
}

/// What a folder of a library root is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LibraryNodeKind {
    /// Holds others.
    Folder,
    /// A state machine that can be used as a state.
    Library,
}
