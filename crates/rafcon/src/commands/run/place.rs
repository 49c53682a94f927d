//! The folder of a run: kept among the runs, or only for as long as the run lasts.

use anyhow::{Context as _, Result};
use rafcon_storage::journal::folder::ABOUT_FILE;
use std::path::{Path, PathBuf};

/// Where a run keeps its files.
#[derive(Debug)]
pub(super) enum Place {
    /// Among the runs.
    Kept(PathBuf),
    /// Nowhere for good.
    Passing(tempfile::TempDir),
}

impl Place {
    /// A folder that goes with the run.
    pub(super) fn passing() -> Result<Self> {
        let folder = tempfile::Builder::new().prefix("rafcon-run-").tempdir();
        Ok(Self::Passing(folder.context("cannot make a folder for the run")?))
    }

    pub(super) fn folder(&self) -> &Path {
        match self {
            Self::Kept(folder) => folder,
            Self::Passing(folder) => folder.path(),
        }
    }

    /// Whether the run can be taken up again.
    pub(super) fn is_kept(&self) -> bool {
        matches!(self, Self::Kept(_))
    }

    /// Its name, if it can be taken up again.
    pub(super) fn kept_run(&self) -> Option<&str> {
        let Self::Kept(folder) = self else { return None };
        folder.file_name()?.to_str().filter(|_| self.keeps_itself())
    }

    /// Whether it says what it is, so that it can be taken up again.
    fn keeps_itself(&self) -> bool {
        self.folder().join(ABOUT_FILE).exists()
    }
}

impl Drop for Place {
    /// A run that never began leaves no folder.
    fn drop(&mut self) {
        if self.is_kept() && !self.keeps_itself() {
            // What cannot be removed is in nobody's way.
            std::fs::remove_dir_all(self.folder()).unwrap_or_default();
        }
    }
}
