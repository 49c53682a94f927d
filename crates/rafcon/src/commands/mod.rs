//! One module a command; each turns raw words into a checked request and carries it out.

mod shell;

use crate::cli::{Cli, Command};
use anyhow::Result;
use std::process::ExitCode;

/// Carries out a command and says how the program ends.
pub(crate) fn main(cli: Cli) -> Result<ExitCode> {
    match cli.command {
        Command::Completions(request) => shell::completions(&request),
        Command::Man(_) => shell::man(),
    }
}
