//! The page in a browser without a GPU: its speed (frames, opening, edits, memory, runs), a long watch of a run, and its
//! pictures for the documents. `web/bench` contains the measurements.

use std::process::Command;

use anyhow::Result;

use crate::product::{Product, Profile};
use crate::{process, web, workspace};

/// Options of `cargo xtask bench-web`.
#[derive(clap::Args)]
pub(crate) struct BenchWebOptions {
    /// Print one JSON object a line instead of a table.
    #[arg(long)]
    json: bool,
}

/// Options of `cargo xtask soak-web`.
#[derive(clap::Args)]
pub(crate) struct Watch {
    /// Duration of the watch in minutes.
    #[arg(long, default_value_t = 10.0)]
    minutes: f64,
    /// Number of states that change in a second.
    #[arg(long, default_value_t = 20)]
    rate: u32,
    /// Print one JSON object a line instead of a table.
    #[arg(long)]
    json: bool,
}

/// The watch of the tests, which check that every event arrives once.
const BRIEFLY: Watch = Watch { minutes: 0.4, rate: 100, json: false };

/// Builds page and program in release, and measures.
pub(crate) fn run(options: &BenchWebOptions) -> Result<()> {
    let mut bench = released("main")?;
    if options.json {
        bench.arg("--json");
    }
    process::run(&mut bench)
}

/// Builds page and program in release, and takes pictures into `docs/pictures`.
pub(crate) fn pictures() -> Result<()> {
    process::run(&mut released("pictures")?)
}

/// Builds page and program in release, and watches an endless mission of 750 states.
pub(crate) fn soak(options: &Watch) -> Result<()> {
    watch(released("soak")?, options)
}

/// Watches an endless mission briefly, with the built page and an existing program.
pub(crate) fn soak_briefly(product: &Product) -> Result<()> {
    watch(program("soak", product)?, &BRIEFLY)
}

fn watch(mut soak: Command, Watch { minutes, rate, json }: &Watch) -> Result<()> {
    soak.args(["--seconds", &(minutes * 60.0).to_string(), "--rate", &rate.to_string()]);
    if *json {
        soak.arg("--json");
    }
    process::run(&mut soak)
}

/// One of the programs in `web/bench`, with page and program built for it.
fn released(name: &str) -> Result<Command> {
    web::build()?;
    program(name, &Product::build(Profile::Release)?)
}

/// One of the programs in `web/bench`, ready to be started.
pub(crate) fn program(name: &str, product: &Product) -> Result<Command> {
    // Next to the packages that it needs.
    let bundle = workspace::path(format!("web/node_modules/.rafcon-{name}.mjs"));
    let source = format!("bench/{name}.ts");
    let mut bundler = web::program("rolldown")?;
    bundler.args([
        &source,
        "--platform",
        "node",
        "--external",
        "playwright-core",
        "--external",
        "ws",
        "--file",
    ]);
    process::quiet(bundler.arg(&bundle))?;
    let mut node = process::command("node");
    node.current_dir(workspace::path("web")).arg(&bundle).env("RAFCON_BINARY", &product.binary);
    Ok(node)
}
