//! The speed of the page, measured in a browser without a GPU: frames, opening, edits, memory. What is measured how stands in
//! `web/bench`.

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
    web::build()?;
    let product = Product::build(Profile::Release)?;
    // Beside the packages that it needs.
    let bench = workspace::path("web/node_modules/.bench-web.mjs");
    let mut bundle = web::program("rolldown")?;
    bundle.args(["bench/main.ts", "--platform", "node", "--external", "playwright-core", "--file"]);
    process::quiet(bundle.arg(&bench))?;
    let mut node = process::command("node");
    node.current_dir(workspace::path("web")).arg(&bench).env("RAFCON_BINARY", &product.binary);
    if options.json {
        node.arg("--json");
    }
    process::run(&mut node)
}
