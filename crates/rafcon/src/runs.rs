//! The folders of runs in the words of the command line: which of its errors are the user's, and which are only said.

use crate::cli;
use crate::environment::Environment;
use crate::failure::{Usage, complain};
use anyhow::Result;
use rafcon_supervisor::{FindError, Runs};
use std::path::{Path, PathBuf};

/// The folder of all runs: the one that the user names, or the usual place.
pub(crate) fn folder(named: &cli::Runs, environment: &Environment) -> Result<Runs> {
    Ok(Runs::new(named.runs.as_deref(), &environment.surroundings)?)
}

/// The folder of the run that the user means.
pub(crate) fn find(named: &cli::Runs, environment: &Environment, text: &str) -> Result<PathBuf> {
    find_in(&folder(named, environment)?, text)
}

/// The same, in a folder of runs that is known.
pub(crate) fn find_in(runs: &Runs, text: &str) -> Result<PathBuf> {
    runs.find(text).map_err(|error| match error {
        FindError::None { .. } | FindError::Many { .. } => Usage(error.to_string()).into(),
        FindError::Here(_) | FindError::Read { .. } => error.into(),
    })
}

/// Makes the folder of a new run, and deletes old ones. What cannot be deleted stops no run.
pub(crate) fn make(runs: &Runs, machine: &str) -> Result<PathBuf> {
    if let Err(error) = runs.give_up_old_ones() {
        complain(&format!("warning: old runs stay: {error}"));
    }
    Ok(runs.make(machine)?)
}

/// The id of the run in this folder.
pub(crate) fn id(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
