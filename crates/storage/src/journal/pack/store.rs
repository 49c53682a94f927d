//! Packs in the database: files once by their hash, manifests as changes of earlier ones. Handles tables, not machines.

use super::{Hash, Manifest, Pack};
use crate::journal::folder::JournalError;
use crate::journal::store::Database;
use parking_lot::{Mutex, MutexGuard};
use rusqlite::{Connection, OptionalExtension as _, params};

/// Maximum number of consecutive changes before a manifest is written in full.
const CHANGES_MAX: usize = 32;
/// Maximum size of one write, in bytes, before the lock is released for others.
const TURN_BYTES: usize = 1 << 20;

/// The last stored manifest, which is the base of the next one.
#[derive(Debug, Default)]
pub(in crate::journal) struct Roots {
    last: Option<(Hash, Manifest)>,
    changes: usize,
}

impl Roots {
    /// Stores a pack and returns its hash. Other threads may commit meanwhile.
    pub(in crate::journal) fn keep<O>(
        &mut self,
        pack: &Pack,
        owner: &Mutex<O>,
        database: impl Fn(&mut O) -> &mut Database,
    ) -> Result<Hash, JournalError> {
        let mut files = pack.fresh.iter().peekable();
        while files.peek().is_some() {
            let mut size = 0;
            let turn: Vec<_> = std::iter::from_fn(|| {
                let file = files.next_if(|_| size < TURN_BYTES)?;
                size += file.1.len() + 64;
                Some(file)
            })
            .collect();
            let mut owner = owner.lock();
            database(&mut owner).run(|connection| put_files(connection, &turn))?;
            MutexGuard::unlock_fair(owner);
        }
        let hash = pack.manifest.hash();
        let mut owner = owner.lock();
        let database = database(&mut owner);
        if !database.run(|connection| is_known(connection, hash))? {
            self.put(hash, &pack.manifest, database)?;
        }
        self.last = Some((hash, pack.manifest.clone()));
        Ok(hash)
    }

    fn put(
        &mut self,
        hash: Hash,
        manifest: &Manifest,
        database: &mut Database,
    ) -> Result<(), JournalError> {
        let base = self.last.as_ref().filter(|_| self.changes < CHANGES_MAX);
        let empty = Manifest::default();
        let data = manifest.changes(base.map_or(&empty, |(_, manifest)| manifest));
        let base = base.map(|(hash, _)| hash.0);
        database.run(|connection| {
            let insert = "INSERT INTO roots VALUES (?1, ?2, ?3)";
            connection.execute(insert, params![hash.0, base, data])
        })?;
        self.changes = if base.is_some() { self.changes + 1 } else { 0 };
        Ok(())
    }
}

fn put_files(connection: &mut Connection, files: &[(&Hash, &Vec<u8>)]) -> rusqlite::Result<()> {
    let transaction = connection.transaction()?;
    let mut insert = transaction.prepare("INSERT OR IGNORE INTO files VALUES (?1, ?2)")?;
    for (hash, bytes) in files {
        insert.execute(params![hash.0, bytes])?;
    }
    drop(insert);
    transaction.commit()
}

fn is_known(connection: &Connection, hash: Hash) -> rusqlite::Result<bool> {
    let query = "SELECT 1 FROM roots WHERE hash = ?1";
    Ok(connection.query_row(query, [hash.0], |_| Ok(())).optional()?.is_some())
}

/// Returns the manifest with this hash, if it is stored. `Err` describes damaged tables.
pub(super) fn manifest(
    connection: &Connection,
    hash: Hash,
) -> rusqlite::Result<Result<Option<Manifest>, String>> {
    let mut statement = connection.prepare("SELECT base, data FROM roots WHERE hash = ?1")?;
    let mut changes: Vec<Vec<u8>> = Vec::new();
    let mut next = Some(hash);
    while let Some(hash) = next {
        let row = |row: &rusqlite::Row<'_>| {
            Ok((row.get::<_, Option<[u8; 32]>>(0)?, row.get::<_, Vec<u8>>(1)?))
        };
        let Some((base, data)) = statement.query_row([hash.0], row).optional()? else {
            let missing = format!("the list of files {hash} is missing");
            return Ok(if changes.is_empty() { Ok(None) } else { Err(missing) });
        };
        changes.push(data);
        if changes.len() > CHANGES_MAX + 1 {
            return Ok(Err(format!("the list of files {hash} depends on itself")));
        }
        next = base.map(Hash);
    }
    let manifest = changes.iter().rev().try_fold(Manifest::default(), |manifest, changes| {
        manifest.changed(changes).map_err(|broken| broken.to_string())
    });
    let is_it = |manifest: &Manifest| manifest.hash() == hash;
    let other = || format!("the list of files {hash} has changed");
    Ok(manifest.and_then(|manifest| is_it(&manifest).then_some(Some(manifest)).ok_or_else(other)))
}
