//! Runners killed by the thousand in the middle of a run (`crates/rafcon/tests/it/torture.rs`, in the long form).

use crate::process;
use crate::product::{Product, Profile};
use anyhow::Result;

/// What `cargo xtask torture` can be asked for.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// How many runners are killed.
    #[arg(long, default_value_t = 1000)]
    kills: u32,
}

/// Kills and takes up again; the last line says how many passed. The first failure ends it and names its seed.
pub(crate) fn run(options: &Options) -> Result<()> {
    Product::build(Profile::Release)?;
    let torture = ["test", "--release", "-q", "-p", "rafcon", "--test", "it"];
    let one =
        ["torture::a_killed_runner_loses_nothing_that_was_told", "--", "--exact", "--nocapture"];
    let mut kill = process::cargo();
    kill.args(torture).args(one).env("RAFCON_TEST_KILLS", options.kills.to_string());
    process::run(&mut kill)?;
    // The first that does not pass ends it, with its seed.
    println!("{kills} of {kills} kills passed", kills = options.kills);
    Ok(())
}
