//! The long form of what the tests do briefly: random runs of the engine by the hundred thousand, saves killed by the
//! thousand; runs with many branches while viewers come and go; or a server with hundreds of clients. Not a part of continuous integration.

use anyhow::Result;

use crate::product::{Product, Profile};
use crate::{process, simulate, torture};

/// What `cargo xtask soak` can be asked for.
#[derive(clap::Args)]
pub(crate) struct SoakOptions {
    /// How many random machines run through random orders.
    #[arg(long, default_value_t = 100_000)]
    seeds: u64,
    /// How many saving processes are killed.
    #[arg(long, default_value_t = 1000)]
    kills: u32,
    /// How many runs with 64 branches are watched by viewers that come and go.
    #[arg(long, default_value_t = 20)]
    wide: u32,
    /// Instead of these: a server with many clients, one of them slow, one that never reads.
    #[arg(long)]
    server: bool,
    /// How many clients the server has.
    #[arg(long, default_value_t = 200)]
    clients: u32,
    /// How long the run goes on that they follow.
    #[arg(long, default_value_t = 60)]
    seconds: u32,
}

/// Runs what was asked for; the first failure ends it and names its seed.
pub(crate) fn run(options: &SoakOptions) -> Result<()> {
    if options.server {
        return served(options);
    }
    simulate::seeds(0, options.seeds)?;
    let kill = ["test", "--release", "-p", "rafcon-storage", "--test", "it"];
    let one = ["kill::a_killed_process_leaves_one_of_its_machines", "--", "--exact"];
    let mut kill_often = process::cargo();
    kill_often.args(kill).args(one).env("RAFCON_TEST_KILLS", options.kills.to_string());
    process::run(&mut kill_often)?;
    Product::build(Profile::Release)?;
    let mut wide = torture::long_form("wide::a_wide_run_ends_while_viewers_come_and_go");
    process::run(wide.env("RAFCON_TEST_WIDE", options.wide.to_string()))
}

fn served(options: &SoakOptions) -> Result<()> {
    Product::build(Profile::Release)?;
    let test = "server_soak::many_clients_lose_nothing_and_cost_a_bounded_amount_of_memory";
    let mut soak = torture::long_form(test);
    soak.env("RAFCON_TEST_CLIENTS", options.clients.to_string());
    process::run(soak.env("RAFCON_TEST_SECONDS", options.seconds.to_string()))
}
