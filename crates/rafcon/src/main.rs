//! The `rafcon` command. Knows the start and the end of the program; each command is a module of its own.

mod cli;
mod client;
mod clock;
mod commands;
mod console;
mod environment;
mod event_queue;
mod failure;
mod follow;
mod machine;
mod templates;
mod view;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    let clock = clock::Clock::start();
    let environment = environment::Environment::read();
    commands::main(cli::Cli::parse(), &environment, clock)
        .unwrap_or_else(|error| failure::show(&error))
}
