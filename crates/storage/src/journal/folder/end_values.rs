//! Final values of a run, in a separate file if they are long. The `finished` event then contains views of them.

use super::error::{Doing, JournalError};
use super::replace_file;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fs::{self, File};
use std::io::{self, BufReader};
use std::path::Path;

/// Name of the file in the folder of the run.
pub const END_VALUES_FILE: &str = "end-values.json";

/// Final values of a run, encoded as in `docs/protocol.md`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct EndValues {
    /// Outputs of the root, by port name.
    pub outputs: Map<String, Value>,
    /// Final global variables, by name.
    pub globals: Map<String, Value>,
    /// Scoped variables of the root, by name.
    pub scoped_variables: Map<String, Value>,
}

impl EndValues {
    /// Writes the values into the folder of a run, atomically.
    pub fn write(&self, run: &Path) -> Result<(), JournalError> {
        let path = run.join(END_VALUES_FILE);
        let failed = |error: serde_json::Error| JournalError::io(&path, Doing::Write, error.into());
        replace_file(&path, &serde_json::to_vec(self).map_err(failed)?)
    }

    /// Removes the file, because the run continues and its values change.
    pub fn remove(run: &Path) -> Result<(), JournalError> {
        let path = run.join(END_VALUES_FILE);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(JournalError::io(&path, Doing::Remove, error))
            }
            _ => Ok(()),
        }
    }

    /// Reads the values from the folder of a run. `None` if the `finished` event has them all.
    pub fn read(run: &Path) -> Result<Option<Self>, JournalError> {
        let path = run.join(END_VALUES_FILE);
        let failed = |source| JournalError::io(&path, Doing::Read, source);
        match File::open(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(failed(error)),
            Ok(file) => {
                let read = serde_json::from_reader(BufReader::new(file));
                read.map(Some).map_err(|error| failed(error.into()))
            }
        }
    }
}
