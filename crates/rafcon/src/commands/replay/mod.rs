//! `rafcon replay`: how a run stood at one of its events.

mod tree;

use super::kept::{open, out, paint};
use crate::cli;
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::Result;
use rafcon_storage::journal::Reader;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::time::Duration;

/// Prints the moment that the user means.
pub(super) fn replay(raw: &cli::Replay, environment: &Environment) -> Result<ExitCode> {
    let mut reader = open(&raw.run, environment)?;
    let last = reader.last_sequence()?;
    let sequence = match (raw.at, raw.time) {
        (Some(at), _) if at > last => {
            return Err(Usage(format!("there is no event {at} yet: the last one is {last}")).into());
        }
        (Some(at), _) => at,
        (None, Some(time)) => at_time(&mut reader, time)?,
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

/// The last event up to a time.
fn at_time(reader: &mut Reader, time: Duration) -> Result<u64> {
    let mut at = 0;
    reader.each(1, |_, entry| {
        if Duration::from_nanos(entry.t_ns) > time {
            return ControlFlow::Break(());
        }
        at = entry.sequence;
        ControlFlow::Continue(())
    })?;
    Ok(at)
}
