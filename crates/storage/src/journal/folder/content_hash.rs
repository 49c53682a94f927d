//! Hash that names the bytes of a value, whatever they mean and wherever they are stored.

use super::VALUES_FOLDER;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// BLAKE3 hash of a value's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// Parses a name. `None` if it is not a hash in lower case, and so not the name of a value's file.
    pub fn from_name(name: &str) -> Option<Self> {
        let is_lower = name.bytes().all(|byte| !byte.is_ascii_uppercase());
        let hash = blake3::Hash::from_hex(name).ok().filter(|_| is_lower)?;
        Some(Self(*hash.as_bytes()))
    }

    /// Computes the hash of these bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self(*blake3::hash(bytes).as_bytes())
    }

    /// Computes the hash of everything that the reader yields.
    pub(in crate::journal) fn of_reader(reader: impl io::Read) -> io::Result<Self> {
        Ok(Self(*blake3::Hasher::new().update_reader(reader)?.finalize().as_bytes()))
    }

    /// Returns the 32 bytes of the hash.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// Returns the name of the hash: hex in lower case.
    pub fn name(&self) -> String {
        blake3::Hash::from_bytes(self.0).to_hex().to_string()
    }

    /// Returns the value's file in the folder of a run.
    pub(in crate::journal) fn file_in(&self, run: &Path) -> PathBuf {
        run.join(VALUES_FOLDER).join(self.name())
    }
}

/// Returns true if the folder of a run contains the file of a value of this size.
pub fn is_content_here(run: &Path, hash: &str, size: u64) -> bool {
    let hash = ContentHash::from_name(hash);
    hash.is_some_and(|hash| fs::metadata(hash.file_in(run)).is_ok_and(|file| file.len() == size))
}

#[cfg(test)]
mod tests {
    use super::ContentHash;

    #[test]
    fn only_a_hash_names_a_file() {
        let hash = ContentHash::of(b"all");
        assert_eq!(ContentHash::from_name(&hash.name()), Some(hash));
        let upper = hash.name().to_uppercase();
        for name in ["", "ab", "../run.json", "/etc/passwd", "..", &upper, &"g".repeat(64)] {
            assert_eq!(ContentHash::from_name(name), None, "{name}");
        }
    }
}
