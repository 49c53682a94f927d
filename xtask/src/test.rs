//! All tests: Rust, documentation, Python side with every interpreter found, conformance with the reference.

use std::process::Stdio;

use anyhow::{Context as _, Result};

use crate::conformance;
use crate::product::{Product, Profile};
use crate::reference::Reference;
use crate::{process, python, workspace};

/// What the Python-side tests need besides the extension.
const CONTENTS: python::Contents = python::Contents { bare: &[], full: &["numpy"] };

/// What `cargo xtask test` can be asked for.
#[derive(clap::Args, Default)]
pub(crate) struct Options {
    /// Run only this part.
    #[arg(long, value_enum)]
    only: Option<Part>,
}

/// The parts, in the order in which they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// Tests and documentation tests of all crates.
    Rust,
    /// Tests of the Python package, with every interpreter found.
    Python,
    /// The same machines in both engines.
    Conformance,
}

/// Runs them all, or the part asked for, setting up what they need.
pub(crate) fn run(options: &Options) -> Result<()> {
    let wanted = |part| options.only.is_none_or(|only| only == part);
    let product = Product::build(Profile::Debug)?;
    if wanted(Part::Rust) {
        rust()?;
    }
    if wanted(Part::Python) {
        python_side(&product)?;
    }
    if wanted(Part::Conformance) {
        conformance::run(&conformance::Options::default())?;
    }
    Ok(())
}

fn rust() -> Result<()> {
    let tests: &[&str] =
        if has_nextest() { &["nextest", "run", "--workspace"] } else { &["test", "--workspace"] };
    process::run(process::cargo().args(tests))?;
    if has_nextest() {
        process::run(process::cargo().args(["test", "--doc", "--workspace", "--quiet"]))?;
    }
    Ok(())
}

fn has_nextest() -> bool {
    let asked = process::cargo()
        .args(["nextest", "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    asked.is_ok_and(|status| status.success())
}

/// `crates/python/tests/test_*.py`, once with each interpreter.
fn python_side(product: &Product) -> Result<()> {
    let reference = Reference::installed()?;
    for interpreter in python::all() {
        let folder = workspace::target()?.join("python-venvs").join(&interpreter.version);
        let python = python::environment(&interpreter, &folder, CONTENTS)?;
        let discover = ["-m", "unittest", "discover", "--start-directory", "crates/python/tests"];
        let mut command = python::command(&python);
        command
            .args(discover)
            .env("RAFCON_EXTENSION", &product.extension)
            .env("RAFCON_BINARY", &product.binary)
            .env("RAFCON_REFERENCE_PYTHON", &reference.python);
        process::run(&mut command).with_context(|| format!("Python {}", interpreter.version))?;
    }
    Ok(())
}
