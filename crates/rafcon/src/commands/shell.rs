//! Shell completions and manual pages of the command line.

use crate::cli::{Cli, Completions};
use anyhow::Result;
use clap::CommandFactory as _;
use std::io::Write as _;
use std::process::ExitCode;

/// Prints the completions of a shell.
pub(super) fn completions(request: &Completions) -> Result<ExitCode> {
    let mut text = Vec::new();
    clap_complete::generate(request.shell, &mut Cli::command(), "rafcon", &mut text);
    std::io::stdout().write_all(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// Prints the manual page: the command itself, then each of its commands.
pub(super) fn man() -> Result<ExitCode> {
    let mut command = Cli::command();
    command.build();
    let mut text = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut text)?;
    for part in command.get_subcommands().filter(|part| part.get_name() != "help") {
        clap_mangen::Man::new(part.clone()).render(&mut text)?;
    }
    std::io::stdout().write_all(&text)?;
    Ok(ExitCode::SUCCESS)
}
