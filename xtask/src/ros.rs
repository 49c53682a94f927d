//! `rafcon.ros` against programs of others: nodes of plain `rclpy` from two distributions of ROS 2, which come as Python packages.
//!
//! The packages of a distribution take 250 MB, and a minute to install; so CI does not run this.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use crate::product::{Product, Profile};
use crate::{process, python, ros_helper, workspace};

/// A distribution, with what its peers are made of.
struct Distribution {
    name: &'static str,
    contents: python::Contents,
}

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
            ],
        },
    },
];

/// What a command runs in: loopback only, so that nothing in the neighbourhood hears or disturbs it.
const ALONE: &str = "ip link set lo up && ip link set lo multicast on && exec \"$@\"";

/// What `cargo xtask ros` can be asked for.
#[derive(clap::Args)]
pub(crate) struct RosOptions {
    /// Print each figure as a line of JSON.
    #[arg(long)]
    json: bool,
    /// Measure only; the tests take some minutes more.
    #[arg(long)]
    no_tests: bool,
    /// So many of each kind: messages, calls, goals, preemptions.
    #[arg(long, default_value_t = 1000)]
    count: u32,
}

/// Tests against both distributions, then measures, and fails if a bar is missed.
pub(crate) fn run(options: &RosOptions) -> Result<()> {
    let product = Product::build(Profile::Debug)?;
    let mut missed = Vec::new();
    for distribution in &DISTRIBUTIONS {
        let folder_of_peers = workspace::target()?.join("ros-venvs").join(distribution.name);
        let python =
            python::environment(&python::default()?, &folder_of_peers, distribution.contents)?;
        if !options.no_tests {
            let folder = "crates/python/tests/ros";
            let words = ["-m", "unittest", "discover", "--start-directory", folder];
            process::run(alone(&python, &product).args(words))?;
            process::run(&mut bridge(&folder_of_peers, &python, &product)?)?;
        }
        let mut bars = alone(&python, &product);
        bars.arg("crates/python/tests/ros/bars.py").arg(options.count.to_string());
        for line in process::text(&mut bars)?.lines() {
            report(distribution.name, line, options.json, &mut missed)?;
        }
    }
    ensure!(missed.is_empty(), "missed: {}", missed.join(", "));
    Ok(())
}

/// The tests of `rafcon serve --ros` with `rafcon-ros`, which knows the types of the bridge; `peers` is the environment of the others.
fn bridge(peers: &Path, peer: &Path, product: &Product) -> Result<Command> {
    let mut tests = alone(&python::default()?.program, product);
    tests.args(["-m", "unittest", "discover", "--start-directory", "crates/python/tests/ros"]);
    tests.args(["--pattern", "test_bridge.py"]).env("RAFCON_ROS_BACKEND", "native");
    tests.env("RAFCON_ROS", ros_helper::build(Profile::Debug)?);
    tests.env("RAFCON_ROS_PEER_PYTHON", peer).env("RAFCON_ROS_TYPES", peers.join("share"));
    Ok(tests)
}

/// Prints a figure.
fn report(distribution: &str, line: &str, json: bool, missed: &mut Vec<String>) -> Result<()> {
    let mut bar: Value =
        serde_json::from_str(line).with_context(|| format!("no figure: {line}"))?;
    let text = |name: &str| bar[name].as_str().unwrap_or_default().to_owned();
    let (name, unit) = (text("name"), text("unit"));
    let met = bar["met"] == Value::Bool(true);
    if !met {
        missed.push(format!("{name} ({distribution})"));
    }
    if json {
        bar["distribution"] = Value::from(distribution);
        println!("{bar}");
    } else {
        let mark = if met { "" } else { "  MISSED" };
        let limit = format!("{} {}", text("better"), bar["limit"]);
        println!("{distribution:8} {name:28} {:>10} {unit:3} ({limit}){mark}", bar["value"]);
    }
    Ok(())
}

/// A Python in a network of its own, where the system lets users make one.
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
