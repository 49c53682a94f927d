//! The page in a browser without a GPU: its speed (frames, opening, edits, memory), and its pictures for the documents. What is
//! measured how stands in `web/bench`.

use std::process::Command;

use anyhow::Result;

use crate::product::{Product, Profile};
use crate::{process, web, workspace};

/// What `cargo xtask bench-web` can be asked for.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Print one JSON object a line instead of a table.
    #[arg(long)]
    json: bool,
}

/// Builds page and program in release, and measures.
pub(crate) fn run(options: &Options) -> Result<()> {
    let mut bench = program("main")?;
    if options.json {
        bench.arg("--json");
    }
    process::run(&mut bench)
}

/// Builds page and program in release, and takes pictures into `docs/pictures`.
pub(crate) fn pictures() -> Result<()> {
    process::run(&mut program("pictures")?)
}

/// One of the programs in `web/bench`, ready to be started.
fn program(name: &str) -> Result<Command> {
    web::build()?;
    let product = Product::build(Profile::Release)?;
    // Beside the packages that it needs.
    let bundle = workspace::path(format!("web/node_modules/.rafcon-{name}.mjs"));
    let source = format!("bench/{name}.ts");
    let mut bundler = web::program("rolldown")?;
    bundler.args([&source, "--platform", "node", "--external", "playwright-core", "--file"]);
    process::quiet(bundler.arg(&bundle))?;
    let mut node = process::command("node");
    node.current_dir(workspace::path("web")).arg(&bundle).env("RAFCON_BINARY", &product.binary);
    Ok(node)
}
