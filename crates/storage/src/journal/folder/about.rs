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

/// Newest supported version of `run.json`.
const VERSION: u32 = 2;
/// Version without a checksum.
const UNCHECKED: u64 = 1;
/// Name of the checksum.
const SUM: &str = "sum";

/// Description of a run and of its start.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct About {
    /// Version of this description.
    #[serde(default)]
    pub version: u32,
    /// Name of the run's folder.
    pub id: String,
    /// Name of the root state.
    pub name: String,
    /// Folder of the machine.
    pub machine: PathBuf,
    /// Start time: ms since 1970, UTC. Times of events count from here.
    pub started_ms: u64,
    /// Amount of the run that the journal records.
    #[serde(default)]
    pub keeping: Keeping,
    /// True if each event is on disk before the script that follows it runs.
    #[serde(default)]
    pub strict: bool,
    /// Number of states in the machine.
    #[serde(default)]
    pub states: u64,
    /// Program that started the run, with its version.
    #[serde(default)]
    pub program: String,
    /// Policy for interrupted scripts after a crash, if one was chosen.
    #[serde(default)]
    pub on_crash: Option<OnCrash>,
    /// Library roots given at the start: name and folder.
    #[serde(default)]
    pub libraries: Vec<(String, PathBuf)>,
    /// Config given at the start.
    #[serde(default)]
    pub config: Option<PathBuf>,
    /// Size of the journal above which old detail is deleted, if one was chosen.
    #[serde(default)]
    pub size_max: Option<u64>,
    /// Folders from which files may be loaded. `None` for no restriction.
    #[serde(default)]
    pub homes: Option<Vec<PathBuf>>,
    /// Robot that executes the run, if this is a replica. No runner may resume it here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Settings for entering the first state, for a run that died before that.
    #[serde(default)]
    pub beginning: Beginning,
}

impl About {
    /// Writes the description into the run's folder, atomically.
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

    /// Reads the description from the run's folder.
    pub fn read(folder: &Path) -> Result<Self, JournalError> {
        serde_json::from_value(Self::json(folder)?).map_err(|error| JournalError::Damaged {
            path: folder.join(ABOUT_FILE),
            what: error.to_string(),
        })
    }

    /// Reads the description as JSON, which may lack members.
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

/// Returns the checksum of all members but itself, in the order of their names.
fn sum(json: &Value) -> String {
    let members = json.as_object().into_iter().flatten().filter(|(name, _)| *name != SUM);
    let members: BTreeMap<&String, &Value> = members.collect();
    let bytes = serde_json::to_vec(&members).unwrap_or_default();
    format!("{:08x}", crc32fast::hash(&bytes))
}
