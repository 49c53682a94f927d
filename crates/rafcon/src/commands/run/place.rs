//! The folder of a run: kept among the runs, or only for as long as the run lasts.

use anyhow::{Context as _, Result};
use rafcon_protocol::OnCrash;
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

    /// Its name, if it is kept.
    pub(super) fn id(&self) -> Option<&str> {
        let Self::Kept(folder) = self else { return None };
        folder.file_name()?.to_str()
    }

    /// What becomes of scripts that a crash has interrupted, as the run keeps it.
    pub(super) fn on_crash(&self) -> OnCrash {
        policy_of(self.folder())
    }
}

impl Drop for Place {
    /// A run that never began leaves no folder.
    fn drop(&mut self) {
        if let Self::Kept(folder) = self {
            // Only an empty one can be removed in this way.
            std::fs::remove_dir(folder).unwrap_or_default();
        }
    }
}
