//! Where the script of a state lies on disk, for tracebacks and for scripts that ask. Knows folders, reads none.

use parking_lot::RwLock;
use rafcon_model::StatePath;
use rafcon_storage::{Libraries, Saved};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The file with the script of a state.
const SCRIPT: &str = "script.py";

/// The folders of a machine and of its libraries.
#[derive(Debug, Clone)]
pub struct StateFiles {
    machine: PathBuf,
    /// As it was read last.
    saved: Arc<RwLock<Arc<Saved>>>,
    libraries: Arc<Libraries>,
}

impl StateFiles {
    pub(crate) fn new(saved: Saved, libraries: Arc<Libraries>) -> Self {
        let machine = saved.dir().to_owned();
        Self { machine, saved: Arc::new(RwLock::new(Arc::new(saved))), libraries }
    }

    /// The same for a copy of the machine that lay in `origin`.
    pub(crate) fn copied_from(self, origin: PathBuf) -> Self {
        Self { machine: origin, ..self }
    }

    /// The folder of the machine.
    pub fn machine(&self) -> &Path {
        &self.machine
    }

    /// The machine as it was read.
    pub(crate) fn saved(&self) -> Arc<Saved> {
        Arc::clone(&self.saved.read())
    }

    /// The machine was read again.
    pub(crate) fn read_again(&self, saved: Saved) {
        *self.saved.write() = Arc::new(saved);
    }

    /// Where libraries are looked up.
    pub fn libraries(&self) -> &Libraries {
        &self.libraries
    }

    /// The folder of the state at `path` (ids joined by `/`), if it is known.
    pub fn folder(&self, path: &str) -> Option<PathBuf> {
        self.saved().folder(&StatePath::parse(path), &self.libraries)
    }

    /// The file name of the state's script, for tracebacks.
    pub fn script(&self, path: &str) -> String {
        let folder = self.folder(path).unwrap_or_else(|| Path::new("<unknown>").join(path));
        std::path::absolute(folder.join(SCRIPT)).unwrap_or(folder).display().to_string()
    }
}
