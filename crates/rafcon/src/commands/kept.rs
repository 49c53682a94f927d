//! Shared parts of the commands for recorded runs: their location, their selection, and their output.

use crate::cli;
use crate::environment::Environment;
use crate::failure::{Usage, complain};
use crate::view::{Paint, time};
use anyhow::{Context as _, Result};
use rafcon_storage::journal::Reader;
use rafcon_supervisor::{FindError, Runs};
use std::io::{self, BufWriter, IsTerminal as _, StdoutLock};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The folder of all runs: from the user, or the default.
pub(super) fn runs_folder(named: &cli::Runs, environment: &Environment) -> Result<Runs> {
    Ok(Runs::new(named.runs.as_deref(), &environment.locations)?)
}

/// The folder of the selected run.
pub(super) fn find_run(
    named: &cli::Runs,
    environment: &Environment,
    text: &str,
) -> Result<PathBuf> {
    find_run_in(&runs_folder(named, environment)?, text)
}

/// The folder of the selected run, in a known folder of runs.
pub(super) fn find_run_in(runs: &Runs, text: &str) -> Result<PathBuf> {
    runs.find(text).map_err(|error| match error {
        FindError::None { .. } | FindError::Many { .. } => Usage(error.to_string()).into(),
        FindError::Here(_) | FindError::Read { .. } => error.into(),
    })
}

/// Makes the folder of a new run, and deletes old ones. A failed deletion does not block the run.
pub(super) fn make_run(runs: &Runs, machine: &str) -> Result<PathBuf> {
    if let Err(error) = runs.give_up_old_ones() {
        complain(&format!("warning: old runs could not be deleted: {error}"));
    }
    Ok(runs.make(machine)?)
}

/// The id of the run in this folder.
pub(super) fn run_id(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Opens the selected run.
pub(super) fn open(raw: &cli::KeptRun, environment: &Environment) -> Result<Reader> {
    open_folder(&find_run(&raw.runs, environment, &raw.run)?)
}

/// Opens the run in a folder.
pub(super) fn open_folder(folder: &Path) -> Result<Reader> {
    Reader::open(folder).with_context(|| format!("cannot read the run in {}", folder.display()))
}

/// The standard output with a buffer for many lines.
pub(super) fn out() -> BufWriter<StdoutLock<'static>> {
    BufWriter::with_capacity(64 * 1024, io::stdout().lock())
}

/// Capabilities of the standard output.
pub(super) fn paint(environment: &Environment) -> Paint {
    let colour = io::stdout().is_terminal() && !environment.no_color;
    Paint { colour, unicode: environment.unicode }
}

/// A duration in ns, as in events.
pub(super) fn nanos(length: Duration) -> u64 {
    u64::try_from(length.as_nanos()).unwrap_or(u64::MAX)
}

/// A duration for people: `2.4 ms`, `340 ms`, and from a second on as in [`time`].
pub(super) fn span(length: Duration) -> String {
    match length.as_secs_f64() * 1e3 {
        ms if ms < 9.95 => format!("{ms:.1} ms"),
        ms if ms < 999.5 => format!("{ms:.0} ms"),
        _ => time(length),
    }
}

#[cfg(test)]
mod tests {
    use super::span;
    use std::time::Duration;

    #[test]
    fn short_times_are_told_in_milliseconds() {
        let spans = [0, 2_400, 12_300, 999_400, 1_000_000].map(Duration::from_micros).map(span);
        assert_eq!(spans, ["0.0 ms", "2.4 ms", "12 ms", "999 ms", "1.0 s"]);
    }
}
