//! Tests of `rafcon.ros` against foreign programs: nodes of plain `rclpy` from two distributions of ROS 2, installed as
//! Python packages.
//!
//! The packages of a distribution take 250 MB, and a minute to install, so CI does not run this.

mod table;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use crate::product::{Product, Profile};
use crate::{process, python, ros_helper, workspace};

use self::table::Table;

/// A distribution, with the packages of its peers.
struct Distribution {
    name: &'static str,
    contents: python::Contents,
}

/// A package that the interface generators import without declaring it.
const GENERATORS: &str = "catkin_pkg==1.1.1";

const DISTRIBUTIONS: [Distribution; 2] = [
    Distribution {
        name: "jazzy",
        contents: python::Contents {
            bare: &[],
            full: &[
                "ros-jazzy-rclpy[fastrtps]==7.1.6",
                "ros-test-msgs==2.0.3",
                "ros-std-srvs==5.3.6",
                "ros-sensor-msgs==5.3.6",
                "ros-nav-msgs==5.3.6",
                "ros-visualization-msgs==5.3.6",
                GENERATORS,
            ],
        },
    },
    Distribution {
        name: "kilted",
        contents: python::Contents {
            bare: &[],
            full: &[
                "ros-rclpy[fastrtps]==9.1.2",
                "ros-test-msgs==2.3.0",
                "ros-std-srvs==5.5.1",
                "ros-sensor-msgs==5.5.1",
                "ros-nav-msgs==5.5.1",
                "ros-visualization-msgs==5.5.1",
                GENERATORS,
            ],
        },
    },
];

/// Network setup of a command: only loopback, so that neighbours neither receive its messages nor disturb it.
const ALONE: &str = "ip link set lo up && ip link set lo multicast on && exec \"$@\"";

/// The back ends, each tested and measured with each distribution.
const BACKENDS: [&str; 2] = ["rclpy", "native"];

/// Options of `cargo xtask ros`.
#[derive(clap::Args)]
pub(crate) struct RosOptions {
    /// Print each figure as a line of JSON.
    #[arg(long)]
    json: bool,
    /// Measure only; the tests take some more minutes.
    #[arg(long)]
    no_tests: bool,
    /// Test only; the figures take some more minutes.
    #[arg(long, conflicts_with = "no_tests")]
    no_figures: bool,
    /// Number of repetitions of each kind: messages, calls, goals, preemptions.
    #[arg(long, default_value_t = 1000)]
    count: u32,
    /// Use one distribution only.
    #[arg(long, value_parser = ["jazzy", "kilted"])]
    distribution: Option<String>,
    /// Use one back end only.
    #[arg(long, value_parser = BACKENDS)]
    backend: Option<String>,
}

/// Tests against both distributions with both back ends, measures, and fails if a test fails or a bar is missed.
pub(crate) fn run(options: &RosOptions) -> Result<()> {
    // Measure the build that users have.
    let profile = if options.no_figures { Profile::Debug } else { Profile::Release };
    let product = Product::build(profile)?;
    let helper = ros_helper::build(profile)?;
    let is_wanted = |wanted: &Option<String>, name| wanted.as_deref().is_none_or(|one| one == name);
    let mut missed = Vec::new();
    let mut table = Table::default();
    for distribution in &DISTRIBUTIONS {
        if !is_wanted(&options.distribution, distribution.name) {
            continue;
        }
        let peers = venv(distribution)?;
        for backend in BACKENDS {
            if is_wanted(&options.backend, backend) {
                let own = &peers;
                let side = Side { own, peers: &peers, backend, helper: &helper, product: &product };
                let cells = Table::file()?;
                both(&side, distribution.name, options, &mut missed)?;
                table.read(&cells, backend, distribution.name)?;
            }
        }
    }
    if !options.no_tests && options.distribution.is_none() && is_wanted(&options.backend, "rclpy") {
        let [one, two] = &DISTRIBUTIONS;
        for (own, other) in [(one, two), (two, one)] {
            let (ours, theirs) = (venv(own)?, venv(other)?);
            let (backend, helper, product) = ("rclpy", helper.as_path(), &product);
            let side = Side { own: &ours, peers: &theirs, backend, helper, product };
            let of = format!("{} with peers of {}", own.name, other.name);
            tests(&side, "test_peer.py", &of, &mut missed)?;
        }
    }
    if !options.no_tests {
        tell(&table, options, &mut missed)?;
    }
    ensure!(missed.is_empty(), "missed: {}", missed.join(", "));
    Ok(())
}

/// Reports the number of failed cells of the table; writes the table if all of it was tested.
fn tell(table: &Table, options: &RosOptions, missed: &mut Vec<String>) -> Result<()> {
    table.failures().iter().for_each(|failure| eprintln!("{failure}"));
    report(["all", "all"], &table.figure().to_string(), options.json, missed)?;
    if options.distribution.is_none() && options.backend.is_none() {
        table.write()?;
    }
    Ok(())
}

/// The environment of a distribution.
fn venv(of: &Distribution) -> Result<PathBuf> {
    let folder = workspace::target()?.join("ros-venvs").join(of.name);
    let python = python::environment(&python::default()?, &folder, of.contents)?;
    generate(&folder, &python)?;
    Ok(folder)
}

/// Generates the types of the tests in an environment, if they are missing.
fn generate(folder: &Path, python: &Path) -> Result<()> {
    let (stamp, program) = (folder.join("types.txt"), format!("{FOLDER}/generate.py"));
    let types = workspace::path(FOLDER).join("types");
    let mut about = fs::read_to_string(workspace::path(&program))?;
    for pattern in ["msg", "srv", "action"] {
        for package in sorted(&types)? {
            let Ok(files) = sorted(&package.join(pattern)) else { continue };
            for file in files {
                let text = fs::read_to_string(&file)?;
                let _infallible = write!(about, "{}\n{text}", file.display());
            }
        }
    }
    if fs::read_to_string(&stamp).is_ok_and(|before| before == about) {
        return Ok(());
    }
    process::run(python::command(python).arg(&program).arg(&types))?;
    fs::write(&stamp, about).with_context(|| format!("cannot write {}", stamp.display()))
}

/// The entries of a folder by name.
fn sorted(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries =
        fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut all = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    all.sort();
    Ok(all)
}

/// Runs the tests in the files of this pattern.
fn tests(side: &Side<'_>, pattern: &str, of: &str, missed: &mut Vec<String>) -> Result<()> {
    let mut tests = side.python()?;
    tests.args(["-m", "unittest", "discover", "--start-directory", FOLDER, "--pattern", pattern]);
    if let Err(why) = process::run(&mut tests) {
        eprintln!("{why:#}");
        missed.push(format!("tests ({of})"));
    }
    Ok(())
}

/// Tests and figures of one distribution with one back end.
fn both(
    side: &Side<'_>,
    distribution: &str,
    options: &RosOptions,
    missed: &mut Vec<String>,
) -> Result<()> {
    let of = format!("{distribution}, {}", side.backend);
    if !options.no_tests {
        tests(side, "test*.py", &of, missed)?;
    }
    if options.no_figures {
        return Ok(());
    }
    let mut bars = side.python()?;
    bars.arg(format!("{FOLDER}/bars.py")).arg(options.count.to_string());
    // An error in the measurements must not hide the other results.
    match process::text(&mut bars) {
        Ok(text) => {
            for line in text.lines() {
                report([distribution, side.backend], line, options.json, missed)?;
            }
        }
        Err(why) => {
            eprintln!("{why:#}");
            missed.push(format!("figures ({of})"));
        }
    }
    Ok(())
}

/// Folder of the tests and their peers.
const FOLDER: &str = "crates/python/tests/ros";

/// Our side of a test: a back end, and the environment of its peers.
struct Side<'a> {
    /// Environment of our side, with the back end `rclpy`.
    own: &'a Path,
    /// Environment of the peers.
    peers: &'a Path,
    backend: &'static str,
    helper: &'a Path,
    product: &'a Product,
}

impl Side<'_> {
    /// A Python with `rafcon` and this back end; without `rclpy` for `native`.
    fn python(&self) -> Result<Command> {
        let [own, peer] = [self.own, self.peers].map(|folder| folder.join("bin/python"));
        let own = if self.backend == "rclpy" { own } else { python::default()?.program };
        let mut python = alone(&own, self.product);
        python.env("RAFCON_ROS_BACKEND", self.backend).env("RAFCON_ROS_PEER_PYTHON", peer);
        python.env("RAFCON_ROS_TABLE", workspace::target()?.join("ros-table.jsonl"));
        if self.backend == "native" {
            python.env("RAFCON_ROS", self.helper);
            python.env("RAFCON_ROS_TYPES", self.peers.join("share"));
        }
        Ok(python)
    }
}

/// Prints a figure.
fn report(of: [&str; 2], line: &str, json: bool, missed: &mut Vec<String>) -> Result<()> {
    let [distribution, backend] = of;
    let mut bar: Value =
        serde_json::from_str(line).with_context(|| format!("no figure: {line}"))?;
    let text = |name: &str| bar[name].as_str().unwrap_or_default().to_owned();
    let (name, unit) = (text("name"), text("unit"));
    let met = bar["met"] == Value::Bool(true);
    if !met {
        missed.push(format!("{name} ({distribution}, {backend})"));
    }
    if json {
        bar["distribution"] = Value::from(distribution);
        bar["backend"] = Value::from(backend);
        println!("{bar}");
    } else {
        let mark = if met { "" } else { "  MISSED" };
        let limit = format!("{} {}", text("better"), bar["limit"]);
        println!(
            "{distribution:8} {backend:8} {name:28} {:>10} {unit:3} ({limit}){mark}",
            bar["value"]
        );
    }
    Ok(())
}

/// A Python in a network namespace of its own, if the system permits users to make one.
fn alone(python: &Path, product: &Product) -> Command {
    let possible = Command::new("unshare").args(["-rn", "true"]).status();
    let own = python::command(python);
    let mut command = if possible.is_ok_and(|status| status.success()) {
        let mut command = process::command("unshare");
        command.args(["-rn", "sh", "-c", ALONE, "sh"]).arg(python);
        command
    } else {
        python::command(python)
    };
    for (name, value) in own.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command.env("RAFCON_EXTENSION", &product.extension).env("RAFCON_BINARY", &product.binary);
    command.args(["-W", "ignore"]);
    command
}
