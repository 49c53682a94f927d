//! Settings that a runner needs to start a run.

use crate::{Afterwards, Breakpoint, Crash, Keeping, OnCrash, Resume};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Request to start or resume a run. It is sent to the runner right after the [`crate::Hello`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a choice of its own, by name on the wire"
)]
pub struct Launch {
    /// Folder of the machine, or a file in it.
    pub machine: PathBuf,
    /// Path of the state to begin at: ids joined by `/`.
    #[serde(default)]
    pub start_from: Option<String>,
    /// Action after that state was left.
    #[serde(default)]
    pub afterwards: Afterwards,
    /// Values for input ports of the root: name and JSON value.
    #[serde(default)]
    pub inputs: Vec<(String, serde_json::Value)>,
    /// Global variables that exist before the first state runs: name and JSON value.
    #[serde(default)]
    pub globals: Vec<(String, serde_json::Value)>,
    /// Library roots: name and folder. They precede those of the configuration and the environment.
    #[serde(default)]
    pub libraries: Vec<(String, PathBuf)>,
    /// The reference's `config.yaml`, or its folder. `None` for the reference's default location.
    #[serde(default)]
    pub config: Option<PathBuf>,
    /// True for every event. False for snapshots, the log and the end only.
    #[serde(default)]
    pub every_event: bool,
    /// Folder for the run's own files ([`crate::active`]). `None` to write none.
    #[serde(default)]
    pub run_folder: Option<PathBuf>,
    /// Amount of the run that is recorded in its folder.
    #[serde(default)]
    pub keeping: Keeping,
    /// True to store each event on disk before the script that follows it runs.
    #[serde(default)]
    pub strict: bool,
    /// Size of the journal, in bytes, above which old detail is deleted. `None` for the journal's default.
    #[serde(default)]
    pub size_max: Option<u64>,
    /// True to hold the run before its first state, for stepping or breakpoints.
    #[serde(default)]
    pub hold: bool,
    /// Breakpoints set from the start.
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
    /// Policy for interrupted scripts if the runner dies. `None` for `on_crash` in the root's semantic data, or *ask* if that is
    /// missing. The runner records it for the program that resumes the run.
    #[serde(default)]
    pub on_crash: Option<OnCrash>,
    /// Resume the run in `run_folder` instead of starting one. Its machine is the recorded one.
    #[serde(default)]
    pub resume: Option<Resume>,
    /// End of the previous runner, if the run is resumed.
    #[serde(default)]
    pub crash: Option<Crash>,
    /// True to let others join the run over the socket in its folder.
    #[serde(default)]
    pub listen: bool,
    /// Canonical folders that must contain the machine, the libraries and all their files, also behind links. `None` for no
    /// restriction. Programs that start runs for others set it.
    #[serde(default)]
    pub homes: Option<Vec<PathBuf>>,
}

/// Settings for entering the first state. The run records them, so that it can start over if it dies before that.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Beginning {
    /// Path of the state to begin at; see [`Launch::start_from`].
    #[serde(default)]
    pub start_from: Option<String>,
    /// Action after that state was left; see [`Launch::afterwards`].
    #[serde(default)]
    pub afterwards: Afterwards,
    /// Values for input ports of the root; see [`Launch::inputs`].
    #[serde(default)]
    pub inputs: Vec<(String, serde_json::Value)>,
    /// Global variables at the start; see [`Launch::globals`].
    #[serde(default)]
    pub globals: Vec<(String, serde_json::Value)>,
    /// True to hold before the first state; see [`Launch::hold`].
    #[serde(default)]
    pub hold: bool,
    /// Breakpoints set from the start; see [`Launch::breakpoints`].
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
}

impl Launch {
    /// Returns the settings for entering the first state.
    pub fn beginning(&self) -> Beginning {
        Beginning {
            start_from: self.start_from.clone(),
            afterwards: self.afterwards,
            inputs: self.inputs.clone(),
            globals: self.globals.clone(),
            hold: self.hold,
            breakpoints: self.breakpoints.clone(),
        }
    }
}
