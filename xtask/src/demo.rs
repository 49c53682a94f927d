//! The demonstration: a generated mission of realistic size, in the page, or live in this terminal.

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context as _, Result, bail};

use crate::product::{Product, Profile};
use crate::{link_demo, process, ros_helper, test, web, workspace};

/// Options of `cargo xtask demo`.
#[derive(clap::Args)]
pub(crate) struct DemoOptions {
    /// Number of states in the mission.
    #[arg(long, default_value_t = 750)]
    states: u32,
    /// Run the mission live in this terminal instead of showing it in a browser.
    #[arg(long)]
    terminal: bool,
    /// Show the mission from a station over a bad link, with a page that makes the link better and worse.
    #[arg(long, conflicts_with = "terminal")]
    link: bool,
    /// Only print the page's address, without opening a browser.
    #[arg(long)]
    quiet: bool,
}

/// Builds everything, generates the mission afresh and shows it.
pub(crate) fn run(options: &DemoOptions) -> Result<()> {
    if options.link {
        return link_demo::run(options.states, options.quiet);
    }
    if !options.terminal {
        web::build()?;
    }
    let product = Product::build(Profile::Release)?;
    if let Err(why) = ros_helper::build(Profile::Release) {
        eprintln!("the demo runs without rafcon-ros, which cannot be built: {why:#}");
    }
    let missions = workspace::target()?.join("demo");
    let mission = missions.join("mission");
    if mission.exists() {
        std::fs::remove_dir_all(&mission)
            .with_context(|| format!("cannot remove {}", mission.display()))?;
    }
    let mut new = process::command(&product.binary);
    let states = options.states.to_string();
    process::run(new.arg("new").arg(&mission).args([
        "--template",
        "mission",
        "--states",
        &states,
    ]))?;
    if options.terminal {
        return process::run(process::command(&product.binary).arg("run").arg(&mission));
    }
    let rover = missions.join("rover");
    if !rover.exists() {
        let mut new = process::command(&product.binary);
        process::run(new.arg("new").arg(&rover).args(["--template", "rover"]))?;
    }
    serve(&product.binary, &missions, options.quiet)
}

/// Serves the missions and copies of the examples, until it is stopped.
fn serve(rafcon: &Path, missions: &Path, quiet: bool) -> Result<()> {
    let examples = examples(missions)?;
    let libraries = examples.join("libraries");
    let mut serve = process::command(rafcon);
    serve.arg("serve").arg(missions).args(["--bind", "127.0.0.1:0", "--library-path"]);
    serve.arg(format!("examples={}", libraries.display())).arg("--library-path");
    serve.arg(format!("planning={}", workspace::path("libraries/planning").display()));
    match test::engine_environment() {
        Ok(python) => drop(serve.env("RAFCON_PYTHON", python)),
        Err(error) => eprintln!("the rover will not plan, there is no engine: {error:#}"),
    }
    let mut server = serve.stdout(Stdio::piped()).spawn().context("cannot start the server")?;
    let out = server.stdout.take().context("the server's output is not piped")?;
    for (number, line) in BufReader::new(out).lines().enumerate() {
        let line = line.context("cannot read the server's output")?;
        println!("{line}");
        if number == 0 && !quiet {
            open(&line);
        }
    }
    let status = server.wait().context("the server is lost")?;
    if !status.success() {
        bail!("the server ended: {status}");
    }
    Ok(())
}

/// Copies of the examples, which the user may change freely. Existing copies are kept.
fn examples(missions: &Path) -> Result<PathBuf> {
    let folder = missions.join("examples");
    if !folder.exists() {
        workspace::copy("examples", &folder)?;
    }
    Ok(folder)
}

/// Opens an address in the browser, if possible. Otherwise the user copies the address.
pub(crate) fn open(link: &str) {
    let mut opener = process::command("xdg-open");
    let opener = opener.arg(link).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let has_screen =
        ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if has_screen && opener.spawn().is_err() {
        eprintln!("open this address in a browser");
    }
}
