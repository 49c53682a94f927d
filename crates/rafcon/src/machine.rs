//! Loading of machines and libraries, common to all commands. Knows the related options.

use crate::cli;
use crate::environment::variable;
use crate::failure::{Usage, complain};
use anyhow::{Context as _, Result, bail};
use rafcon_storage::{Libraries, Loaded, config, load, roots};
use std::path::{Path, PathBuf};

/// Locations of a machine and its libraries.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    /// Folder of the machine or a file in it.
    pub(crate) machine: PathBuf,
    /// Library roots of the command line.
    pub(crate) libraries: Vec<(String, PathBuf)>,
    /// The config file from the command line.
    pub(crate) config: Option<PathBuf>,
}

impl Source {
    /// Checks the options of the command line.
    pub(crate) fn new(machine: &Path, libraries: &cli::Libraries) -> Result<Self> {
        Ok(Self {
            machine: absolute(machine)?,
            libraries: library_roots(libraries)?,
            config: libraries.config.as_deref().map(absolute).transpose()?,
        })
    }

    /// A machine with the libraries of the configuration.
    pub(crate) fn of(machine: PathBuf) -> Self {
        Self { machine, libraries: Vec::new(), config: None }
    }

    /// Loads the machine; reports problems of the library roots as warnings.
    pub(crate) fn load(&self) -> Result<Loaded> {
        let (config, _file) = config::find(self.config.as_deref(), &variable)?;
        let (roots, notes) = roots(&config, &variable, &self.libraries);
        for note in notes {
            complain(&format!("warning: {note}"));
        }
        for note in config.notes {
            complain(&format!("warning: {note}"));
        }
        self.load_with(&Libraries::new(roots))
    }

    /// Loads the machine without any output.
    pub(crate) fn load_quietly(&self) -> Result<Loaded> {
        let (config, _file) = config::find(self.config.as_deref(), &variable)?;
        let (roots, _notes) = roots(&config, &variable, &self.libraries);
        self.load_with(&Libraries::new(roots))
    }

    fn load_with(&self, libraries: &Libraries) -> Result<Loaded> {
        load(&self.machine, libraries).map_err(Into::into)
    }
}

/// The absolute path, which must be UTF-8 because runners receive it as text.
fn absolute(path: &Path) -> Result<PathBuf> {
    let absolute = std::path::absolute(path)
        .with_context(|| format!("cannot find the path {}", path.display()))?;
    if absolute.to_str().is_none() {
        bail!(
            "the path {} is not UTF-8: rename the folder, or use a link to it",
            absolute.display()
        );
    }
    Ok(absolute)
}

/// The library roots from the options.
pub(crate) fn library_roots(libraries: &cli::Libraries) -> Result<Vec<(String, PathBuf)>> {
    libraries.roots.iter().map(|text| root(text)).collect()
}

fn root(text: &str) -> Result<(String, PathBuf)> {
    match text.split_once('=') {
        Some((name, folder)) if !name.is_empty() && !folder.is_empty() => {
            Ok((name.to_owned(), absolute(Path::new(folder))?))
        }
        _ => Err(Usage(format!(
            "--library-path {text}: write NAME=DIR, such as --library-path generic=/opt/libraries"
        ))
        .into()),
    }
}
