//! Projects and libraries as they lie on disk, the versions that git has of a machine, and where a library is used.

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

/// The versions of a machine, as far as git knows them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineVersions {
    /// Whether the machine's folder lies in a git repository, and there is a git to ask.
    pub is_git: bool,
    /// Commits that touched the folder, the newest first.
    pub versions: Vec<MachineVersion>,
    /// Whether there are older ones that are not told.
    pub is_cut: bool,
}

/// A commit that touched a machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct MachineVersion {
    /// Its hash, in hexadecimal.
    pub commit: String,
    /// Who wrote it.
    pub author: String,
    /// When it was written: ms since 1970, UTC.
    pub at_ms: u64,
    /// The first line of its message.
    pub subject: String,
}

/// How library states name a library.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryName {
    /// A library root and the folders below it, joined by `/`.
    pub path: String,
    /// The folder of the library.
    pub name: String,
}

/// Which library's usages are asked for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::IntoParams, ts_rs::TS))]
#[cfg_attr(feature = "schema", into_params(parameter_in = Query))]
pub struct UsagesOf {
    /// A library root and the folders below it, joined by `/`.
    pub path: String,
    /// The folder of the library.
    pub name: String,
}

/// Where a library is used.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryUsages {
    /// In open machines as they are now, then in files of projects and library roots.
    pub usages: Vec<LibraryUsage>,
    /// Whether there are more, or more files than are looked at.
    pub is_cut: bool,
}

/// A state that runs a library.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryUsage {
    /// The open machine with it; none: it was found in files.
    pub machine: Option<String>,
    /// The machine with it; none if it lies in no project.
    pub file: Option<MachineFile>,
    /// The library with it; none if it lies below no library root.
    pub library: Option<LibraryName>,
    /// The state: ids joined by `/`.
    pub path: String,
    /// The names of the states on the path, the root's first.
    pub names: Vec<String>,
}
