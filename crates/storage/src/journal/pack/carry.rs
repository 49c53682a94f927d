//! Transfer of packs from one journal to another. Handles tables and bytes, not machines.

use super::store::manifest;
use super::{Hash, Manifest, Pack};
use crate::journal::folder::JournalError;
use crate::journal::record::binary::{BinaryReader, BinaryWriter, Broken};
use crate::journal::store::Database;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

impl Pack {
    /// Returns the machines that the run in this folder has stored, in their order, without the first `known` ones. Each contains
    /// only files that its predecessors do not have.
    /// files that those before it do not have.
    pub fn read_after(run: &Path, known: usize) -> Result<Vec<Self>, JournalError> {
        let mut database = Database::open_to_read(run)?;
        let (mut packs, mut sent) = (Vec::new(), BTreeSet::new());
        let roots = roots(&mut database)?;
        if roots.len() <= known {
            return Ok(packs);
        }
        for (nth, hash) in roots.into_iter().enumerate() {
            let manifest = database.run(|connection| manifest(connection, hash))?;
            let manifest = manifest.map_err(|what| database.damaged(&what))?.unwrap_or_default();
            let new = manifest.files().iter().map(|(_, hash)| *hash);
            let new: BTreeSet<Hash> = new.filter(|hash| sent.insert(*hash)).collect();
            if nth >= known {
                let fresh = files(&mut database, &new)?;
                packs.push(Self { manifest, fresh });
            }
        }
        Ok(packs)
    }

    /// Encodes the pack as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = BinaryWriter::new(&mut bytes);
        writer.list(self.manifest.files(), |writer, (path, hash)| {
            writer.text(path);
            writer.bytes(&hash.0);
        });
        let fresh: Vec<_> = self.fresh.values().collect();
        writer.list(&fresh, |writer, content| writer.bytes(content));
        bytes
    }

    /// Decodes the bytes of [`Pack::to_bytes`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Broken> {
        let mut reader = BinaryReader::new(bytes);
        let files = reader.list(|reader| Ok((reader.text()?.to_owned(), reader.hash()?)))?;
        let fresh = reader.list(|reader| Ok(reader.bytes()?.to_vec()))?;
        let fresh = fresh.into_iter().map(|content| (Hash::of(&content), content)).collect();
        Ok(Self { manifest: Manifest::new(files), fresh })
    }
}

fn roots(database: &mut Database) -> Result<Vec<Hash>, JournalError> {
    database.run(|connection| {
        let mut statement = connection.prepare("SELECT hash FROM roots ORDER BY rowid")?;
        let rows = statement.query_map([], |row| row.get::<_, [u8; 32]>(0))?;
        rows.map(|hash| hash.map(Hash)).collect()
    })
}

fn files(
    database: &mut Database,
    wanted: &BTreeSet<Hash>,
) -> Result<BTreeMap<Hash, Vec<u8>>, JournalError> {
    database.run(|connection| {
        let mut statement = connection.prepare("SELECT data FROM files WHERE hash = ?1")?;
        let read = |hash: &Hash| Ok((*hash, statement.query_row([hash.0], |row| row.get(0))?));
        wanted.iter().map(read).collect()
    })
}
