//! What the commands that read runs have in common: which run is meant, and how things are written.

use crate::cli;
use crate::environment::Environment;
use crate::runs;
use crate::view::{Paint, time};
use anyhow::{Context as _, Result};
use rafcon_storage::journal::Reader;
use std::io::{self, BufWriter, IsTerminal as _, StdoutLock};
use std::path::Path;
use std::time::Duration;

/// Opens the run that the user means.
pub(super) fn open(raw: &cli::KeptRun, environment: &Environment) -> Result<Reader> {
    open_folder(&runs::find(&raw.runs, environment, &raw.run)?)
}

/// Opens the run in a folder.
pub(super) fn open_folder(folder: &Path) -> Result<Reader> {
    Reader::open(folder).with_context(|| format!("cannot read the run in {}", folder.display()))
}

/// The standard output, for many lines.
pub(super) fn out() -> BufWriter<StdoutLock<'static>> {
    BufWriter::with_capacity(64 * 1024, io::stdout().lock())
}

/// What the standard output can show.
pub(super) fn paint(environment: &Environment) -> Paint {
    let colour = io::stdout().is_terminal() && !environment.no_color;
    Paint { colour, unicode: environment.unicode }
}

/// A length of time in ns, as events count it.
pub(super) fn nanos(length: Duration) -> u64 {
    u64::try_from(length.as_nanos()).unwrap_or(u64::MAX)
}

/// A length of time as people say it: `2.4 ms`, `340 ms`, and from a second on as everywhere.
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
