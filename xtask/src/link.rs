//! Robots and stations over a bad link: the gate in virtual time and in real time, and the bad link itself as a program.

use std::io::Write as _;
use std::net::UdpSocket;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, ensure};

use crate::product::{Product, Profile};
use crate::{bench_web, process, web, workspace};

/// Options of `cargo xtask spacebotcamp`.
#[derive(clap::Args)]
pub(crate) struct SpacebotcampOptions {
    /// Number of simulated worlds.
    #[arg(long, default_value_t = 100)]
    seeds: u64,
    /// Seed of the first world.
    #[arg(long, default_value_t = 0)]
    from: u64,
    /// Run once in real time instead, with real programs, operators and a browser.
    #[arg(long)]
    real: bool,
    /// Duration in minutes; the events of the hour are scaled.
    #[arg(long, default_value_t = 60.0, requires = "real")]
    minutes: f64,
    /// Number of stations of the robot: 1, or 3, of which one joins late.
    #[arg(long, default_value_t = 3, requires = "real")]
    stations: u8,
    /// Measure only the opening of a page on the far side of a link of 64 kbit/s, through two real kernels; needs root.
    #[arg(long, requires = "real")]
    far: bool,
    /// Run only for some minutes over each link of `web/bench/link/links.json`, or over those with these names, separated
    /// by commas.
    #[arg(long, requires = "real", num_args = 0..=1, default_missing_value = "")]
    links: Option<String>,
    /// Print each figure as a line of JSON.
    #[arg(long)]
    json: bool,
}

/// Prints the table of the link, or the first seed with a broken invariant; fails if a bar is missed.
pub(crate) fn spacebotcamp(options: &SpacebotcampOptions) -> Result<()> {
    if options.real {
        return really(options);
    }
    let mut world = process::cargo();
    world.args(["run", "--release", "-p", "rafcon-testkit", "--example", "link_world", "--"]);
    let (seeds, from) = (options.seeds.to_string(), options.from.to_string());
    world.args(["--seeds", &seeds, "--from", &from]).args(options.json.then_some("--json"));
    process::run(&mut world)
}

fn really(options: &SpacebotcampOptions) -> Result<()> {
    web::build()?;
    let product = Product::build(Profile::Release)?;
    let proxy = proxy()?;
    let mut camp = bench_web::program("spacebotcamp", &product)?;
    camp.env("RAFCON_LINK_PROXY", proxy).args(["--minutes", &options.minutes.to_string()]);
    camp.args(["--stations", &options.stations.to_string()]);
    camp.args(options.far.then_some("--far"));
    if let Some(links) = &options.links {
        camp.args(["--links", links]);
    }
    process::run(camp.args(options.json.then_some("--json")))
}

/// Options of `cargo xtask link-proxy`.
#[derive(clap::Args)]
pub(crate) struct LinkProxyOptions {
    /// Arguments of the proxy; `--help` after `--` lists them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<String>,
}

/// Carries datagrams between a robot and a station with faults, until it is stopped.
pub(crate) fn link_proxy(options: &LinkProxyOptions) -> Result<()> {
    process::run(process::command(proxy()?).args(&options.words))
}

/// Builds the proxy and returns its path.
pub(crate) fn proxy() -> Result<PathBuf> {
    let build =
        ["build", "--release", "--quiet", "-p", "rafcon-testkit", "--example", "link_proxy"];
    process::run(process::cargo().args(build))?;
    Ok(workspace::target()?.join("release/examples/link_proxy"))
}

/// Pairs a robot with a station. Each command runs the program of one computer.
pub(crate) fn pair(mut robot: Command, mut station: Command) -> Result<()> {
    let line = process::quiet(robot.args(["pair", "scout"]))?;
    let paste = station.args(["pair", "--paste"]).stdin(Stdio::piped()).stdout(Stdio::null());
    let mut paste = paste.spawn().context("cannot pair the station")?;
    paste.stdin.take().context("no input")?.write_all(line.as_bytes())?;
    ensure!(paste.wait()?.success(), "the station is not paired");
    Ok(())
}

/// A free address of this computer for datagrams.
pub(crate) fn free_address() -> Result<String> {
    Ok(UdpSocket::bind("127.0.0.1:0")?.local_addr()?.to_string())
}
