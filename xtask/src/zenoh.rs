//! What lies in `zenoh/`, a workspace of its own: the program `rafcon-zenoh`.

use std::process::Command;

use anyhow::{Result, ensure};

use crate::product::{Product, Profile};
use crate::{process, python, workspace};

/// A peer of someone else.
const STRANGER: python::Contents = python::Contents { bare: &[], full: &["eclipse-zenoh==1.10.2"] };

/// What is checked of it wherever the rest is: its format, and that what it depends on is fixed. To compile it takes too long for that.
pub(crate) fn lint() -> Result<()> {
    let lock = workspace::path("zenoh/Cargo.lock");
    ensure!(lock.exists(), "{} is missing: `cargo xtask zenoh` writes it", lock.display());
    process::run(cargo().args(["fmt", "--check"]))
}

/// Builds `rafcon-zenoh` and tests it with the real programs on both of its sides.
pub(crate) fn test() -> Result<()> {
    let product = Product::build(Profile::Debug)?;
    let venv = workspace::target()?.join("zenoh-venv");
    let python = python::environment(&python::default()?, &venv, STRANGER)?;
    lint()?;
    process::run(cargo().args(["clippy", "--quiet", "--all-targets", "--", "-D", "warnings"]))?;
    let mut test = cargo();
    test.args(["test", "--quiet"]).env("RAFCON_BINARY", &product.binary);
    process::run(test.env("RAFCON_ZENOH_PYTHON", python))
}

/// Cargo in that workspace.
fn cargo() -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace::path("zenoh"));
    cargo
}
