//! The description of a run: one small file that can be read without opening the journal.

use super::error::{Doing, JournalError};
use super::{ABOUT_FILE, replace_file};
use rafcon_protocol::{Beginning, Keeping, OnCrash};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The newest known version of `run.json`.
const VERSION: u32 = 2;
/// The version without a checksum.
const UNCHECKED: u64 = 1;
/// The name of the checksum.
const SUM: &str = "sum";

/// The description of a run: how it was started.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct About {
    /// Version of this description.
    #[serde(default)]
    pub version: u32,
    /// The name of the run's folder.
    pub id: String,
    /// The root state's name.
    pub name: String,
    /// The folder of the machine.
    pub machine: PathBuf,
    /// When it began: ms since 1970, UTC. Times of events count from here.
    pub started_ms: u64,
    /// How much the journal keeps.
    #[serde(default)]
    pub keeping: Keeping,
    /// Whether an event is on disk before the script that follows it runs.
    #[serde(default)]
    pub strict: bool,
    /// The number of states of the machine.
    #[serde(default)]
    pub states: u64,
    /// The program that started it, with its version.
    #[serde(default)]
    pub program: String,
    /// The policy for interrupted scripts after a crash, if one was chosen.
    #[serde(default)]
    pub on_crash: Option<OnCrash>,
    /// The given library roots: name and folder.
    #[serde(default)]
    pub libraries: Vec<(String, PathBuf)>,
    /// The given config.
    #[serde(default)]
    pub config: Option<PathBuf>,
    /// The size of the journal beyond which old detail is dropped, if one was chosen.
    #[serde(default)]
    pub size_max: Option<u64>,
    /// The folders from which files may be loaded; `None` means anywhere.
    #[serde(default)]
    pub homes: Option<Vec<PathBuf>>,
    /// The robot that runs it, if this is a replica. No runner may resume it here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// How to enter its first state, for a run that died before it did.
    #[serde(default)]
    pub beginning: Beginning,
}

impl About {
    /// Writes it into the run's folder, atomically.
    pub fn write(&self, folder: &Path) -> Result<(), JournalError> {
        let path = folder.join(ABOUT_FILE);
        let failed = |error: serde_json::Error| JournalError::io(&path, Doing::Write, error.into());
        let about = Self { version: VERSION, ..self.clone() };
        let mut json = serde_json::to_value(&about).map_err(failed)?;
        json[SUM] = sum(&json).into();
        let mut bytes = serde_json::to_vec_pretty(&json).map_err(failed)?;
        bytes.push(b'\n');
        replace_file(&path, &bytes)
    }

    /// Reads it from the run's folder.
    pub fn read(folder: &Path) -> Result<Self, JournalError> {
        serde_json::from_value(Self::json(folder)?).map_err(|error| JournalError::Damaged {
            path: folder.join(ABOUT_FILE),
            what: error.to_string(),
        })
    }

    /// Reads it as JSON, in which members may be missing.
    pub fn json(folder: &Path) -> Result<Value, JournalError> {
        let path = folder.join(ABOUT_FILE);
        let bytes = fs::read(&path).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => {
                JournalError::NoRun { folder: folder.to_owned(), file: ABOUT_FILE }
            }
            _ => JournalError::io(&path, Doing::Read, source),
        })?;
        let damaged = |what: String| JournalError::Damaged { path: path.clone(), what };
        let json: Value =
            serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
        let found = json.get("version").and_then(Value::as_u64).unwrap_or(0);
        if found > u64::from(VERSION) {
            let found = u32::try_from(found).unwrap_or(u32::MAX);
            return Err(JournalError::Newer { path, found, known: VERSION });
        }
        match json.get(SUM) {
            Some(said) if *said == sum(&json) => Ok(json),
            None if found <= UNCHECKED => Ok(json),
            _ => Err(damaged("its content does not match its checksum".to_owned())),
        }
    }
}

/// The checksum of all members but itself, in the order of their names.
fn sum(json: &Value) -> String {
    let members = json.as_object().into_iter().flatten().filter(|(name, _)| *name != SUM);
    let members: BTreeMap<&String, &Value> = members.collect();
    let bytes = serde_json::to_vec(&members).unwrap_or_default();
    format!("{:08x}", crc32fast::hash(&bytes))
}
