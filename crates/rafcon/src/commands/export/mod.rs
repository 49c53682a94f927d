//! `rafcon export`: a run in formats of other programs.

mod csv;
mod jsonl;
mod mcap;
mod schemas;
mod states;

use super::history::{Found, each_found};
use super::kept::open;
use crate::cli::{self, ExportFormat};
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::{Context as _, Result};
use rafcon_storage::journal::{Filter, Reader};
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal as _, Write};
use std::path::Path;
use std::process::ExitCode;
use tempfile::NamedTempFile;

/// Writes the run.
pub(super) fn export(raw: &cli::Export, environment: &Environment) -> Result<ExitCode> {
    let mut reader = open(&raw.run, environment)?;
    match &raw.output {
        Some(path) => to_file(&mut reader, raw.format, path)?,
        None => to_output(&mut reader, raw.format)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Under another name at first: a file that is there is whole.
fn to_file(reader: &mut Reader, format: ExportFormat, path: &Path) -> Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or_else(|| Path::new("."));
    if !folder.is_dir() {
        let folder = folder.display();
        let reason = format!("there is no folder {folder}: make it, or name another file");
        return Err(Usage(reason).into());
    }
    let file = NamedTempFile::new_in(folder).with_context(cannot)?;
    match format {
        ExportFormat::Jsonl => lines(reader, file.as_file(), jsonl::line, "")?,
        ExportFormat::Csv => lines(reader, file.as_file(), csv::line, csv::HEAD)?,
        ExportFormat::Mcap => mcap::write(reader, BufWriter::new(file.as_file()), true)?,
    }
    open_to_others(file.as_file()).with_context(cannot)?;
    file.persist(path).with_context(cannot)?;
    Ok(())
}

fn to_output(reader: &mut Reader, format: ExportFormat) -> Result<()> {
    let out = io::stdout().lock();
    match format {
        ExportFormat::Jsonl => lines(reader, out, jsonl::line, ""),
        ExportFormat::Csv => lines(reader, out, csv::line, csv::HEAD),
        ExportFormat::Mcap if io::stdout().is_terminal() => {
            Err(Usage("a recording is no text: name a file with --output".to_owned()).into())
        }
        ExportFormat::Mcap => mcap::write(reader, ::mcap::write::NoSeek::new(out), false),
    }
}

/// Writes one line for each event.
fn lines(
    reader: &mut Reader,
    out: impl Write,
    line: fn(&Found, u64) -> Result<String>,
    head: &str,
) -> Result<()> {
    let started_ms = reader.about().started_ms;
    let mut out = BufWriter::with_capacity(64 * 1024, out);
    out.write_all(head.as_bytes())?;
    each_found(reader, &Filter::default(), None, |found| {
        writeln!(out, "{}", line(found, started_ms)?)?;
        Ok(())
    })?;
    out.flush()?;
    Ok(())
}

/// A temporary file is its owner's alone; this one is as any other that the user makes for others to read.
fn open_to_others(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}
