//! The demonstration: a generated mission of the size of a real one, run live in this terminal.

use anyhow::{Context as _, Result};

use crate::product::{Product, Profile};
use crate::{process, workspace};

/// What `cargo xtask demo` can be asked for.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// How many states the mission has.
    #[arg(long, default_value_t = 750)]
    states: u32,
}

/// Builds everything, generates the mission afresh and runs it.
pub(crate) fn run(options: &Options) -> Result<()> {
    let product = Product::build(Profile::Release)?;
    let mission = workspace::target()?.join("demo-mission");
    if mission.exists() {
        std::fs::remove_dir_all(&mission)
            .with_context(|| format!("cannot remove {}", mission.display()))?;
    }
    let states = options.states.to_string();
    let mut new = process::command(&product.binary);
    process::run(new.arg("new").arg(&mission).args([
        "--template",
        "mission",
        "--states",
        &states,
    ]))?;
    process::run(process::command(&product.binary).arg("run").arg(&mission))
}
