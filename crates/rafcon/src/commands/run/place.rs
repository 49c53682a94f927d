//! The folder of a run: kept among the runs, or only for as long as the run lasts.

use anyhow::{Context as _, Result};
use rafcon_protocol::OnCrash;
use rafcon_storage::journal::folder::ABOUT_FILE;
use rafcon_storage::journal::has_begun;
use rafcon_supervisor::policy_of;
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

    /// Whether anything has happened in the run.
    pub(super) fn has_begun(&self) -> bool {
        has_begun(self.folder())
    }

    /// What becomes of scripts that a crash has interrupted, as the run keeps it; as it was asked for, if it keeps nothing yet.
    pub(super) fn on_crash(&self, asked: Option<OnCrash>) -> OnCrash {
        if self.keeps_itself() { policy_of(self.folder()) } else { asked.unwrap_or_default() }
    }

    /// Whether it says what it is, so that it can be taken up again.
    pub(super) fn keeps_itself(&self) -> bool {
        self.folder().join(ABOUT_FILE).exists()
    }
}

impl Drop for Place {
    /// A run that never began leaves no folder.
    fn drop(&mut self) {
        if let Self::Kept(folder) = self
            && !folder.join(ABOUT_FILE).exists()
        {
            // What cannot be removed is in nobody's way.
            std::fs::remove_dir_all(folder).unwrap_or_default();
        }
    }
}
