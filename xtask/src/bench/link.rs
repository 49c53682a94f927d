//! Cost of the link for the robot: speed of a run that is recorded and sent to a station, divided by that of a recorded
//! run.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anyhow::{Context as _, Result, ensure};

use super::whole_process::{Bench, RUNS};
use super::{Measured, middle};
use crate::{link, process};

/// Measures both in turns, computes the ratio of each round, then the median.
pub(super) fn measure(bench: &Bench) -> Result<Vec<Measured>> {
    let ratios = (0..RUNS).map(|_| {
        let without = speed(bench, false)?;
        Ok(speed(bench, true)? / without)
    });
    Ok(vec![middle("no_link_cost_ratio", ratios.collect::<Result<_>>()?)?])
}

/// Speed of a run that a server follows; with a station, the server sends the run there.
fn speed(bench: &Bench, has_station: bool) -> Result<f64> {
    let runs = bench.empty_runs()?;
    let place = runs.with_file_name("link");
    if place.exists() {
        fs::remove_dir_all(&place).with_context(|| format!("cannot empty {}", place.display()))?;
    }
    let hosts = MeasuredLink { binary: bench.binary(), place };
    let station = has_station.then(|| hosts.station()).transpose()?;
    let address = station.as_ref().map(|(_, address)| address.as_str());
    let _robot = hosts.robot(runs, address)?;
    bench.speed(&mut bench.run_kept("flat", "full", runs))
}

/// A robot and a station on this computer, with their folders.
struct MeasuredLink<'b> {
    binary: &'b Path,
    place: PathBuf,
}

/// A server that is killed on drop.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        // The server may have ended by itself.
        drop(self.0.kill());
        drop(self.0.wait());
    }
}

impl MeasuredLink<'_> {
    fn command(&self, host: &str) -> Command {
        let mut command = process::command(self.binary);
        command.env("HOME", self.place.join(host)).env("RAFCON_STATE", self.place.join(host));
        command
    }

    /// A station that is paired with the robot, and its address.
    fn station(&self) -> Result<(Server, String)> {
        link::pair(self.command("robot"), self.command("station"))?;
        let address = link::free_address()?;
        let mut station = self.command("station");
        station.args(["station", "--listen", &address, "--runs"]).arg(self.place.join("replicas"));
        Ok((begin(station)?, address))
    }

    fn robot(&self, runs: &Path, station: Option<&str>) -> Result<Server> {
        let mut robot = self.command("robot");
        robot.arg("serve").arg("--runs").arg(runs);
        if let Some(address) = station {
            robot.args(["--station", &format!("udp://{address}")]);
        }
        begin(robot)
    }
}

/// Starts a server and waits until it listens.
fn begin(mut server: Command) -> Result<Server> {
    server.args(["--bind", "127.0.0.1:0"]).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = server.spawn().context("cannot start the server")?;
    let out = child.stdout.take().context("the server's output is not piped")?;
    let server = Server(child);
    let mut line = String::new();
    ensure!(BufReader::new(out).read_line(&mut line)? > 0, "the server ended at once");
    Ok(server)
}
