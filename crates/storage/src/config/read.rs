//! Parses the text of a `config.yaml`. Handles keys and defaults, no files.

use super::paths::{Environment, clean_path};
use rafcon_model::{CONFLICT_REMEDY, conflict_line};
use saphyr::{LoadableYamlNode as _, Yaml};
use std::path::{Path, PathBuf};

/// The settings of a `config.yaml`, with the reference's defaults for missing ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Config {
    /// Root name and folder, in the order of the file.
    pub library_paths: Vec<(String, PathBuf)>,
    /// Naming of states' folders.
    pub naming: Naming,
    /// True if a run keeps its history in memory.
    pub in_memory_history: bool,
    /// True if a run writes its history to files.
    pub file_history: bool,
    /// Folder of the history files, if the config names one.
    pub execution_log_path: Option<PathBuf>,
    /// True to compile a script at each entry, instead of once.
    pub recompile_scripts: bool,
    /// Settings that have no effect.
    pub notes: Vec<ConfigNote>,
}

/// Naming of a state's folder (see "folder names" in `docs/format.md`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Naming {
    /// True if the folder's name contains the state's name and id, false for the id alone.
    pub with_name: bool,
    /// Maximum number of characters of the state's name.
    pub max_name_length: Option<usize>,
}

impl Default for Naming {
    fn default() -> Self {
        Self { with_name: true, max_name_length: None }
    }
}

/// An entry of a config that has no effect.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConfigNote {
    /// The file is not YAML and has no effect.
    #[error("the config is not YAML, so defaults apply: {0}; correct the file")]
    Malformed(String),
    /// A value has a wrong type.
    #[error("{key} should be {expected}, so its default applies; correct the file")]
    WrongType {
        /// Key of the value.
        key: String,
        /// Name of the expected type.
        expected: &'static str,
    },
}

impl Default for Config {
    fn default() -> Self {
        Self {
            library_paths: Vec::new(),
            naming: Naming::default(),
            in_memory_history: true,
            file_history: false,
            execution_log_path: None,
            recompile_scripts: true,
            notes: Vec::new(),
        }
    }
}

/// Parses the text of a `config.yaml` in the folder `dir`. Never fails: unreadable entries become notes.
pub fn parse(text: &str, dir: &Path, environment: &Environment<'_>) -> Config {
    let mut reader = ConfigReader { document: Yaml::BadValue, dir, environment, notes: Vec::new() };
    match Yaml::load_from_str(text) {
        Ok(mut documents) if !documents.is_empty() => reader.document = documents.swap_remove(0),
        Ok(_) => {}
        Err(error) => {
            let what = conflict_line(text).map_or_else(
                || error.to_string(),
                |line| format!("conflict markers of a merge in line {line}: {CONFLICT_REMEDY}"),
            );
            reader.notes.push(ConfigNote::Malformed(what));
        }
    }
    reader.config()
}

struct ConfigReader<'r> {
    document: Yaml<'r>,
    dir: &'r Path,
    environment: &'r Environment<'r>,
    notes: Vec<ConfigNote>,
}

impl ConfigReader<'_> {
    fn config(mut self) -> Config {
        Config {
            library_paths: self.library_paths(),
            naming: Naming {
                with_name: self.flag("STORAGE_PATH_WITH_STATE_NAME", true),
                max_name_length: self.length("MAX_LENGTH_FOR_STATE_NAME_IN_STORAGE_PATH"),
            },
            in_memory_history: self.flag("IN_MEMORY_EXECUTION_HISTORY_ENABLE", true),
            file_history: self.flag("FILE_SYSTEM_EXECUTION_HISTORY_ENABLE", false),
            execution_log_path: self.path("EXECUTION_LOG_PATH"),
            recompile_scripts: self.flag("SCRIPT_RECOMPILATION_ON_STATE_EXECUTION", true),
            notes: self.notes,
        }
    }

    fn get(&self, key: &str) -> Option<&Yaml<'_>> {
        self.document.as_mapping_get(key)
    }

    fn wrong(&mut self, key: &str, expected: &'static str) {
        self.notes.push(ConfigNote::WrongType { key: key.to_owned(), expected });
    }

    /// A boolean, or a word that YAML 1.1 accepts as one.
    fn flag(&mut self, key: &str, default: bool) -> bool {
        let Some(value) = self.get(key) else { return default };
        let word = value.as_str().map(str::to_ascii_lowercase);
        let read = value.as_bool().or(match word.as_deref() {
            Some("true" | "yes" | "on") => Some(true),
            Some("false" | "no" | "off") => Some(false),
            _ => None,
        });
        if read.is_none() {
            self.wrong(key, "true or false");
        }
        read.unwrap_or(default)
    }

    fn length(&mut self, key: &str) -> Option<usize> {
        let value = self.get(key)?;
        if value.is_null() || value.as_str() == Some("None") {
            return None;
        }
        let length = value.as_integer().and_then(|number| usize::try_from(number).ok());
        if length.is_none() {
            self.wrong(key, "a number of characters or None");
        }
        length
    }

    /// Returns a path. The reference's placeholder for its own temporary folder counts as no path.
    fn path(&mut self, key: &str) -> Option<PathBuf> {
        let Some(text) = self.get(key)?.as_str() else {
            self.wrong(key, "a path");
            return None;
        };
        let given = !text.is_empty() && !text.starts_with('%');
        given.then(|| clean_path(&relative(text), self.dir, self.environment))
    }

    fn library_paths(&mut self) -> Vec<(String, PathBuf)> {
        let Some(value) = self.get("LIBRARY_PATHS") else { return Vec::new() };
        let Some(mapping) = value.as_mapping() else {
            self.wrong("LIBRARY_PATHS", "a mapping of names to folders");
            return Vec::new();
        };
        let mut paths = Vec::new();
        let mut wrong = Vec::new();
        for (name, dir) in mapping {
            match (name.as_str(), dir.as_str()) {
                (Some(name), Some(dir)) => {
                    let dir = clean_path(&relative(dir), self.dir, self.environment);
                    paths.push((name.to_owned(), dir));
                }
                (name, _) => wrong.push(format!("LIBRARY_PATHS.{}", name.unwrap_or("?"))),
            }
        }
        for key in wrong {
            self.wrong(&key, "a name and a folder");
        }
        paths
    }
}

/// Replaces `$RELATIVE_PATH{x}` by `x` in the config's folder.
fn relative(text: &str) -> String {
    let inside = text.strip_prefix("$RELATIVE_PATH{").and_then(|rest| rest.strip_suffix('}'));
    inside.unwrap_or(text).to_owned()
}
