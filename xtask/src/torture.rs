//! Runners, and with `--server` servers too, killed by the thousand while a run begins, in the middle of it, and while it is taken
//! up again (`crates/rafcon/tests/it/torture.rs` and `server_torture`, in the long form).

use crate::process;
use crate::product::{Product, Profile};
use anyhow::Result;

/// What `cargo xtask torture` can be asked for.
#[derive(clap::Args)]
pub(crate) struct TortureOptions {
    /// How many processes are killed.
    #[arg(long, default_value_t = 1000)]
    kills: u32,
    /// Kill the server as well as the runner, while two clients follow and command.
    #[arg(long)]
    server: bool,
    /// The first seed; one that failed, to repeat it. Another one each day if none is named.
    #[arg(long)]
    from: Option<u64>,
}

/// Kills and takes up again; the last line says how many passed. The first failure ends it and names its seed.
pub(crate) fn run(options: &TortureOptions) -> Result<()> {
    Product::build(Profile::Release)?;
    let test = if options.server {
        "server_torture::killed_servers_and_runners_lose_nothing_and_repeat_nothing"
    } else {
        "torture::a_killed_runner_loses_nothing_that_was_told"
    };
    let mut kill = long_form(test);
    kill.env("RAFCON_TEST_KILLS", options.kills.to_string());
    if let Some(from) = options.from {
        kill.env("RAFCON_TEST_SEED", from.to_string());
    }
    process::run(&mut kill)?;
    // The first that does not pass ends it, with its seed.
    println!("{kills} of {kills} kills passed", kills = options.kills);
    Ok(())
}

/// A test of whole processes in a release build; its environment says how long it is.
pub(crate) fn long_form(test: &str) -> std::process::Command {
    let mut cargo = process::cargo();
    cargo.args(["test", "--release", "-q", "-p", "rafcon", "--test", "it", test]);
    cargo.args(["--", "--exact", "--nocapture"]);
    cargo
}
