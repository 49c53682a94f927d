//! What a runner must know to begin.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One run, as asked for. Sent to the runner right after the [`crate::Hello`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Launch {
    /// Folder of the machine (or a file in it).
    pub machine: PathBuf,
    /// State path (ids joined by `/`) to begin at.
    #[serde(default)]
    pub start_from: Option<String>,
    /// Values for input ports of the root: name and JSON value.
    #[serde(default)]
    pub inputs: Vec<(String, serde_json::Value)>,
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
}
