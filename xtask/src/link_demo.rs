//! The demonstration of the link: a robot with a mission, its station, and a page with a slider for the quality of the
//! link.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use std::{iter, thread};

use anyhow::{Context as _, Result};

use crate::product::{Product, Profile};
use crate::{demo, link, process, web, workspace};

/// Timeout for the robot's run to appear at the station.
const PATIENCE: Duration = Duration::from_secs(30);

/// Builds everything, starts robot, proxy and station, and opens the station's page and the proxy's page, until it is
/// stopped.
pub(crate) fn run(states: u32, quiet: bool) -> Result<()> {
    web::build()?;
    let hosts = DemoHosts::new(Product::build(Profile::Release)?)?;
    let proxy = link::proxy()?;
    let mission = hosts.mission(states)?;
    link::pair(hosts.command("robot"), hosts.command("station"))?;
    let address = link::free_address()?;
    let mut station = hosts.command("station");
    let mut station = Program::begin(station.args(["station", "--listen", &address]).args(SERVER))?;
    let at_station = station.line()?;
    // Opens the page in mission control.
    let page = format!("{at_station}&layout=mission");
    let mut proxy = process::command(proxy);
    proxy.args(["--listen", "127.0.0.1:0", "--to", &address, "--page", "127.0.0.1:0"]);
    let mut proxy = Program::begin(proxy.args(["--at", &page]).stdin(Stdio::piped()))?;
    let [slider, path] = [proxy.address("http://")?, proxy.address("udp://")?];
    let mut robot = hosts.command("robot");
    robot.arg("serve").arg(hosts.folder.join("missions")).args(["--station", &path]).args(SERVER);
    let mut robot = Program::begin(&mut robot)?;
    let at_robot = robot.line()?;
    let mut running = hosts.run(&mission)?;
    let run = hosts.run_at_station()?;
    let page = format!("{page}&run={run}");
    println!(
        "\nmission control at the station  {page}\nthe link                        {slider}\nthe robot's own page            {at_robot}\n\nCtrl-C ends all of them."
    );
    if !quiet {
        demo::open(&page);
        demo::open(&slider);
    }
    // Restart the robot's mission whenever it ends.
    loop {
        running.wait()?;
        running = hosts.run(&mission)?;
    }
}

const SERVER: [&str; 4] = ["--bind", "127.0.0.1:0", "--link", "delay-2s"];

/// A program that is killed on drop.
struct Program {
    child: Child,
    lines: Box<dyn Iterator<Item = std::io::Result<String>>>,
}

impl Program {
    fn begin(command: &mut Command) -> Result<Self> {
        let mut child = command.stdout(Stdio::piped()).spawn().context("cannot start a program")?;
        let lines: Box<dyn Iterator<Item = _>> = match child.stdout.take() {
            Some(out) => Box::new(BufReader::new(out).lines()),
            None => Box::new(iter::empty()),
        };
        Ok(Self { child, lines })
    }

    /// The next line of its output.
    fn line(&mut self) -> Result<String> {
        Ok(self.lines.next().context("a program ended at once")??)
    }

    /// The address at the end of the next line.
    fn address(&mut self, scheme: &str) -> Result<String> {
        let line = self.line()?;
        let (_, rest) =
            line.split_once(scheme).with_context(|| format!("no address in `{line}`"))?;
        Ok(format!("{scheme}{rest}"))
    }

    fn wait(&mut self) -> Result<()> {
        self.lines.by_ref().for_each(drop);
        self.child.wait()?;
        Ok(())
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // The program may have ended by itself.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// Robot and station, each with its own folder.
struct DemoHosts {
    product: Product,
    folder: PathBuf,
}

impl DemoHosts {
    /// Hosts in an empty folder.
    fn new(product: Product) -> Result<Self> {
        let folder = workspace::target()?.join("demo-link");
        if folder.exists() {
            fs::remove_dir_all(&folder)
                .with_context(|| format!("cannot remove {}", folder.display()))?;
        }
        Ok(Self { product, folder })
    }

    fn command(&self, host: &str) -> Command {
        let mut command = process::command(&self.product.binary);
        let home = self.folder.join(host);
        command.env("RAFCON_RUNS", home.join("runs")).env("RAFCON_STATE", home.join("state"));
        command
    }

    fn mission(&self, states: u32) -> Result<PathBuf> {
        let mission = self.folder.join("missions/mission");
        let mut new = self.command("robot");
        new.arg("new").arg(&mission).args(["--template", "mission", "--states"]);
        process::quiet(new.arg(states.to_string()))?;
        Ok(mission)
    }

    /// Starts the mission at a realistic pace.
    fn run(&self, mission: &Path) -> Result<Program> {
        let mut run = self.command("robot");
        Program::begin(run.arg("run").arg(mission).args(["--input", "time_scale=1"]))
    }

    /// Id of the run, once the station has received it.
    fn run_at_station(&self) -> Result<String> {
        let runs = self.folder.join("station/runs");
        for _ in 0..PATIENCE.as_secs() * 4 {
            if let Some(run) = first_folder(&runs) {
                return Ok(run);
            }
            thread::park_timeout(Duration::from_millis(250));
        }
        anyhow::bail!("the station has not received the robot's run: see `rafcon link`")
    }
}

fn first_folder(folder: &Path) -> Option<String> {
    let mut entries = fs::read_dir(folder).ok()?.flatten();
    let run = entries.find(|entry| entry.path().join("run.json").exists())?;
    run.file_name().into_string().ok()
}
