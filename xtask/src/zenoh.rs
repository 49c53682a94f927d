//! The workspace `zenoh/`: the program `rafcon-zenoh`, and the comparison of the link with other transports.

use std::fs;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use crate::product::{Product, Profile};
use crate::{link, process, python, workspace};

/// Zenoh's own Python package, as a foreign peer.
const STRANGER: python::Contents = python::Contents { bare: &[], full: &["eclipse-zenoh==1.10.2"] };

/// The quick checks that run with all others: its format, and the existence of its lock file. Compiling it takes too long
/// for that.
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

/// Options of `cargo xtask link-compare`.
#[derive(clap::Args)]
pub(crate) struct LinkCompareOptions {
    /// Print each figure as a line of JSON.
    #[arg(long)]
    json: bool,
}

/// Carries a sequence of events over a bad link by several transports, and prints the table of `docs/link.md`.
pub(crate) fn compare(options: &LinkCompareOptions) -> Result<()> {
    let proxy = link::proxy()?;
    let build = ["build", "--release", "--quiet", "-p", "rafcon-testkit", "--example"];
    process::run(process::cargo().args(build).arg("link_events"))?;
    let program = workspace::target()?.join("release/examples/link_events");
    let events = process::text(process::command(program).arg("200"))?;
    let file = workspace::target()?.join("link-events.txt");
    fs::write(&file, events).with_context(|| format!("cannot write {}", file.display()))?;
    let mut compare = cargo();
    compare.args(["run", "--quiet", "--example", "link_compare", "--"]);
    compare.arg(file).arg(proxy);
    process::run(compare.args(options.json.then_some("--json")))
}

/// Cargo in the workspace `zenoh`.
fn cargo() -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace::path("zenoh"));
    cargo
}
