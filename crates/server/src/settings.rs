//! What a server is started with: values that its program has read from command line and environment.

use std::path::PathBuf;
use std::time::Duration;

/// How a server is set up.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Folders with machines: the only places that requests may read and write.
    pub projects: Vec<PathBuf>,
    /// The server's own folder: token, users, certificate, drafts.
    pub state: PathBuf,
    /// The folder with one folder for each run.
    pub runs: PathBuf,
    /// Library roots by name, before those of the configuration.
    pub libraries: Vec<(String, PathBuf)>,
    /// The reference's `config.yaml`, or a folder with it; none: where the reference looks.
    pub config: Option<PathBuf>,
    /// After how much silence of a holder of control somebody else may take over.
    pub control_silence: Duration,
}
