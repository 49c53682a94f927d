//! Finds and reads the reference's `config.yaml`. Handles its keys, its default locations and its form of paths. Never writes the
//! file, and never reads the environment itself.

mod paths;
mod read;
#[cfg(test)]
mod tests;

pub use paths::{Environment, clean_path};
pub use read::{Config, ConfigNote, Naming, parse};

use std::path::{Path, PathBuf};
use std::{fs, io};

/// Name of the config file.
const FILE: &str = "config.yaml";

/// A config file that the user named cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read the config {}", path.display())]
pub struct ConfigError {
    /// Path of the config file.
    pub path: PathBuf,
    /// Error reported by the system.
    pub source: io::Error,
}

/// Reads the config file `given` (or `config.yaml` in the folder `given`), or else `~/.config/rafcon/config.yaml`. Without a file,
/// returns defaults. The second value is the path of the file that was read.
pub fn find(
    given: Option<&Path>,
    environment: &Environment<'_>,
) -> Result<(Config, Option<PathBuf>), ConfigError> {
    let Some(path) = given.map(file_in).or_else(|| usual(environment)) else {
        return Ok((Config::default(), None));
    };
    match fs::read_to_string(&path) {
        Ok(text) => {
            let dir = path.parent().unwrap_or(Path::new(""));
            Ok((parse(&text, dir, environment), Some(path)))
        }
        Err(error) if given.is_none() && error.kind() == io::ErrorKind::NotFound => {
            Ok((Config::default(), None))
        }
        Err(source) => Err(ConfigError { path, source }),
    }
}

fn file_in(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(FILE) } else { path.to_owned() }
}

fn usual(environment: &Environment<'_>) -> Option<PathBuf> {
    Some(PathBuf::from(environment("HOME")?).join(".config/rafcon").join(FILE))
}
