//! Brings the files of a machine into the form in which this program writes them, whatever wrote them.
//! Knows reading and saving, nothing of states.

use super::commit::{commit, is_interrupted, recover};
use super::disk::RealDisk;
use super::lock;
use super::plan::Mode;
use super::save::{SaveError, plan};
use crate::config::Naming;
use crate::problem::{Fault, LoadProblem};
use crate::read::{LoadError, load_locked, machine_folder};
use std::io;
use std::path::{Path, PathBuf};

/// What was done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Formatted {
    /// Files and folders that were written, moved or removed, relative to the machine's folder; none if all was well.
    pub changed: Vec<PathBuf>,
    /// What was found wrong; damaged files stay as they are.
    pub problems: Vec<LoadProblem>,
}

/// Why nothing was done.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The machine cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The machine cannot be written.
    #[error(transparent)]
    Save(#[from] SaveError),
}

/// Rewrites the machine in the folder `path` (or of the file `path`) in the current layout and dialect. Files that are as
/// they should be are not touched; foreign files stay. With `dry`, only tells what would change.
pub fn format(path: &Path, naming: Naming, dry: bool) -> Result<Formatted, FormatError> {
    let dir = machine_folder(path)?;
    let failed = |source: io::Error| SaveError::Io { path: dir.clone(), source };
    let _lock = lock::exclusive(&dir).map_err(failed)?;
    if is_interrupted(&RealDisk, &dir) {
        recover(&RealDisk, &dir).map_err(failed)?;
    }
    let loaded = load_locked(&dir)?;
    let mode = Mode { naming, rewrite: true, stale: true, here: true };
    let saved = &loaded.saved;
    let (plan, _) = plan(&RealDisk, &loaded.machine, &dir, Some(saved), mode).map_err(failed)?;
    if !dry {
        commit(&RealDisk, &dir, &plan).map_err(failed)?;
    }
    let mut changed = plan.changed;
    changed.sort();
    changed.dedup();
    let mut problems = loaded.problems;
    problems.retain(|problem| !matches!(problem.fault, Fault::MissingLibrary { .. })); // not looked for
    Ok(Formatted { changed, problems })
}
