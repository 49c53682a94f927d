//! `rafcon new`: a machine from a template.

use crate::cli;
use crate::clock;
use crate::templates::{self, TemplateRequest};
use crate::view::counted;
use anyhow::{Context as _, Result, bail};
use rafcon_model::{Header, Machine};
use rafcon_storage::{Naming, save};
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Makes the machine. A folder with content is refused.
pub(super) fn new(raw: &cli::New) -> Result<ExitCode> {
    let template = templates::find(&raw.template)
        .with_context(|| format!("there is no template `{}`", raw.template))?;
    let name = raw.path.file_name().and_then(|name| name.to_str());
    let name = name.with_context(|| {
        format!("{} does not end in a name: name the folder to create", raw.path.display())
    })?;
    check_free(&raw.path)?;
    let root = template.root(&TemplateRequest { name: name.to_owned(), states: raw.states })?;
    let header = Header { creation_time: clock::utc().into(), ..Header::default() };
    let machine = Machine { header, root: Arc::new(root) };
    save(&machine, &raw.path, None, Naming::default())?;
    let path = raw.path.display();
    let states = counted(machine.count() as u64, "state");
    let roots = template.libraries.iter();
    let roots = roots.map(|(root, at)| format!(" --library-path {root}={at}"));
    let roots: String = roots.collect();
    writeln!(
        io::stdout(),
        "created {name} with {states} in {path}; run it: rafcon run {path}{roots}"
    )?;
    Ok(ExitCode::SUCCESS)
}

/// Refuses a folder with content.
pub(super) fn check_free(path: &Path) -> Result<()> {
    let entries = match std::fs::read_dir(path) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => {
            return Err(error)
                .with_context(|| format!("cannot create a machine in {}", path.display()));
        }
    };
    if entries.count() > 0 {
        bail!("{} exists and is not empty: choose another folder, or remove it", path.display());
    }
    Ok(())
}
