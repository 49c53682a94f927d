//! The page: its packages from npm, its checks, its build. Knows the folder `web` and its programs.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::{process, workspace};

/// Options of `cargo xtask web`.
#[derive(clap::Args, Clone, Copy, Default)]
pub(crate) struct WebOptions {
    /// Only check types, lints and layers; build nothing.
    #[arg(long)]
    check: bool,
}

/// Builds the page, or checks it.
pub(crate) fn run(options: WebOptions) -> Result<()> {
    if options.check { check() } else { build() }
}

/// Builds the page for the server and for release builds.
pub(crate) fn build() -> Result<()> {
    process::run(program("tsc")?.arg("--noEmit"))?;
    process::run(program("vite")?.arg("build"))
}

/// Checks format, lints, layers and types.
pub(crate) fn check() -> Result<()> {
    process::run(program("biome")?.args(["ci", "--error-on-warnings", "."]))?;
    process::run(program("tsc")?.arg("--noEmit"))
}

/// The tests that need no browser.
pub(crate) fn test() -> Result<()> {
    process::run(program("vitest")?.arg("run"))
}

/// A program from the packages, run in `web`.
pub(crate) fn program(name: &str) -> Result<Command> {
    install()?;
    let mut program = process::command(folder().join("node_modules/.bin").join(name));
    program.current_dir(folder());
    Ok(program)
}

/// Installs the packages of the lock file, if they are missing.
pub(crate) fn install() -> Result<()> {
    let lock = workspace::read("web/package-lock.json")?;
    let stamp = folder().join("node_modules/.rafcon-lock.json");
    if std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    let mut npm = process::command("npm");
    npm.current_dir(folder()).args(["ci", "--no-audit", "--no-fund"]);
    process::run(&mut npm).context(
        "the page's packages cannot be installed: `npm` (Node 20 or newer) and its registry are needed",
    )?;
    std::fs::write(&stamp, lock).with_context(|| format!("cannot write {}", stamp.display()))
}

fn folder() -> PathBuf {
    workspace::path("web")
}
