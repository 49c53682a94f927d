//! `rafcon export`: a run in formats of other programs.

use super::kept::open;
use super::kept_at_server::{Keeper, format_query};
use crate::cli::{self, ExportFormat};
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::{Context as _, Result};
use rafcon_protocol::api;
use rafcon_storage::journal::{
    Filter, Reader, export_csv, export_jsonl, export_mcap, export_mcap_forwards,
};
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal as _, Write};
use std::path::Path;
use std::process::ExitCode;
use tempfile::NamedTempFile;

/// Writes the run in the requested format.
pub(super) fn export(raw: &cli::Export, environment: &Environment) -> Result<ExitCode> {
    let run = &raw.run;
    if let Some(keeper) = Keeper::named(&run.remote, &run.runs, environment)? {
        let mut file = keeper.run(&run.run)?.export(&format_query(wire(raw.format)))?;
        let mut copy = |out: &mut dyn Write| -> Result<()> {
            io::copy(&mut file, out).context(
                "the export is incomplete: the journal is damaged, or the connection or the disk failed",
            )?;
            Ok(())
        };
        if let Some(path) = &raw.output {
            to_file(path, |file| copy(&mut &*file))?;
        } else {
            no_terminal(raw.format)?;
            let mut out = io::stdout().lock();
            copy(&mut out)?;
            out.flush()?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    let mut reader = open(run, environment)?;
    match &raw.output {
        Some(path) => to_file(path, |file| write(&mut reader, raw.format, file))?,
        None => to_output(&mut reader, raw.format)?,
    }
    reader.check()?;
    Ok(ExitCode::SUCCESS)
}

/// The format as the server names it.
fn wire(format: ExportFormat) -> api::ExportFormat {
    match format {
        ExportFormat::Jsonl => api::ExportFormat::Jsonl,
        ExportFormat::Csv => api::ExportFormat::Csv,
        ExportFormat::Mcap => api::ExportFormat::Mcap,
    }
}

/// Writes to a temporary file first, so that an existing file is always complete.
fn to_file(path: &Path, write: impl FnOnce(&File) -> Result<()>) -> Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or_else(|| Path::new("."));
    if !folder.is_dir() {
        let folder = folder.display();
        let reason = format!("the folder {folder} does not exist: create it, or name another file");
        return Err(Usage(reason).into());
    }
    let file = NamedTempFile::new_in(folder).with_context(cannot)?;
    write(file.as_file())?;
    open_to_others(file.as_file()).with_context(cannot)?;
    file.persist(path).with_context(cannot)?;
    Ok(())
}

fn write(reader: &mut Reader, format: ExportFormat, file: &File) -> Result<()> {
    let all = Filter::default();
    match format {
        ExportFormat::Jsonl => Ok(export_jsonl(reader, &all, file)?),
        ExportFormat::Csv => Ok(export_csv(reader, &all, file)?),
        ExportFormat::Mcap => Ok(export_mcap(reader, BufWriter::new(file))?),
    }
}

fn to_output(reader: &mut Reader, format: ExportFormat) -> Result<()> {
    no_terminal(format)?;
    let (out, all) = (io::stdout().lock(), Filter::default());
    match format {
        ExportFormat::Jsonl => Ok(export_jsonl(reader, &all, out)?),
        ExportFormat::Csv => Ok(export_csv(reader, &all, out)?),
        ExportFormat::Mcap => Ok(export_mcap_forwards(reader, out)?),
    }
}

fn no_terminal(format: ExportFormat) -> Result<()> {
    if format == ExportFormat::Mcap && io::stdout().is_terminal() {
        return Err(Usage("a recording is binary: name a file with --output".to_owned()).into());
    }
    Ok(())
}

/// Gives a temporary file, which only its owner can read, the usual permissions of new files.
fn open_to_others(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}
