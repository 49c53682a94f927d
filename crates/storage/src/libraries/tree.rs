//! What lies below a library root, for people who choose one. Knows folders and headers, reads no states.

use super::lookup::Libraries;
use super::roots::Root;
use crate::files::{HEADER, YAML_HEADER};
use smol_str::{SmolStr, format_smolstr};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Deeper folders are not listed; a loop of links ends here.
const MAX_DEPTH: usize = 32;

/// A folder or library below a root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The folder's name, or the root's.
    pub name: SmolStr,
    /// The library path of what lies in it (`root/folder`).
    pub path: SmolStr,
    /// Where it is.
    pub dir: PathBuf,
    /// Which of the two.
    pub kind: EntryKind,
}

/// What an entry is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum EntryKind {
    /// A folder of others, sorted by name.
    Folder(Vec<Entry>),
    /// A machine to be used as a library; nothing below it is listed.
    Library,
}

impl Libraries {
    /// All roots with what lies below them. Folders that cannot be read are empty; names that begin with a dot are left
    /// out.
    pub fn tree(&self) -> Vec<Entry> {
        self.roots().iter().map(root_entry).collect()
    }
}

fn root_entry(root: &Root) -> Entry {
    entry(root.name.clone(), root.name.clone(), &root.dir, 0)
}

fn entry(name: SmolStr, path: SmolStr, dir: &Path, depth: usize) -> Entry {
    let is_library = depth > 0 && (dir.join(HEADER).is_file() || dir.join(YAML_HEADER).is_file());
    let kind = if is_library {
        EntryKind::Library
    } else {
        EntryKind::Folder(inside(&path, dir, depth).unwrap_or_default())
    };
    Entry { name, path, dir: dir.to_owned(), kind }
}

fn inside(path: &SmolStr, dir: &Path, depth: usize) -> io::Result<Vec<Entry>> {
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
