//! What starting and finding runners takes from the environment. A value: programs read their environment where they begin.

use std::path::PathBuf;

/// The variables that mean something here, and where this program stands.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ProgramEnvironment {
    /// `VIRTUAL_ENV`: the active virtual environment.
    pub virtual_env: Option<PathBuf>,
    /// `RAFCON_EXTENSION`: the extension's file, for unusual installations.
    pub extension: Option<PathBuf>,
    /// This program's file, links followed.
    pub program: Option<PathBuf>,
    /// `HOME`: the user's folder.
    pub home: Option<PathBuf>,
    /// `XDG_STATE_HOME`: where programs keep what they remember.
    pub state_home: Option<PathBuf>,
}
