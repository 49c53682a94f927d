//! One module a command; each turns raw words into a checked request and carries it out.

mod run;
mod shell;

use crate::cli::{Cli, Command};
use crate::clock::Clock;
use crate::environment::Environment;
use anyhow::Result;
use std::process::ExitCode;

/// Carries out a command and says how the program ends.
pub(crate) fn main(cli: Cli, environment: &Environment, clock: Clock) -> Result<ExitCode> {
    match cli.command {
        Command::Run(request) => run::run(&request, environment, clock),
        Command::Completions(request) => shell::completions(&request),
        Command::Man(_) => shell::man(),
    }
}
