//! A stored machine in memory: its files by folder. Handles tables and files, not machines.

use super::store::manifest;
use super::{Hash, MACHINE, Manifest, library_folder};
use crate::files::{HEADER, MACHINE_LAYOUT, Part};
use crate::journal::folder::JournalError;
use crate::journal::store::Database;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// A machine as stored in a run, with the libraries that it uses.
#[derive(Debug, Default)]
pub struct Packed {
    /// Files by folder: `machine`, or `libraries` and a library path, and the folders of states below.
    folders: BTreeMap<String, Folder>,
}

/// The files of one folder.
#[derive(Debug, Default)]
pub(crate) struct Folder {
    header: Option<Bytes>,
    machine_layout: Option<Bytes>,
    parts: [Option<Bytes>; Part::ALL.len()],
}

/// Equal files share their bytes.
type Bytes = Arc<[u8]>;

impl Packed {
    /// Name of the machine's own folder.
    pub const MACHINE: &str = MACHINE;

    /// Reads the machine with this hash from the run in the folder `run`.
    pub fn read(run: &Path, hash: Hash) -> Result<Self, JournalError> {
        let mut database = Database::open_to_read(run)?;
        let manifest = database.run(|connection| manifest(connection, hash))?;
        let manifest = manifest.map_err(|what| database.damaged(&what))?;
        let manifest = manifest.ok_or_else(|| no_machine(&database, hash))?;
        let contents = contents(&mut database, &manifest)?;
        let mut packed = Self::default();
        for (path, hash) in manifest.files() {
            let Some(Some(bytes)) = contents.get(hash) else {
                return Err(database.damaged(&format!("the file {path} is missing or changed")));
            };
            packed.put(path, bytes);
        }
        Ok(packed)
    }

    /// Returns the folder of a library. `None` if it is not stored.
    pub fn library_folder(&self, path: &str, name: &str) -> Option<String> {
        library_folder(path, name).filter(|folder| self.is_machine(folder))
    }

    fn put(&mut self, path: &str, bytes: &Bytes) {
        let Some((folder, file)) = path.rsplit_once('/') else { return };
        if !self.folders.contains_key(folder) {
            self.folders.insert(folder.to_owned(), Folder::default());
        }
        if let Some(place) = self.folders.get_mut(folder).and_then(|folder| folder.file_mut(file)) {
            *place = Some(Arc::clone(bytes));
        }
    }

    fn is_machine(&self, folder: &str) -> bool {
        self.folders.get(folder).is_some_and(|folder| folder.header.is_some())
    }

    /// Returns a file about the machine in `folder` as a whole.
    pub(crate) fn of_machine(&self, folder: &str, file: &str) -> Option<&[u8]> {
        let folder = self.folders.get(folder)?;
        match file {
            HEADER => folder.header.as_deref(),
            MACHINE_LAYOUT => folder.machine_layout.as_deref(),
            _ => None,
        }
    }

    /// Returns the folders of the states of the machine in `machine`, each after its parent, the root first.
    pub(crate) fn states(&self, machine: &str) -> impl Iterator<Item = (&str, &Folder)> {
        let root = self.folders.get_key_value(machine);
        // `0` is the character after `/`.
        let inside = self.folders.range(format!("{machine}/")..format!("{machine}0"));
        let inside = inside.filter(move |(_, folder)| root.is_some() && folder.header.is_none());
        root.into_iter().chain(inside).map(|(path, folder)| (path.as_str(), folder))
    }
}

impl Folder {
    /// Returns one of the files of a state.
    pub(crate) fn part(&self, part: Part) -> Option<&[u8]> {
        self.parts[part as usize].as_deref()
    }

    fn file_mut(&mut self, file: &str) -> Option<&mut Option<Bytes>> {
        match file {
            HEADER => Some(&mut self.header),
            MACHINE_LAYOUT => Some(&mut self.machine_layout),
            _ => {
                let part = Part::ALL.into_iter().find(|part| part.file_name() == file)?;
                self.parts.get_mut(part as usize)
            }
        }
    }
}

fn no_machine(database: &Database, hash: Hash) -> JournalError {
    JournalError::NoMachine { path: database.path().to_owned(), hash: hash.to_string() }
}

/// Returns the content of every file in the manifest, by hash. `None` for a missing or changed file. Reads all files with one
/// query, because a query for each takes several times as long.
/// a query for each takes several times as long.
fn contents(
    database: &mut Database,
    manifest: &Manifest,
) -> Result<BTreeMap<Hash, Option<Bytes>>, JournalError> {
    let mut contents: BTreeMap<Hash, Option<Bytes>> =
        manifest.files().iter().map(|(_, hash)| (*hash, None)).collect();
    database.run(|connection| {
        let mut statement = connection.prepare("SELECT hash, data FROM files")?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            let Ok(hash) = row.get::<_, [u8; 32]>(0) else { continue };
            if let Some(place) = contents.get_mut(&Hash(hash)) {
                let bytes = row.get_ref(1)?.as_blob().unwrap_or_default();
                *place = (Hash::of(bytes) == Hash(hash)).then(|| bytes.into());
            }
        }
        Ok(())
    })?;
    Ok(contents)
}
