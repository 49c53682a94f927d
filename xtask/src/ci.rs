//! The checks of continuous integration; `cargo xtask ci` runs them on any machine.

use anyhow::Result;

use crate::{process, ros_helper, test, tidy, web, zenoh};

/// All checks except the tests: format, lints, layers, house rules, documentation.
pub(crate) fn lint() -> Result<()> {
    process::run(process::cargo().args(["fmt", "--all", "--check"]))?;
    zenoh::lint()?;
    ros_helper::lint()?;
    let clippy = ["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"];
    process::run(process::cargo().args(clippy))?;
    process::run(process::cargo().args([
        "test",
        "--quiet",
        "--package",
        "xtask",
        "--test",
        "layers",
    ]))?;
    tidy::run(&tidy::TidyOptions::default())?;
    web::check()?;
    let doc = ["doc", "--workspace", "--no-deps", "--quiet"];
    process::run(process::cargo().args(doc).env("RUSTDOCFLAGS", "-D warnings"))
}

/// Runs all checks and all tests.
pub(crate) fn run() -> Result<()> {
    lint()?;
    test::run(&test::TestOptions::default())
}
