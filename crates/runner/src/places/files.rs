//! The script files of states, for tracebacks and for scripts. This module knows folders, but loads no file.

use rafcon_locks::RwLock;
use rafcon_model::StatePath;
use rafcon_storage::{Libraries, Saved};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the file with the script of a state.
const SCRIPT: &str = "script.py";

/// The folders of a machine and of its libraries.
#[derive(Debug, Clone)]
pub struct StateFiles {
    machine: PathBuf,
    /// The files as last loaded or saved; `None` for a machine without files.
    saved: Arc<RwLock<Option<Arc<Saved>>>>,
    libraries: Arc<Libraries>,
}

impl StateFiles {
    pub(crate) fn new(saved: Option<Saved>, libraries: Arc<Libraries>) -> Self {
        let machine = saved.as_ref().map(|saved| saved.dir().to_owned()).unwrap_or_default();
        Self { machine, saved: Arc::new(RwLock::new(saved.map(Arc::new))), libraries }
    }

    /// The folder of the machine; empty for a machine without files.
    pub fn machine(&self) -> &Path {
        &self.machine
    }

    /// The files as last loaded or saved, if the machine has any.
    pub(crate) fn saved(&self) -> Option<Arc<Saved>> {
        self.saved.read().clone()
    }

    /// Updates the files after the machine was loaded again.
    pub(crate) fn read_again(&self, saved: Saved) {
        *self.saved.write() = Some(Arc::new(saved));
    }

    /// The libraries in which library states are searched.
    pub fn libraries(&self) -> &Libraries {
        &self.libraries
    }

    /// The folder of the state at `path` (ids joined by `/`), if it is known.
    pub fn folder(&self, path: &str) -> Option<PathBuf> {
        self.saved()?.folder(&StatePath::parse(path), &self.libraries)
    }

    /// The file name of the state's script, for tracebacks; in angle brackets if there is no such file.
    pub fn script(&self, path: &str) -> String {
        let Some(folder) = self.folder(path) else { return format!("<{path}/{SCRIPT}>") };
        std::path::absolute(folder.join(SCRIPT)).unwrap_or(folder).display().to_string()
    }
}
