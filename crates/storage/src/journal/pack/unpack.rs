//! From the database back to folders that can be loaded. Knows tables and files, no machines.

use super::manifest::{Hash, Manifest};
use super::packer::{LIBRARIES, MACHINE};
use super::store::manifest;
use crate::Root;
use crate::journal::database::Database;
use crate::journal::error::{Doing, JournalError};
use rusqlite::OptionalExtension as _;
use smol_str::SmolStr;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Where a machine lies that was unpacked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unpacked {
    /// The folder to be loaded.
    pub machine: PathBuf,
    /// The library roots to load it with, and no others.
    pub roots: Vec<Root>,
}

/// Writes the machine with this hash, as the run in the folder `run` kept it, into the folder `into`.
pub fn unpack(run: &Path, hash: Hash, into: &Path) -> Result<Unpacked, JournalError> {
    let mut database = Database::open_to_read(run)?;
    let manifest = database.run(|connection| manifest(connection, hash))?;
    let manifest = manifest.map_err(|what| database.damaged(&what))?;
    let manifest = manifest.ok_or_else(|| database.no_machine(hash))?;
    for (path, hash) in manifest.files() {
        let bytes = file(&mut database, path, *hash)?;
        write(&into.join(path), &bytes)?;
    }
    Ok(Unpacked { machine: into.join(MACHINE), roots: roots(&manifest, into) })
}

fn file(database: &mut Database, path: &str, hash: Hash) -> Result<Vec<u8>, JournalError> {
    let is_inside = |part| matches!(part, Component::Normal(_));
    if !Path::new(path).components().all(is_inside) {
        return Err(database.damaged(&format!("the path {path} leads out of its folder")));
    }
    let query = "SELECT data FROM files WHERE hash = ?1";
    let bytes: Option<Vec<u8>> = database
        .run(|connection| connection.query_row(query, [hash.0], |row| row.get(0)).optional())?;
    let bytes = bytes.filter(|bytes| Hash::of(bytes) == hash);
    bytes.ok_or_else(|| database.damaged(&format!("the file {path} is missing or changed")))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), JournalError> {
    let write = || {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(path, bytes)
    };
    write().map_err(|source| JournalError::io(path, Doing::Write, source))
}

/// The folders below that of the libraries.
fn roots(manifest: &Manifest, into: &Path) -> Vec<Root> {
    let root = |(path, _): &(String, Hash)| {
        let inside = path.strip_prefix(LIBRARIES)?.strip_prefix('/')?;
        inside.split_once('/').map(|(name, _)| SmolStr::new(name))
    };
    let names: BTreeSet<SmolStr> = manifest.files().iter().filter_map(root).collect();
    let root = |name: SmolStr| Root { dir: into.join(LIBRARIES).join(&name), name };
    names.into_iter().map(root).collect()
}
