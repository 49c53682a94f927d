//! Machines in a journal. Every file of a machine and of its libraries is stored by the hash of its content, so that an edited
//! machine takes only the space of the edit.
//!
//! Handles machines and bytes, not runs.

mod carry;
pub(crate) mod packed;
mod parcel;
mod store;
#[cfg(test)]
mod tests;

pub use packed::Packed;
pub use parcel::Parcel;
pub(super) use store::Roots;

use crate::journal::record::binary::{BinaryReader, BinaryWriter, Broken};
use std::collections::BTreeMap;
use std::fmt;

/// Name of the machine's own folder in a pack.
pub(crate) const MACHINE: &str = "machine";
/// Name of the folder of libraries in a pack. Each library is below its library path.
const LIBRARIES: &str = "libraries";

/// A machine, ready to be stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pack {
    /// Paths and hashes of all files.
    pub manifest: Manifest,
    /// Content of the files that the packer had not packed before.
    pub fresh: BTreeMap<Hash, Vec<u8>>,
}

/// BLAKE3 hash of some bytes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Hash(pub [u8; 32]);

impl Hash {
    /// Computes the hash of these bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self(*blake3::hash(bytes).as_bytes())
    }

    /// Parses a hash in hex.
    pub fn parse(hex: &str) -> Option<Self> {
        blake3::Hash::from_hex(hex).ok().map(|hash| Self(*hash.as_bytes()))
    }
}

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        blake3::Hash::from_bytes(self.0).to_hex().fmt(f)
    }
}

impl fmt::Debug for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Relative path (with `/`) and hash of each file, sorted by path.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Manifest {
    files: Vec<(String, Hash)>,
}

impl Manifest {
    /// Creates the manifest of these files, in any order. Of two files with one path, the first counts.
    pub(crate) fn new(mut files: Vec<(String, Hash)>) -> Self {
        files.sort_by(|a, b| a.0.cmp(&b.0));
        files.dedup_by(|later, first| later.0 == first.0);
        Self { files }
    }

    /// Returns the files, sorted by path.
    pub fn files(&self) -> &[(String, Hash)] {
        &self.files
    }

    /// Computes the hash of all paths and hashes.
    pub fn hash(&self) -> Hash {
        let mut hasher = blake3::Hasher::new();
        for (path, hash) in &self.files {
            hasher.update(path.as_bytes());
            hasher.update(&[0]);
            hasher.update(&hash.0);
        }
        Hash(*hasher.finalize().as_bytes())
    }

    /// Encodes the difference from `base`: new and changed files, then removed paths.
    fn changes(&self, base: &Self) -> Vec<u8> {
        let (mut changed, mut gone) = (Vec::new(), Vec::new());
        let mut before = base.files.iter().peekable();
        for file in &self.files {
            while let Some((path, _)) = before.next_if(|(path, _)| *path < file.0) {
                gone.push(path);
            }
            if before.next_if(|(path, _)| *path == file.0).is_none_or(|old| old != file) {
                changed.push(file);
            }
        }
        gone.extend(before.map(|(path, _)| path));
        let mut bytes = Vec::new();
        let mut writer = BinaryWriter::new(&mut bytes);
        writer.list(&changed, |writer, (path, hash)| {
            writer.text(path);
            writer.bytes(&hash.0);
        });
        writer.list(&gone, |writer, path| writer.text(path));
        bytes
    }

    /// Applies a difference encoded by [`Manifest::changes`].
    fn changed(self, changes: &[u8]) -> Result<Self, Broken> {
        let mut reader = BinaryReader::new(changes);
        let changed = reader.list(|reader| Ok((reader.text()?.to_owned(), reader.hash()?)))?;
        let gone = reader.list(|reader| Ok(reader.text()?.to_owned()))?;
        let mut files = changed;
        let stays = |path: &String| gone.binary_search(path).is_err();
        files.extend(self.files.into_iter().filter(|(path, _)| stays(path)));
        // The changed files come first, and the sort is stable.
        Ok(Self::new(files))
    }
}

impl BinaryReader<'_> {
    fn hash(&mut self) -> Result<Hash, Broken> {
        let bytes = self.bytes()?.try_into();
        bytes.map(Hash).map_err(|_other| self.broken("a hash of another length"))
    }
}

/// Returns the folder of a library in a pack. `None` if its name leads out of any root.
pub(crate) fn library_folder(path: &str, name: &str) -> Option<String> {
    let parts = path.split('/').chain(name.split('/'));
    let is_plain = |part: &str| !part.is_empty() && part != "." && part != "..";
    parts.clone().all(is_plain).then(|| {
        let folder = parts.collect::<Vec<_>>().join("/");
        format!("{LIBRARIES}/{folder}")
    })
}
