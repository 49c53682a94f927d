//! The program `rafcon-ros` of the workspace `ros/`, through which scripts use ROS without rclpy.
//!
//! It is built with the published `RustDDS` and the changes in [`changes`]. The changed copy is in the target folder, never
//! in the repository.

mod changes;

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use crate::product::Profile;
use crate::{process, workspace};

use self::changes::CHANGES;

/// The quick checks that run with all others: its format, and the existence of its lock file. Compiling it takes too long
/// for that.
pub(crate) fn lint() -> Result<()> {
    let lock = workspace::path("ros/Cargo.lock");
    ensure!(lock.exists(), "{} is missing: `cargo xtask ros-helper` writes it", lock.display());
    process::run(process::cargo().current_dir(workspace::path("ros")).args(["fmt", "--check"]))
}

/// Builds it and copies it next to `rafcon`.
pub(crate) fn build(profile: Profile) -> Result<PathBuf> {
    let mut build = cargo("build")?;
    let kind = if profile == Profile::Debug { "debug" } else { "release" };
    build.args((profile != Profile::Debug).then_some("--release"));
    process::run(&mut build)?;
    let name = format!("rafcon-ros{}", std::env::consts::EXE_SUFFIX);
    let beside =
        workspace::target()?.join(if profile == Profile::Symbols { "symbols" } else { kind });
    fs::create_dir_all(&beside)?;
    let (built, program) = (folder()?.join("target").join(kind).join(&name), beside.join(&name));
    // A running program locks its file against writes, but not against replacement.
    let new = program.with_extension("new");
    fs::copy(&built, &new)
        .and_then(|_| fs::rename(&new, &program))
        .with_context(|| format!("cannot copy {} to {}", built.display(), program.display()))?;
    Ok(program)
}

/// Builds, lints and tests it separately, for debug and release builds of `rafcon`; `cargo xtask ros` tests it with peers.
pub(crate) fn test() -> Result<()> {
    lint()?;
    process::run(cargo("clippy")?.args(["--all-targets", "--", "-D", "warnings"]))?;
    process::run(&mut cargo("test")?)?;
    [Profile::Debug, Profile::Release].into_iter().try_for_each(|profile| build(profile).map(drop))
}

fn folder() -> Result<PathBuf> {
    Ok(workspace::target()?.join("ros-helper"))
}

/// Cargo with the copy of the manifest that uses the changed `RustDDS`.
fn cargo(command: &str) -> Result<Command> {
    let folder = folder()?;
    let manifest = folder.join("Cargo.toml");
    changed(&folder.join("rustdds"))?;
    let own = fs::read_to_string(workspace::path("ros/Cargo.toml"))?;
    let main = workspace::path("ros/src/main.rs");
    let more = format!(
        "\n[[bin]]\nname = \"rafcon-ros\"\npath = {:?}\n\n[patch.crates-io]\nrustdds = {{ path = \"rustdds\" }}\n",
        main.to_string_lossy()
    );
    fs::write(&manifest, own + &more)?;
    fs::copy(workspace::path("ros/Cargo.lock"), folder.join("Cargo.lock"))?;
    let mut cargo = process::cargo();
    cargo.current_dir(workspace::path("ros")).args([command, "--quiet", "--manifest-path"]);
    cargo.arg(manifest).arg("--target-dir").arg(folder.join("target"));
    Ok(cargo)
}

/// Makes the changed copy of `RustDDS`, if it is missing or outdated.
fn changed(copy: &Path) -> Result<()> {
    let published = published()?;
    let stamp = copy.join("changed-from");
    let about = format!("{}\n{CHANGES:?}", published.display());
    if fs::read_to_string(&stamp).is_ok_and(|before| before == about) {
        return Ok(());
    }
    if copy.exists() {
        fs::remove_dir_all(copy)?;
    }
    copy_all(&published, copy)?;
    for (file, before, after) in CHANGES {
        let path = copy.join(file);
        let text =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let places = text.matches(before).count();
        ensure!(places == 1, "{file} of RustDDS has {places} places like this, not one: {before}");
        fs::write(&path, text.replacen(before, after, 1))?;
    }
    fs::write(stamp, about).map_err(Into::into)
}

/// Folder of the published `RustDDS` in cargo's registry.
fn published() -> Result<PathBuf> {
    let mut metadata = process::cargo();
    metadata.current_dir(workspace::path("ros")).args([
        "metadata",
        "--format-version",
        "1",
        "--locked",
    ]);
    let metadata: Value = serde_json::from_str(&process::text(&mut metadata)?)?;
    let packages = metadata["packages"].as_array().context("cargo knows no packages")?;
    let found = packages.iter().find(|package| package["name"] == "rustdds");
    let manifest = found
        .and_then(|package| package["manifest_path"].as_str())
        .context("rustdds is missing")?;
    Path::new(manifest).parent().map(Path::to_path_buf).context("rustdds has no folder")
}

fn copy_all(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_all(&entry.path(), &target)?;
        } else if entry.file_name() != OsStr::new(".cargo-ok") {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
