//! Where the script of a state lies on disk, for tracebacks and for scripts that ask. Knows folders, reads none.

use rafcon_model::StatePath;
use rafcon_storage::{Libraries, Saved};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The file with the script of a state.
const SCRIPT: &str = "script.py";

/// The folders of a machine and of its libraries.
#[derive(Debug, Clone)]
pub struct StateFiles {
    /// Where the machine lay when it was begun, if it was read from a copy.
    origin: Option<PathBuf>,
    saved: Arc<Saved>,
    libraries: Arc<Libraries>,
}

impl StateFiles {
    pub(crate) fn new(saved: Saved, libraries: Arc<Libraries>) -> Self {
        Self { origin: None, saved: Arc::new(saved), libraries }
    }

    /// The same for a copy of the machine that lay in `origin`.
    pub(crate) fn copied_from(self, origin: PathBuf) -> Self {
        Self { origin: Some(origin), ..self }
    }

    /// The folder of the machine.
    pub fn machine(&self) -> &Path {
        self.origin.as_deref().unwrap_or_else(|| self.saved.dir())
    }

    /// The machine as it was read.
    pub(crate) fn saved(&self) -> &Saved {
        &self.saved
    }

    /// Where libraries are looked up.
    pub fn libraries(&self) -> &Libraries {
        &self.libraries
    }

    /// The folder of the state at `path` (ids joined by `/`), if it is known.
    pub fn folder(&self, path: &str) -> Option<PathBuf> {
        self.saved.folder(&StatePath::parse(path), &self.libraries)
    }

    /// The file name of the state's script, for tracebacks.
    pub fn script(&self, path: &str) -> String {
        let folder = self.folder(path).unwrap_or_else(|| Path::new("<unknown>").join(path));
        std::path::absolute(folder.join(SCRIPT)).unwrap_or(folder).display().to_string()
    }
}
