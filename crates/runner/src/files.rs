//! Where the script of a state lies on disk, for tracebacks and for scripts that ask. Knows folders, reads none.

use rafcon_model::Machine;
use rafcon_storage::{Libraries, Saved};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The folders of a machine and of its libraries.
#[derive(Debug)]
pub struct StateFiles {
    saved: Saved,
    libraries: Arc<Libraries>,
}

impl StateFiles {
    pub(crate) fn new(saved: Saved, libraries: Arc<Libraries>) -> Self {
        Self { saved, libraries }
    }

    /// The folder of the machine.
    pub fn machine(&self) -> &Path {
        self.saved.dir()
    }

    /// The folder of the state at `path` (ids joined by `/`), if it is known.
    pub fn folder(&self, _machine: &Machine, _path: &str) -> Option<PathBuf> {
        let _ = &self.libraries;
        None
    }

    /// The file name of the state's script, for tracebacks.
    pub fn script(&self, machine: &Machine, path: &str) -> String {
        let folder = self.folder(machine, path);
        folder.map_or_else(
            || format!("script.py of {path}"),
            |folder| folder.join("script.py").display().to_string(),
        )
    }
}
