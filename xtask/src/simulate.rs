//! Random runs of the engine by the hundred thousand: machines, results, commands and edits. A shorter run of the same is
//! a test.

use anyhow::Result;

use crate::process;

/// What `cargo xtask simulate` can be asked for.
#[derive(clap::Args)]
pub(crate) struct SimulateOptions {
    /// How many random machines run through random orders, each twice.
    #[arg(long, default_value_t = 100_000)]
    seeds: u64,
    /// The first seed.
    #[arg(long, default_value_t = 0)]
    from: u64,
}

/// Prints what was exercised, or the first seed that broke a promise.
pub(crate) fn run(options: &SimulateOptions) -> Result<()> {
    seeds(options.from, options.seeds)
}

/// So many seeds, in a release build.
pub(crate) fn seeds(from: u64, count: u64) -> Result<()> {
    let simulate = ["run", "--release", "-p", "rafcon-engine", "--example", "simulate", "--"];
    let (from, count) = (from.to_string(), count.to_string());
    process::run(process::cargo().args(simulate).args(["--seeds", &count, "--from", &from]))
}
