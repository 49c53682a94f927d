//! Checks of this repository beyond compiler and clippy, one module each.

mod limits;
mod links;
mod lints;
mod modules;
mod named_tests;
mod names;
mod prose;
mod words;

use anyhow::{Result, bail};

/// Options of `cargo xtask tidy`.
#[derive(clap::Args, Clone, Default)]
pub(crate) struct TidyOptions {
    /// Rewrite generated files, and lower the budgets of prose.
    #[arg(long)]
    fix: bool,
    /// List the hits of the prose check in one place, such as `crates/link` or `docs/link.md`.
    #[arg(long, value_name = "PLACE")]
    prose: Option<String>,
}

/// Runs all checks, prints all findings, and fails if there are any.
pub(crate) fn run(options: &TidyOptions) -> Result<()> {
    if let Some(place) = &options.prose {
        return prose::show(place);
    }
    if options.fix {
        lints::write()?;
        prose::write()?;
    }
    let checks = [
        modules::check,
        named_tests::check,
        links::check,
        words::check,
        names::check,
        prose::check,
        limits::check,
    ];
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
