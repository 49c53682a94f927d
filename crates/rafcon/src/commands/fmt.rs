//! `rafcon fmt`: rewrites a machine in the current file format.

use crate::cli;
use crate::environment::variable;
use crate::failure::complain;
use anyhow::Result;
use rafcon_storage::{config, format};
use std::io::{self, Write as _};
use std::process::ExitCode;

/// Rewrites the machine. With `--check` it only lists the files that would change, and ends with 1 if any would.
pub(super) fn fmt(raw: &cli::Fmt) -> Result<ExitCode> {
    let (config, _file) = config::find(None, &variable)?;
    let formatted = format(&raw.path, config.naming, raw.check)?;
    for problem in &formatted.problems {
        complain(&format!("warning: {problem}"));
    }
    let word = if raw.check { "would change" } else { "changed" };
    let lines = formatted.changed.iter().map(|path| format!("{word} {}\n", path.display()));
    io::stdout().write_all(lines.collect::<String>().as_bytes())?;
    Ok(ExitCode::from(u8::from(raw.check && !formatted.changed.is_empty())))
}
