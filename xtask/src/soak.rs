//! The long form of what the tests do briefly: random runs of the engine by the hundred thousand, saves killed by the
//! thousand. Not a part of continuous integration.

use anyhow::Result;

use crate::{process, simulate};

/// What `cargo xtask soak` can be asked for.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// How many random machines run through random orders.
    #[arg(long, default_value_t = 100_000)]
    seeds: u64,
    /// How many saving processes are killed.
    #[arg(long, default_value_t = 1000)]
    kills: u32,
}

/// Runs both; the first failure ends it and names its seed.
pub(crate) fn run(options: &Options) -> Result<()> {
    simulate::seeds(0, options.seeds)?;
    let kill = ["test", "--release", "-p", "rafcon-storage", "--test", "it"];
    let one = ["kill::a_killed_process_leaves_one_of_its_machines", "--", "--exact"];
    let mut kill_often = process::cargo();
    kill_often.args(kill).args(one).env("RAFCON_TEST_KILLS", options.kills.to_string());
    process::run(&mut kill_often)
}
