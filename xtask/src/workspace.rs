//! Locations in this repository.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use serde_json::Value;

use crate::process;

/// The repository's root folder.
pub(crate) fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}

/// A path below the root.
pub(crate) fn path(relative: impl AsRef<Path>) -> PathBuf {
    root().join(relative)
}

/// Cargo's target folder, according to the user's settings.
pub(crate) fn target() -> Result<PathBuf> {
    let metadata = process::text(process::cargo().args([
        "metadata",
        "--no-deps",
        "--offline",
        "--format-version",
        "1",
    ]))?;
    let metadata: Value = serde_json::from_str(&metadata)
        .context("cargo metadata printed something that is not JSON")?;
    let folder = metadata["target_directory"]
        .as_str()
        .context("cargo metadata names no target_directory")?;
    Ok(PathBuf::from(folder))
}

/// The files that git tracks or would track, relative to the root; `pattern` is a git path pattern such as `*.rs`.
pub(crate) fn files(pattern: &str) -> Result<Vec<PathBuf>> {
    let mut git = process::command("git");
    git.args([
        "ls-files",
        "--cached",
        "--others",
        "--exclude-standard",
        "--deduplicate",
        "--",
        pattern,
    ]);
    let listed = process::text(&mut git)?;
    Ok(listed.lines().map(PathBuf::from).filter(|file| path(file).is_file()).collect())
}

/// The names of the folders below `crates/`.
pub(crate) fn crates() -> Result<Vec<String>> {
    let manifests = files("crates/*/Cargo.toml")?;
    let folders = manifests.iter().filter_map(|file| file.parent()?.file_name()?.to_str());
    Ok(folders.map(str::to_owned).collect())
}

/// Copies the files below a folder of the repository that git lists to another folder.
pub(crate) fn copy(folder: &str, target: &Path) -> Result<()> {
    for file in files(folder)? {
        let copy = target.join(file.strip_prefix(folder).unwrap_or(&file));
        let made = std::fs::create_dir_all(copy.parent().unwrap_or(target));
        let copied = made.and_then(|()| std::fs::copy(path(&file), &copy));
        copied.with_context(|| format!("cannot copy {} to {}", file.display(), copy.display()))?;
    }
    Ok(())
}

/// Reads a text file below the root.
pub(crate) fn read(relative: impl AsRef<Path>) -> Result<String> {
    let relative = relative.as_ref();
    std::fs::read_to_string(path(relative))
        .with_context(|| format!("cannot read {}", relative.display()))
}
