//! The machines that are measured: missions made by the `rafcon` binary itself.

use anyhow::{Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A mission of so many states, below `folder`; made once.
pub(crate) fn mission(folder: &Path, states: usize) -> Result<PathBuf> {
    let path = folder.join(format!("mission_{states}"));
    if path.exists() {
        return Ok(path);
    }
    let mut new = Command::new(env!("CARGO_BIN_EXE_rafcon"));
    new.arg("new").arg(&path).args(["--template", "mission", "--states", &states.to_string()]);
    ensure!(new.output()?.status.success(), "rafcon new failed for {states} states");
    Ok(path)
}
