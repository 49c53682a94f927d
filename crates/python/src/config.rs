//! The reference's configuration as scripts see it: the keys of `config.yaml`.

use crate::runtime::Runtime;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rafcon_storage::{Config, Root};

/// Shows scripts the configuration that the run has; the library roots are those that are used, wherever they come from.
pub(crate) fn put_in_force(py: Python<'_>, config: &Config, roots: &[Root]) -> PyResult<()> {
    let values = PyDict::new(py);
    let libraries = PyDict::new(py);
    for root in roots {
        libraries.set_item(root.name.as_str(), root.dir.to_string_lossy())?;
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
    Runtime::get(py)?.configure.call1(py, (values,))?;
    Ok(())
}
