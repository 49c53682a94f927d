//! Large values of runs, for stations that ask for them.

use crate::ids;
use rafcon_link::ValueName;
use rafcon_storage::journal::{Reader, ValueContent, ValueNumber};
use std::collections::BTreeMap;
use std::path::Path;

/// Limit of open values.
const OPEN_MAX: usize = 8;

/// The values that are open.
#[derive(Debug, Default)]
pub(super) struct RobotValues {
    open: BTreeMap<ValueName, ValueContent>,
}

impl RobotValues {
    /// Length of a value of the run in this folder. `None` if it is missing or has another hash.
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

    /// Reads bytes of a value. `None` if they cannot be read.
    pub(super) fn bytes(
        &mut self,
        folder: &Path,
        name: &ValueName,
        offset: u64,
        bytes_max: usize,
    ) -> Option<Vec<u8>> {
        self.length(folder, name)?;
        self.open.get(name)?.read(offset, bytes_max).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::{OPEN_MAX, RobotValues};
    use crate::ids;
    use rafcon_link::{StreamId, ValueName};
    use rafcon_storage::journal::record::Content;
    use rafcon_storage::journal::{
        About, Batch, ContentHash, Definition, Journal, Options, Record, Stored, ValueNumber,
    };

    #[test]
    fn a_value_that_was_closed_for_others_is_opened_again() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("r");
        let journal = Journal::create(&run, &About::default(), &Options::default()).unwrap();
        let pickle = |number: u64| vec![7; usize::try_from(number).unwrap()];
        let count = OPEN_MAX as u64 + 1;
        let mut batch = Batch::new(0);
        for number in 1..=count {
            let (view, type_name) = (serde_json::Value::Null, "list".into());
            let stored = Stored { view, type_name, content: Content::Pickle(pickle(number)) };
            batch.define(&Definition::Value(ValueNumber(number), stored));
        }
        batch.record(1, &Record::Told(Box::new(rafcon_protocol::Event::Stopping)));
        journal.append(&batch).unwrap();
        journal.close().unwrap();
        let mut values = RobotValues::default();
        for number in (1..=count).chain([1]) {
            let id = ids::value_id(ContentHash::of(&pickle(number)));
            let name = ValueName { stream: StreamId(1), number, id };
            assert_eq!(values.bytes(&run, &name, 0, 99), Some(pickle(number)));
            assert!(values.open.len() <= OPEN_MAX, "{}", values.open.len());
        }
        assert_eq!(values.open.len(), OPEN_MAX);
    }
}
