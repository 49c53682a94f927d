//! The `rafcon` command. Knows how the program begins and ends; each command knows itself.

mod cli;
mod commands;
mod templates;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> anyhow::Result<ExitCode> {
    commands::main(cli::Cli::parse())
}
