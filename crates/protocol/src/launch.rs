//! What a runner must know to begin.

use crate::{Afterwards, Breakpoint, Crash, Keeping, OnCrash, Resume};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One run, as asked for. Sent to the runner right after the [`crate::Hello`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a choice of its own, by name on the wire"
)]
pub struct Launch {
    /// Folder of the machine (or a file in it).
    pub machine: PathBuf,
    /// State path (ids joined by `/`) to begin at.
    #[serde(default)]
    pub start_from: Option<String>,
    /// What happens once that state was left.
    #[serde(default)]
    pub afterwards: Afterwards,
    /// Values for input ports of the root: name and JSON value.
    #[serde(default)]
    pub inputs: Vec<(String, serde_json::Value)>,
    /// Global variables that are there before the first state runs: name and JSON value.
    #[serde(default)]
    pub globals: Vec<(String, serde_json::Value)>,
    /// Library roots, name and folder, before those of configuration and environment.
    #[serde(default)]
    pub libraries: Vec<(String, PathBuf)>,
    /// The reference's `config.yaml`, or a folder with it; `None`: where the reference looks.
    #[serde(default)]
    pub config: Option<PathBuf>,
    /// Whether the viewer wants every event, or only snapshots, logs and the end.
    #[serde(default)]
    pub every_event: bool,
    /// A folder for the run's own files ([`crate::active`]); `None`: none are written.
    #[serde(default)]
    pub run_folder: Option<PathBuf>,
    /// How much is kept in the run's folder.
    #[serde(default)]
    pub keeping: Keeping,
    /// Whether an event is on disk before the script that follows it runs.
    #[serde(default)]
    pub strict: bool,
    /// The journal's size, in bytes, beyond which old detail is given up; `None`: the default of the journal.
    #[serde(default)]
    pub size_max: Option<u64>,
    /// Whether the run is held before its first state, for stepping or breakpoints.
    #[serde(default)]
    pub hold: bool,
    /// Breakpoints that are there from the start.
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
    /// What becomes of interrupted scripts if the runner dies; `None`: what the root's semantic data `on_crash` says, else
    /// *ask*. The runner writes it down for whoever resumes the run again.
    #[serde(default)]
    pub on_crash: Option<OnCrash>,
    /// Resume the run whose folder `run_folder` is, instead of beginning one: its machine is the one that it kept.
    #[serde(default)]
    pub resume: Option<Resume>,
    /// How the runner before ended, if the run is resumed.
    #[serde(default)]
    pub crash: Option<Crash>,
    /// Whether others may join the run, by the socket in its folder.
    #[serde(default)]
    pub listen: bool,
    /// The folders, without links in their paths, in which machine and libraries and every file of theirs have to lie,
    /// whatever links say; `None`: anywhere. Who starts runs for others names them.
    #[serde(default)]
    pub homes: Option<Vec<PathBuf>>,
}

/// How the first state of a run is entered: kept by the run, so that one that dies before that can begin like this.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Beginning {
    /// See [`Launch::start_from`].
    #[serde(default)]
    pub start_from: Option<String>,
    /// See [`Launch::afterwards`].
    #[serde(default)]
    pub afterwards: Afterwards,
    /// See [`Launch::inputs`].
    #[serde(default)]
    pub inputs: Vec<(String, serde_json::Value)>,
    /// See [`Launch::globals`].
    #[serde(default)]
    pub globals: Vec<(String, serde_json::Value)>,
    /// See [`Launch::hold`].
    #[serde(default)]
    pub hold: bool,
    /// See [`Launch::breakpoints`].
    #[serde(default)]
    pub breakpoints: Vec<Breakpoint>,
}

impl Launch {
    /// How its first state is entered.
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
