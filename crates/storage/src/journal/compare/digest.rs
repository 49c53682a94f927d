//! Digests of values. Equal values have equal digests. Defines which parts of a value identify it.

use crate::journal::folder::{ContentHash, JournalError};
use crate::journal::read::Reader;
use crate::journal::record::{Content, Kept, Record, Stored, ValueNumber};
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

/// Computes digests for one run.
#[derive(Debug, Default)]
pub(super) struct Digests {
    known: BTreeMap<ValueNumber, u64>,
}

impl Digests {
    /// Returns the digest of the values of an entry or end, including its error.
    pub(super) fn of(&mut self, reader: &Reader, record: &Record) -> Result<u64, JournalError> {
        let mut hasher = DefaultHasher::new();
        let (values, error) = match record {
            Record::Entered { inputs, .. } => (&inputs[..], None),
            Record::Left { outputs, error, .. } => (&outputs[..], error.as_ref()),
            _ => (&[][..], None),
        };
        for value in values.iter().chain(error) {
            hasher.write_u64(self.of_value(reader, value)?);
        }
        Ok(hasher.finish())
    }

    /// Returns the digest of one value.
    pub(super) fn of_value(&mut self, reader: &Reader, value: &Kept) -> Result<u64, JournalError> {
        let mut hasher = DefaultHasher::new();
        match value {
            Kept::Absent => 0_u8.hash(&mut hasher),
            Kept::None => 1_u8.hash(&mut hasher),
            Kept::Bool(value) => (2_u8, value).hash(&mut hasher),
            Kept::Int(value) => (3_u8, value).hash(&mut hasher),
            Kept::Float(value) => (4_u8, value.to_bits()).hash(&mut hasher),
            Kept::Text(text) => (5_u8, text.as_str()).hash(&mut hasher),
            Kept::Value(number) => {
                if let Some(known) = self.known.get(number) {
                    return Ok(*known);
                }
                let digest = reader.value(*number)?.map_or(0, |stored| of_stored(&stored));
                self.known.insert(*number, digest);
                return Ok(digest);
            }
        }
        Ok(hasher.finish())
    }
}

fn of_stored(stored: &Stored) -> u64 {
    let mut hasher = DefaultHasher::new();
    stored.type_name.hash(&mut hasher);
    match &stored.content {
        Content::View => stored.view.to_string().hash(&mut hasher),
        // A replica may name these bytes by their hash, so both forms need equal digests.
        Content::Pickle(bytes) => ContentHash::of(bytes).name().hash(&mut hasher),
        Content::File { hash, .. } => hash.as_str().hash(&mut hasher),
        // The view of such a value may contain its memory address.
        Content::Nothing(_) => {}
    }
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::of_stored;
    use crate::journal::record::{Content, Stored};

    #[test]
    fn a_value_is_the_same_wherever_its_bytes_lie() {
        let digest = |content| {
            let (view, type_name) = (serde_json::Value::Null, "bytes".into());
            of_stored(&Stored { view, type_name, content })
        };
        let hash = blake3::hash(b"all").to_hex().to_string();
        let [here, elsewhere, other] = [
            Content::Pickle(b"all".to_vec()),
            Content::File { hash, size: 3 },
            Content::Pickle(b"other".to_vec()),
        ]
        .map(digest);
        assert_eq!(here, elsewhere);
        assert_ne!(here, other);
    }
}
