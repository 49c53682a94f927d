//! `users.json`: the roster on disk. A lock serializes changes by the server and by the command line. Knows files and locks;
//! does not know requests.

use super::private::{self, PrivateError};
use super::roster::{Roster, RosterError};
use super::users::UsersError;
use crate::log;
use rafcon_locks::RwLock;
use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::sync::watch;

/// Name of the roster's file.
pub(crate) const FILE: &str = "users.json";

/// The roster on disk, reloaded when its file changes.
#[derive(Debug)]
pub(crate) struct Register {
    file: PathBuf,
    lock: PathBuf,
    read: RwLock<Read>,
    revision: watch::Sender<u64>,
}

/// Content and version of the last load.
#[derive(Debug, Clone, Default)]
struct Read {
    stamp: Stamp,
    roster: Arc<Roster>,
}

/// Version of a file: inode, size and time. `None` if the file does not exist.
type Stamp = Option<(u64, u64, i64, i64)>;

impl Register {
    /// The roster in the server's folder.
    pub(crate) fn open(state: &Path) -> Result<Self, PrivateError> {
        let (file, lock) = (state.join(FILE), state.join("users.lock"));
        let read = RwLock::new(load(&file)?);
        Ok(Self { file, lock, read, revision: watch::Sender::new(0) })
    }

    /// The current roster. It is empty while its file cannot be read, so that nobody is admitted by mistake.
    pub(crate) fn now(&self) -> Arc<Roster> {
        let now = stamp(&self.file);
        let read = self.read.read().clone();
        if read.stamp == now {
            return read.roster;
        }
        self.again(load(&self.file).unwrap_or_else(|broken| {
            log::say(&format!("nobody but the owner can come in: {broken}"));
            Read { stamp: now, ..Read::default() }
        }))
    }

    /// Increments with every loaded or changed roster.
    pub(crate) fn revision(&self) -> &watch::Sender<u64> {
        &self.revision
    }

    /// Changes the roster under the file's lock, so that concurrent programs lose no change.
    pub(crate) fn change<T>(
        &self,
        change: impl FnOnce(&mut Roster) -> Result<T, RosterError>,
    ) -> Result<T, UsersError> {
        let lock = private::open(&self.lock)?;
        lock.lock().map_err(|source| PrivateError::new("lock", &self.lock, source))?;
        let mut roster = Roster::clone(&load(&self.file)?.roster);
        let made = change(&mut roster)?;
        let text = serde_json::to_vec_pretty(&roster).map_err(io::Error::from);
        let text = text.map_err(|source| PrivateError::new("write", &self.file, source))?;
        private::write(&self.file, &text)?;
        self.again(Read { stamp: stamp(&self.file), roster: Arc::new(roster) });
        Ok(made)
    }

    fn again(&self, read: Read) -> Arc<Roster> {
        let roster = Arc::clone(&read.roster);
        *self.read.write() = read;
        self.revision.send_modify(|revision| *revision += 1);
        roster
    }
}

fn load(file: &Path) -> Result<Read, PrivateError> {
    let stamp = stamp(file);
    let Some(text) = private::read(file)? else { return Ok(Read::default()) };
    let roster = serde_json::from_str(&text).map_err(io::Error::from);
    let roster = roster.map_err(|source| PrivateError::new("read", file, source))?;
    Ok(Read { stamp, roster: Arc::new(roster) })
}

fn stamp(file: &Path) -> Stamp {
    let about = fs::metadata(file).ok()?;
    Some((about.ino(), about.size(), about.mtime(), about.mtime_nsec()))
}

#[cfg(test)]
mod tests {
    use super::Register;
    use crate::access::roster::Entry;
    use rafcon_protocol::api::Role;
    use std::thread;

    fn entry() -> Entry {
        Entry { role: Role::Viewer, password: String::new(), since_ms: 1 }
    }

    #[test]
    fn what_another_program_changed_is_seen() {
        let place = tempfile::tempdir().unwrap();
        let (one, other) = (Register::open(place.path()), Register::open(place.path()));
        let (one, other) = (one.unwrap(), other.unwrap());
        let seen = one.revision().subscribe();
        other.change(|roster| roster.add("anna", entry())).unwrap();
        assert_eq!(one.now().users().len(), 1);
        assert!(seen.has_changed().unwrap());
    }

    #[test]
    fn no_change_is_lost_where_many_change() {
        let place = tempfile::tempdir().unwrap();
        let registers = [0, 1, 2].map(|_| Register::open(place.path()).unwrap());
        thread::scope(|scope| {
            for (number, register) in registers.iter().enumerate() {
                let add = move |user: usize| {
                    register.change(|roster| roster.add(&format!("u{number}-{user}"), entry()))
                };
                scope.spawn(move || (0..10).for_each(|user| add(user).unwrap()));
            }
        });
        assert_eq!(registers[0].now().users().len(), 30);
    }

    #[test]
    fn a_file_that_cannot_be_read_lets_nobody_in() {
        let place = tempfile::tempdir().unwrap();
        let register = Register::open(place.path()).unwrap();
        register.change(|roster| roster.add("anna", entry())).unwrap();
        std::fs::write(place.path().join(super::FILE), "{").unwrap();
        assert!(register.now().users().is_empty());
        assert!(register.change(|roster| roster.add("bob", entry())).is_err());
    }
}
