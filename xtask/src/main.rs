//! Building, checking, measuring and packing this repository: one module a command.
//!
//! Knows the repository's layout and which programs to start. Never links one of the crates: it sees them as anybody
//! outside does, through cargo, the `rafcon` binary and files.
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a developer's tool has to say goes to the terminal"
)]

mod process;
mod tidy;
mod workspace;

use clap::{Parser, Subcommand};

/// Developer's commands of the RAFCON repository.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Check what neither compiler nor lints see: module docs, sizes, named tests, links, generated files.
    Tidy(tidy::Options),
}

fn main() -> anyhow::Result<()> {
    match Arguments::parse().task {
        Task::Tidy(options) => tidy::run(options),
    }
}
