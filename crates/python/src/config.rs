//! The reference's configuration as scripts see it: the keys of `config.yaml`.

use crate::runtime::Runtime;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_storage::{Config, Root, config};
use std::path::Path;

/// Shows scripts the configuration of the run, with the library roots that are in use.
pub(crate) fn put_in_force(py: Python<'_>, config: &Config, roots: &[Root]) -> PyResult<()> {
    let roots = roots.iter().map(|root| (root.name.as_str(), root.dir.as_path()));
    Runtime::get(py)?.configure.call1(py, (values(py, config, roots)?,))?;
    Ok(())
}

/// `rafcon._native.read_config`: keys and values of a file, or of the reference's default file, and the problems found.
#[pyfunction]
pub(crate) fn read_config<'py>(
    py: Python<'py>,
    path: Option<&str>,
) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
    let environment = |name: &str| std::env::var_os(name)?.into_string().ok();
    let (config, _file) = config::find(path.map(Path::new), &environment)
        .map_err(|error| PyOSError::new_err(format!("{error}: {}", error.source)))?;
    let roots = config.library_paths.iter().map(|(name, dir)| (name.as_str(), dir.as_path()));
    let values = values(py, &config, roots)?;
    Ok((values, config.notes.iter().map(ToString::to_string).collect()))
}

fn values<'py, 'r>(
    py: Python<'py>,
    config: &Config,
    roots: impl Iterator<Item = (&'r str, &'r Path)>,
) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    let libraries = PyDict::new(py);
    for (name, dir) in roots {
        libraries.set_item(name, dir.to_string_lossy())?;
    }
    values.set_item("LIBRARY_PATHS", libraries)?;
    values.set_item("STORAGE_PATH_WITH_STATE_NAME", config.naming.with_name)?;
    let length = config.naming.max_name_length;
    values.set_item("MAX_LENGTH_FOR_STATE_NAME_IN_STORAGE_PATH", length)?;
    values.set_item("IN_MEMORY_EXECUTION_HISTORY_ENABLE", config.in_memory_history)?;
    values.set_item("FILE_SYSTEM_EXECUTION_HISTORY_ENABLE", config.file_history)?;
    values.set_item("SCRIPT_RECOMPILATION_ON_STATE_EXECUTION", config.recompile_scripts)?;
    if let Some(path) = &config.execution_log_path {
        values.set_item("EXECUTION_LOG_PATH", path.to_string_lossy())?;
    }
    Ok(values)
}
