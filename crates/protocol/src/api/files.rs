//! Projects and libraries on disk, git versions of a machine, and usages of a library.

use serde::{Deserialize, Serialize};

/// A project folder of the server.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Project {
    /// Id for requests, unique on the server.
    pub id: String,
    /// Name of the folder, for people.
    pub name: String,
    /// Path of the folder, for people.
    pub folder: String,
}

/// A node in the tree of a project.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[cfg_attr(feature = "schema", schema(no_recursion))]
pub struct FileNode {
    /// Name of the folder.
    pub name: String,
    /// Path from the project's folder, joined by `/`.
    pub path: String,
    /// A machine, or a folder with further folders.
    pub kind: NodeKind,
    /// Content of a folder. A machine has no children.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<Self>,
    /// True if the content is incomplete. Request the tree from this path.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_cut: bool,
}

/// Kind of folder in a project.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum NodeKind {
    /// A folder with other folders.
    Folder,
    /// The folder of a state machine.
    Machine,
}

/// Selects a part of a project's tree.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct TreeFrom {
    /// Path of the folder to start from, joined by `/`. Empty for the whole project.
    #[serde(default)]
    pub path: String,
}

/// Location of a machine.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineFile {
    /// Id of the project.
    pub project: String,
    /// Path of the machine's folder from the project's folder, joined by `/`.
    pub path: String,
}

/// A library root from the configuration or the command line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryRoot {
    /// Name of the root: the first part of a library path.
    pub name: String,
    /// Path of the folder, for people.
    pub folder: String,
    /// Libraries and folders in it.
    pub children: Vec<LibraryNode>,
}

/// A library, or a folder of libraries.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[cfg_attr(feature = "schema", schema(no_recursion))]
pub struct LibraryNode {
    /// Name of the folder: one part of a library path.
    pub name: String,
    /// A library, or a folder with further folders.
    pub kind: LibraryNodeKind,
    /// Content of a folder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<Self>,
}

/// Kind of folder in a library root.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LibraryNodeKind {
    /// A folder with other folders.
    Folder,
    /// A state machine that can be used as a state.
    Library,
}

/// Git versions of a machine.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineVersions {
    /// True if the machine's folder is in a git repository and git is available.
    pub is_git: bool,
    /// Commits that touched the folder, the newest first.
    pub versions: Vec<MachineVersion>,
    /// True if there are older commits that are not listed.
    pub is_cut: bool,
}

/// A commit that touched a machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineVersion {
    /// Hash of the commit, in hexadecimal.
    pub commit: String,
    /// Author of the commit.
    pub author: String,
    /// Time of the commit: ms since 1970, UTC.
    pub at_ms: u64,
    /// First line of the commit message.
    pub subject: String,
}

/// Library reference in a library state.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryName {
    /// Library root and the folders below it, joined by `/`.
    pub path: String,
    /// Name of the library's folder.
    pub name: String,
}

/// Selects the library whose usages are requested.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct UsagesOf {
    /// Library root and the folders below it, joined by `/`.
    pub path: String,
    /// Name of the library's folder.
    pub name: String,
}

/// Usages of a library.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryUsages {
    /// Usages in the current content of open machines, then in files of projects and library roots.
    pub usages: Vec<LibraryUsage>,
    /// True if the list is incomplete, or the search stopped at its file limit.
    pub is_cut: bool,
}

/// A state that runs a library.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryUsage {
    /// Id of the open machine. Empty for a usage found in files.
    pub machine: Option<String>,
    /// Location of the machine. Empty outside projects.
    pub file: Option<MachineFile>,
    /// Library that contains the state. Empty outside library roots.
    pub library: Option<LibraryName>,
    /// Path of the state: ids joined by `/`.
    pub path: String,
    /// Names of the states on the path, from the root.
    pub names: Vec<String>,
}
