//! Where a library is used.

use super::MachineFile;
use serde::{Deserialize, Serialize};

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
