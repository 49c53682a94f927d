//! Bytes of a value that a run stores beside its events, named by their hash. Handles files and journals, not the meaning of the
//! bytes.

use crate::journal::folder::ContentHash;
use crate::journal::record::{Content, Stored};
use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt as _;
use std::path::Path;

/// Bytes of a value, for reading in parts.
#[derive(Debug)]
pub struct ValueContent {
    hash: ContentHash,
    length: u64,
    place: ContentPlace,
}

#[derive(Debug)]
enum ContentPlace {
    Memory(Vec<u8>),
    File(File),
}

impl ValueContent {
    /// Opens the bytes of a value of the run in `run`. `None` if the value has no bytes of its own, or if its file is missing.
    pub fn open(run: &Path, stored: Stored) -> Option<Self> {
        match stored.content {
            Content::Pickle(bytes) => {
                let (hash, length) = (ContentHash::of(&bytes), bytes.len() as u64);
                Some(Self { hash, length, place: ContentPlace::Memory(bytes) })
            }
            Content::File { hash, size: length } => {
                let hash = ContentHash::from_name(&hash)?;
                let file = File::open(hash.file_in(run)).ok()?;
                let is_whole = file.metadata().is_ok_and(|file| file.len() == length);
                is_whole.then_some(Self { hash, length, place: ContentPlace::File(file) })
            }
            Content::View | Content::Nothing(_) => None,
        }
    }

    /// Returns the hash of the bytes.
    pub fn hash(&self) -> ContentHash {
        self.hash
    }

    /// Returns the number of bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Reads `bytes_max` bytes from `offset` on, or the bytes up to the end.
    pub fn read(&self, offset: u64, bytes_max: usize) -> io::Result<Vec<u8>> {
        let left = usize::try_from(self.length.saturating_sub(offset)).unwrap_or(usize::MAX);
        let count = left.min(bytes_max);
        match &self.place {
            ContentPlace::Memory(bytes) => {
                let start = usize::try_from(offset).unwrap_or(usize::MAX).min(bytes.len());
                Ok(bytes[start..start + count].to_vec())
            }
            ContentPlace::File(file) => {
                let mut bytes = vec![0; count];
                file.read_exact_at(&mut bytes, offset)?;
                Ok(bytes)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ValueContent;
    use crate::journal::folder::{ContentHash, VALUES_FOLDER};
    use crate::journal::record::{Content, Stored};
    use std::fs;

    #[test]
    fn content_is_read_in_parts_wherever_it_lies() {
        let run = tempfile::tempdir().expect("a folder");
        let bytes: Vec<u8> = (0..=255).collect();
        let hash = ContentHash::of(&bytes);
        let folder = run.path().join(VALUES_FOLDER);
        fs::create_dir(&folder).expect("a folder");
        fs::write(folder.join(hash.name()), &bytes).expect("a file");
        let inline = Content::Pickle(bytes.clone());
        let file = |size| Content::File { hash: hash.name(), size };
        let open = |content| {
            let (view, type_name) = (serde_json::Value::Null, "bytes".into());
            ValueContent::open(run.path(), Stored { view, type_name, content })
        };
        for content in [inline, file(256)] {
            let content = open(content).expect("content");
            assert_eq!((content.hash(), content.length()), (hash, 256));
            let parts = [(0, 100), (100, 100), (200, 100), (256, 9), (999, 9)];
            let read: Vec<_> =
                parts.map(|(at, most)| content.read(at, most).expect("bytes")).concat();
            assert_eq!(read, bytes);
        }
        assert!(open(file(255)).is_none(), "a file that is not whole is none");
        let stranger = Content::File { hash: "../../secret".to_owned(), size: 6 };
        assert!(open(stranger).is_none());
    }
}
