//! Carries the datagrams of RAFCON's link over Zenoh, between UDP ports of two computers.
//!
//! Robot and station send to this program as to any other address. It knows nothing of the content: each datagram is
//! encrypted and authenticated, so other members of the Zenoh network can neither read nor forge one.

mod carry;
mod command_line;
mod keys;
mod list;
mod robot;
mod station;

use command_line::{CommandLine, Side};
use std::process::ExitCode;

use clap::Parser as _;

#[tokio::main]
async fn main() -> ExitCode {
    let line = CommandLine::parse();
    let done = tokio::select! {
        done = run(&line) => done,
        asked = tokio::signal::ctrl_c() => asked.map_err(Into::into),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            command_line::complain(&format!("error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}

async fn run(line: &CommandLine) -> anyhow::Result<()> {
    match &line.side {
        Side::Robot(robot) => robot::carry(&line.network, robot).await,
        Side::Station(station) => station::carry(&line.network, station).await,
        Side::List => list::list(&line.network).await,
    }
}
