//! Checks of this repository that neither the compiler nor clippy makes; each check is one module.

mod links;
mod lints;
mod modules;
mod named_tests;
mod names;
mod words;

use anyhow::{Result, bail};

/// What `cargo xtask tidy` can be asked for.
#[derive(clap::Args, Clone, Copy, Default)]
pub(crate) struct TidyOptions {
    /// Rewrite generated files instead of complaining about them.
    #[arg(long)]
    fix: bool,
}

/// Runs every check, shows every finding, and fails if there is one.
pub(crate) fn run(options: TidyOptions) -> Result<()> {
    if options.fix {
        lints::write()?;
    }
    let checks = [modules::check, named_tests::check, links::check, words::check, names::check];
    let mut findings = lints::check();
    for check in checks {
        findings.extend(check()?);
    }
    for finding in &findings {
        eprintln!("{finding}");
    }
    if !findings.is_empty() {
        bail!("tidy: {} finding(s)", findings.len());
    }
    Ok(())
}
