//! `rafcon export`: a run in formats of other programs.

use super::kept::open;
use crate::cli::{self, ExportFormat};
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::{Context as _, Result};
use rafcon_storage::journal::{
    Reader, export_csv, export_jsonl, export_mcap, export_mcap_forwards,
};
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal as _};
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
        ExportFormat::Jsonl => export_jsonl(reader, file.as_file())?,
        ExportFormat::Csv => export_csv(reader, file.as_file())?,
        ExportFormat::Mcap => export_mcap(reader, BufWriter::new(file.as_file()))?,
    }
    open_to_others(file.as_file()).with_context(cannot)?;
    file.persist(path).with_context(cannot)?;
    Ok(())
}

fn to_output(reader: &mut Reader, format: ExportFormat) -> Result<()> {
    let out = io::stdout().lock();
    match format {
        ExportFormat::Jsonl => Ok(export_jsonl(reader, out)?),
        ExportFormat::Csv => Ok(export_csv(reader, out)?),
        ExportFormat::Mcap if io::stdout().is_terminal() => {
            Err(Usage("a recording is no text: name a file with --output".to_owned()).into())
        }
        ExportFormat::Mcap => Ok(export_mcap_forwards(reader, out)?),
    }
}

/// A temporary file is its owner's alone; this one is as any other that the user makes for others to read.
fn open_to_others(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}
