//! Versions of a machine that its project's git repository knows.

use serde::{Deserialize, Serialize};

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
