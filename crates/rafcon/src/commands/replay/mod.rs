//! `rafcon replay`: how a run stood at one of its events.

mod tree;

use super::kept::{nanos, open, out, paint};
use crate::cli;
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::Result;
use std::io::Write as _;
use std::process::ExitCode;

/// Prints the moment that the user means.
pub(super) fn replay(raw: &cli::Replay, environment: &Environment) -> Result<ExitCode> {
    let mut reader = open(&raw.run, environment)?;
    let last = reader.last_sequence()?;
    let sequence = match (raw.at, raw.time) {
        (Some(at), _) if at > last => {
            return Err(Usage(format!("there is no event {at} yet: the last one is {last}")).into());
        }
        (Some(at), _) => at,
        (None, Some(time)) => reader.first_at(nanos(time).saturating_add(1))? - 1,
        (None, None) => last,
    };
    let moment = reader.moment(sequence)?;
    let picture = reader.picture(&moment)?;
    let mut out = out();
    if raw.json {
        writeln!(out, "{}", serde_json::to_string(&picture)?)?;
    } else {
        for line in tree::lines(&reader.about().name, &picture, last) {
            writeln!(out, "{}", line.render(paint(environment)))?;
        }
    }
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}
