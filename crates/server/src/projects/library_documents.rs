//! Cache of library documents, limited in bytes.

use super::library::Content;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Capacity of the cache, in bytes. A longer document is sent, but not cached.
const CACHE_BYTES_MAX: usize = 64 << 20;

/// Documents by the folder of their library.
#[derive(Debug, Default)]
pub(super) struct LibraryDocuments {
    by_folder: BTreeMap<PathBuf, Content>,
    bytes: usize,
}

impl LibraryDocuments {
    pub(super) fn get(&self, folder: &Path) -> Option<Content> {
        self.by_folder.get(folder).cloned()
    }

    /// Caches a document. Clears the cache first if it has no room: cleared libraries are parsed again at the next request.
    pub(super) fn insert(&mut self, folder: PathBuf, content: Content) {
        let bytes = content.document.len();
        if bytes > CACHE_BYTES_MAX {
            return;
        }
        if self.bytes + bytes > CACHE_BYTES_MAX {
            *self = Self::default();
        }
        let replaced = self.by_folder.insert(folder, content);
        self.bytes += bytes;
        self.bytes -= replaced.map_or(0, |content| content.document.len());
    }
}

#[cfg(test)]
mod tests {
    use super::{CACHE_BYTES_MAX, Content, LibraryDocuments};
    use std::path::{Path, PathBuf};

    fn content(bytes: usize) -> Content {
        Content { document: vec![b' '; bytes].into(), tag: String::new() }
    }

    #[test]
    fn documents_that_exceed_the_cache_replace_the_older_ones() {
        let mut documents = LibraryDocuments::default();
        documents.insert(PathBuf::from("a"), content(CACHE_BYTES_MAX - 1));
        documents.insert(PathBuf::from("b"), content(1));
        assert!(documents.get(Path::new("a")).is_some() && documents.get(Path::new("b")).is_some());
        documents.insert(PathBuf::from("b"), content(1));
        documents.insert(PathBuf::from("c"), content(1));
        assert!(documents.get(Path::new("a")).is_none() && documents.get(Path::new("c")).is_some());
        documents.insert(PathBuf::from("d"), content(CACHE_BYTES_MAX + 1));
        assert!(documents.get(Path::new("d")).is_none() && documents.get(Path::new("c")).is_some());
    }
}
