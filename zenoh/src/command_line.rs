//! The options of the command line, and the Zenoh configuration that they result in.

use crate::keys::Fleet;
use anyhow::{Context as _, Result, anyhow};
use clap::{Args, Parser, Subcommand};
use std::io::Write as _;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;
use zenoh::Config;

/// Carry the link between a RAFCON robot and its station over Zenoh.
#[derive(Debug, Parser)]
#[command(version)]
pub(crate) struct CommandLine {
    #[command(flatten)]
    pub(crate) network: Network,
    #[command(subcommand)]
    pub(crate) side: Side,
}

/// Settings of the Zenoh network, for both sides.
#[derive(Debug, Args)]
pub(crate) struct Network {
    /// Zenoh's configuration, as a JSON5 file: mode, endpoints, certificates
    #[arg(long, value_name = "FILE", global = true)]
    pub(crate) config: Option<PathBuf>,
    /// Connect to this endpoint, such as `tls/ground.example:7447` (repeat for more)
    #[arg(long, value_name = "ENDPOINT", global = true)]
    pub(crate) connect: Vec<String>,
    /// Name of the fleet, the second part of all keys
    #[arg(long, value_name = "NAME", default_value = "fleet", global = true)]
    pub(crate) fleet: Fleet,
    /// Reopen the Zenoh session if nothing arrives for this many seconds after an arrival
    #[arg(long, value_name = "SECONDS", default_value_t = 60, global = true)]
    pub(crate) silence: u64,
}

/// The side of the link.
#[derive(Debug, Subcommand)]
pub(crate) enum Side {
    /// Beside a robot that serves with `--station udp://ADDRESS:PORT`
    Robot(RobotSide),
    /// Beside a station
    Station(StationSide),
    /// List the robots that are in the network now
    List,
}

/// The side of a robot.
#[derive(Debug, Args)]
pub(crate) struct RobotSide {
    /// Name of the robot in its pairing
    #[arg(value_name = "NAME")]
    pub(crate) robot: String,
    /// Address at which this robot's datagrams are received
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:4749")]
    pub(crate) listen: SocketAddr,
}

/// The side of a station.
#[derive(Debug, Args)]
pub(crate) struct StationSide {
    /// Address at which the station receives robots
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:4748")]
    pub(crate) to: SocketAddr,
}

impl Network {
    /// The configuration of Zenoh. Unreachable endpoints are retried forever.
    pub(crate) fn config(&self) -> Result<Config> {
        let mut config = match &self.config {
            Some(file) => {
                Config::from_file(file).map_err(|error| anyhow!(error)).with_context(|| {
                    format!("cannot use {} as Zenoh's configuration", file.display())
                })?
            }
            None => Config::default(),
        };
        let mut set = |key: &str, value: &str| {
            config.insert_json5(key, value).map_err(|error| anyhow!(error))
        };
        if !self.connect.is_empty() {
            let endpoints: Vec<String> =
                self.connect.iter().map(|endpoint| format!("{endpoint:?}")).collect();
            let endpoints = format!("[{}]", endpoints.join(","));
            set("connect/endpoints", &endpoints).with_context(|| {
                format!("--connect {}: write tls/HOST:7447", self.connect.join(" "))
            })?;
        }
        set("connect/timeout_ms", "-1")?;
        set("connect/exit_on_failure", "false")?;
        // Zenoh's own retry interval grows, and so would delay the reconnection after a blackout.
        set(
            "connect/retry",
            "{ period_init_ms: 1000, period_max_ms: 2000, period_increase_factor: 2 }",
        )?;
        Ok(config)
    }

    pub(crate) fn silence(&self) -> Duration {
        Duration::from_secs(self.silence)
    }
}

/// Prints a message for people; ignores a closed error output.
pub(crate) fn complain(text: &str) {
    writeln!(std::io::stderr(), "{text}").unwrap_or_default();
}

/// Prints a line to the standard output; ignores a closed one.
pub(crate) fn print(text: &str) {
    writeln!(std::io::stdout(), "{text}").unwrap_or_default();
}
