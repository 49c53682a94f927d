//! What the commands that read runs have in common: which run is meant, and how things are written.

use crate::cli;
use crate::environment::Environment;
use crate::runs::Runs;
use crate::view::Paint;
use anyhow::{Context as _, Result};
use rafcon_storage::journal::Reader;
use std::io::{self, BufWriter, IsTerminal as _, StdoutLock};
use std::path::Path;

/// Opens the run that the user means.
pub(super) fn open(raw: &cli::KeptRun, environment: &Environment) -> Result<Reader> {
    open_folder(&Runs::new(&raw.runs, environment)?.find(&raw.run)?)
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
