//! Large values of runs, for stations that ask for them.

use crate::ids;
use rafcon_link::ValueName;
use rafcon_storage::journal::{Reader, ValueContent, ValueNumber};
use std::collections::BTreeMap;
use std::path::Path;

/// So many are open at a time.
const OPEN_MAX: usize = 8;

/// The values that are open.
#[derive(Debug, Default)]
pub(super) struct RobotValues {
    open: BTreeMap<ValueName, ValueContent>,
}

impl RobotValues {
    /// The length of a value of the run in this folder; nothing if it has another hash, or is not there.
    pub(super) fn length(&mut self, folder: &Path, name: &ValueName) -> Option<u64> {
        if !self.open.contains_key(name) {
            let reader = Reader::open(folder).ok()?;
            let stored = reader.value(ValueNumber(name.number)).ok()??;
            let content = ValueContent::open(folder, stored)?;
            if ids::value_id(content.hash()) != name.id {
                return None;
            }
            if self.open.len() >= OPEN_MAX {
                self.open.pop_first();
            }
            self.open.insert(*name, content);
        }
        self.open.get(name).map(ValueContent::length)
    }

    /// Bytes of a value; nothing if they cannot be read.
    pub(super) fn bytes(
        &mut self,
        folder: &Path,
        name: &ValueName,
        (offset, bytes_max): (u64, usize),
    ) -> Option<Vec<u8>> {
        self.length(folder, name)?;
        self.open.get(name)?.read(offset, bytes_max).ok()
    }
}
