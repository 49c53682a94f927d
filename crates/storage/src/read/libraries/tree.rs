//! Lists the libraries below the roots, for selection by people. Examines folders and headers, and reads no states.

use super::{Libraries, Root};
use crate::files::{HEADER, YAML_HEADER};
use smol_str::{SmolStr, format_smolstr};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// The maximum depth of listed folders; also ends a loop of links.
const MAX_DEPTH: usize = 32;

/// A folder or library below a root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryEntry {
    /// Name of the folder or root.
    pub name: SmolStr,
    /// The library path of its content (`root/folder`).
    pub path: SmolStr,
    /// Folder of the entry.
    pub dir: PathBuf,
    /// Library, or folder with its entries.
    pub kind: EntryKind,
}

/// The kind of an entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum EntryKind {
    /// A folder with entries, sorted by name.
    Folder(Vec<LibraryEntry>),
    /// A library. Entries below it are not listed.
    Library,
}

impl Libraries {
    /// Returns all roots with the entries below them. Unreadable folders are empty. Names that begin with a dot are omitted.
    pub fn tree(&self) -> Vec<LibraryEntry> {
        self.roots().iter().map(root_entry).collect()
    }
}

fn root_entry(root: &Root) -> LibraryEntry {
    entry(root.name.clone(), root.name.clone(), &root.dir, 0)
}

fn entry(name: SmolStr, path: SmolStr, dir: &Path, depth: usize) -> LibraryEntry {
    let is_library = depth > 0 && (dir.join(HEADER).is_file() || dir.join(YAML_HEADER).is_file());
    let kind = if is_library {
        EntryKind::Library
    } else {
        EntryKind::Folder(inside(&path, dir, depth).unwrap_or_default())
    };
    LibraryEntry { name, path, dir: dir.to_owned(), kind }
}

fn inside(path: &SmolStr, dir: &Path, depth: usize) -> io::Result<Vec<LibraryEntry>> {
    let mut entries = Vec::new();
    if depth >= MAX_DEPTH {
        return Ok(entries);
    }
    for found in fs::read_dir(dir)? {
        let dir = found?.path();
        let name = dir.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if !name.is_empty() && !name.starts_with('.') && dir.is_dir() {
            entries.push(entry(name.into(), format_smolstr!("{path}/{name}"), &dir, depth + 1));
        }
    }
    entries.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(entries)
}
