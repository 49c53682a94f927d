//! Where the script of a state lies on disk, for tracebacks and for scripts that ask. Knows folders, reads none.

use rafcon_storage::{Libraries, Saved};
use std::path::Path;
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
}
