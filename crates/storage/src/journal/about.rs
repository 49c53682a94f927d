//! What a run is, beside its events: one small file that tells it without opening the journal.

use super::error::{Doing, JournalError};
use super::folder::{ABOUT_FILE, replace_file};
use rafcon_protocol::{Keeping, OnCrash};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The newest `run.json` that is understood.
const VERSION: u32 = 1;

/// What a run is: how it was begun. How it goes on stands in its events.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct About {
    /// Version of this description.
    #[serde(default)]
    pub version: u32,
    /// The name of the run's folder.
    pub id: String,
    /// The root state's name.
    pub name: String,
    /// Where the machine lay.
    pub machine: PathBuf,
    /// When it began: ms since 1970, UTC. Times of events count from here.
    pub started_ms: u64,
    /// How much is kept.
    #[serde(default)]
    pub keeping: Keeping,
    /// Whether an event is on disk before the script that follows it runs.
    #[serde(default)]
    pub strict: bool,
    /// States of the machine.
    #[serde(default)]
    pub states: u64,
    /// The program that began it, with its version.
    #[serde(default)]
    pub program: String,
    /// What becomes of interrupted scripts after a crash, if it was chosen.
    #[serde(default)]
    pub on_crash: Option<OnCrash>,
    /// Library roots that were given: name and folder.
    #[serde(default)]
    pub libraries: Vec<(String, PathBuf)>,
    /// The config that was given.
    #[serde(default)]
    pub config: Option<PathBuf>,
    /// The journal's size beyond which old detail is given up, if it was chosen.
    #[serde(default)]
    pub size_max: Option<u64>,
}

impl About {
    /// Writes it into the run's folder; there is always a whole one.
    pub fn write(&self, folder: &Path) -> Result<(), JournalError> {
        let path = folder.join(ABOUT_FILE);
        let about = Self { version: VERSION, ..self.clone() };
        let mut bytes = serde_json::to_vec_pretty(&about)
            .map_err(|error| JournalError::io(&path, Doing::Write, error.into()))?;
        bytes.push(b'\n');
        replace_file(&path, &bytes)
    }

    /// Reads it from the run's folder.
    pub fn read(folder: &Path) -> Result<Self, JournalError> {
        let path = folder.join(ABOUT_FILE);
        let bytes = fs::read(&path).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => {
                JournalError::NoRun { folder: folder.to_owned(), file: ABOUT_FILE }
            }
            _ => JournalError::io(&path, Doing::Read, source),
        })?;
        let damaged = |what: String| JournalError::Damaged { path: path.clone(), what };
        let json: serde_json::Value =
            serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
        let found = json.get("version").and_then(serde_json::Value::as_u64).unwrap_or(0);
        let found = u32::try_from(found).unwrap_or(u32::MAX);
        if found > VERSION {
            return Err(JournalError::Newer { path, found, known: VERSION });
        }
        serde_json::from_value(json).map_err(|error| damaged(error.to_string()))
    }
}
