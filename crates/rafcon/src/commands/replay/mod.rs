//! `rafcon replay`: the state of a run at one of its events.

mod tree;

use super::kept::{nanos, open, out, paint};
use super::kept_at_server::Keeper;
use crate::cli;
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::Result;
use rafcon_protocol::api::Moment;
use rafcon_storage::journal::DAMAGED;
use std::io::Write as _;
use std::process::ExitCode;

/// Prints the selected moment.
pub(super) fn replay(raw: &cli::Replay, environment: &Environment) -> Result<ExitCode> {
    let run = &raw.run;
    if let Some(keeper) = Keeper::named(&run.remote, &run.runs, environment)? {
        let kept = keeper.run(&run.run)?;
        let (picture, last) = kept.moment(raw.at, raw.time)?;
        print(raw, &kept.summary.name, &picture, last, environment)?;
        let is_damaged = serde_json::to_string(&picture)?.contains(DAMAGED);
        return if is_damaged {
            Err(kept.damaged("some values cannot be read"))
        } else {
            Ok(ExitCode::SUCCESS)
        };
    }
    let mut reader = open(run, environment)?;
    let last = reader.last_sequence()?;
    let sequence = match (raw.at, raw.time) {
        (Some(at), _) if at > last => {
            return Err(
                Usage(format!("event {at} does not exist yet; the last event is {last}")).into()
            );
        }
        (Some(at), _) => at,
        (None, Some(time)) => reader.first_at(nanos(time).saturating_add(1))? - 1,
        (None, None) => last,
    };
    let moment = reader.moment(sequence)?;
    let picture = reader.picture(&moment)?;
    print(raw, &reader.about().name, &picture, last, environment)?;
    reader.check()?;
    Ok(ExitCode::SUCCESS)
}

fn print(
    raw: &cli::Replay,
    machine: &str,
    picture: &Moment,
    last: u64,
    environment: &Environment,
) -> Result<()> {
    let mut out = out();
    if raw.json {
        writeln!(out, "{}", serde_json::to_string(picture)?)?;
    } else {
        for line in tree::lines(machine, picture, last) {
            writeln!(out, "{}", line.render(paint(environment)))?;
        }
    }
    Ok(out.flush()?)
}
