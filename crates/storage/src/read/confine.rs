//! Whether a machine's files lie where they may be read: for those who load for others. Knows links and kinds of files, not
//! what is in them.
//!
//! A link that is put there between the look and the load is not seen: whoever can do that writes where the machine lies.

use super::load::LoadError;
use crate::files::{HEADER, MACHINE_LAYOUT, Part, STAGING, YAML_HEADER};
use std::collections::BTreeSet;
use std::fs::{self, DirEntry, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// Larger files are not read.
const BYTES_MAX: u64 = 64 << 20;

/// A look at every folder that a load would read.
struct Look<'h> {
    homes: &'h [PathBuf],
    waiting: Vec<PathBuf>,
    seen: BTreeSet<PathBuf>,
}

/// Refuses a machine of which a part lies in none of these folders, or is no file that can be read.
pub(super) fn check(dir: &Path, homes: &[PathBuf]) -> Result<(), LoadError> {
    let mut look = Look { homes, waiting: Vec::new(), seen: BTreeSet::new() };
    look.follow(dir)?;
    let start = look.waiting.clone();
    while let Some(folder) = look.waiting.pop() {
        let failed = |source| LoadError::Io { path: folder.clone(), source };
        let listing = fs::read_dir(&folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
        let listing = listing.map_err(failed)?;
        if start.contains(&folder) || is_read(&folder, &listing) {
            listing
                .iter()
                .try_for_each(|entry| look.entry(entry).map_err(|error| error.at(entry)))?;
        }
    }
    Ok(())
}

/// Whether a load looks into a folder: it is a state, or part of a save that was interrupted, and not another machine.
fn is_read(folder: &Path, listing: &[DirEntry]) -> bool {
    let has = |name: &str| listing.iter().any(|entry| entry.file_name() == name);
    let is_staged = folder.components().any(|part| part.as_os_str() == STAGING);
    let is_machine = |entry: &DirEntry| {
        entry.file_name() == HEADER && entry.file_type().is_ok_and(|kind| kind.is_file())
    };
    is_staged || (has(Part::Core.file_name()) && !listing.iter().any(is_machine))
}

/// What is wrong with an entry of a folder.
enum Wrong {
    Outside,
    Unfit,
}

impl Wrong {
    fn at(self, entry: &DirEntry) -> LoadError {
        match self {
            Self::Outside => LoadError::Outside { link: entry.path() },
            Self::Unfit => LoadError::Unfit { file: entry.path() },
        }
    }
}

impl Look<'_> {
    fn is_inside(&self, path: &Path) -> bool {
        self.homes.iter().any(|home| path.starts_with(home))
    }

    fn follow(&mut self, dir: &Path) -> Result<(), LoadError> {
        let failed = |source| LoadError::Io { path: dir.to_owned(), source };
        let real = fs::canonicalize(dir).map_err(failed)?;
        if !self.is_inside(&real) {
            return Err(LoadError::Outside { link: dir.to_owned() });
        }
        self.wait(real);
        Ok(())
    }

    fn wait(&mut self, folder: PathBuf) {
        if self.seen.insert(folder.clone()) {
            self.waiting.push(folder);
        }
    }

    /// What cannot be reached cannot be read either.
    fn entry(&mut self, entry: &DirEntry) -> Result<(), Wrong> {
        let Ok(kind) = entry.file_type() else { return Ok(()) };
        if kind.is_dir() {
            self.wait(entry.path());
            return Ok(());
        }
        if kind.is_symlink() {
            return self.link(entry);
        }
        match entry.metadata() {
            Ok(about) if is_ours(entry) => is_fit(&about),
            Ok(_) | Err(_) => Ok(()),
        }
    }

    /// Where a link leads. Only for links is the whole way looked up: it costs more than all else.
    fn link(&mut self, entry: &DirEntry) -> Result<(), Wrong> {
        let path = entry.path();
        let (Ok(about), Ok(real)) = (fs::metadata(&path), fs::canonicalize(&path)) else {
            return Ok(());
        };
        let is_ours = is_ours(entry);
        if (is_ours || about.is_dir()) && !self.is_inside(&real) {
            return Err(Wrong::Outside);
        }
        if about.is_dir() {
            self.wait(real);
            return Ok(());
        }
        if is_ours { is_fit(&about) } else { Ok(()) }
    }
}

/// Whether a file can be read as a whole.
fn is_fit(about: &Metadata) -> Result<(), Wrong> {
    let is_fit = about.is_file() && about.len() <= BYTES_MAX;
    if is_fit { Ok(()) } else { Err(Wrong::Unfit) }
}

/// Whether a load reads files of this name.
fn is_ours(entry: &DirEntry) -> bool {
    let name = entry.file_name();
    let of_machine = [HEADER, YAML_HEADER, MACHINE_LAYOUT];
    let is_staged = entry.path().components().any(|part| part.as_os_str() == STAGING);
    is_staged
        || of_machine.iter().any(|ours| name == *ours)
        || Part::ALL.iter().any(|part| name == part.file_name())
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MAX, check};
    use std::fs;
    use std::os::unix::fs::symlink;
    use std::path::Path;

    /// What is said about a machine to whose one state something is done.
    fn said(change: impl FnOnce(&Path)) -> String {
        let place = tempfile::tempdir().unwrap();
        let place = place.path().canonicalize().unwrap();
        let state = place.join("home/machine/STATE");
        fs::create_dir_all(&state).unwrap();
        fs::create_dir_all(place.join("outside/inner")).unwrap();
        for file in ["home/machine/statemachine.json", "outside/file", "outside/core_data.json"] {
            fs::write(place.join(file), "{}").unwrap();
        }
        fs::write(state.join("core_data.json"), "{}").unwrap();
        change(&state);
        let said = check(&place.join("home/machine"), &[place.join("home")]);
        let said = said.map_or_else(|error| error.to_string(), |()| "fine".to_owned());
        let said = said.replace(&*place.to_string_lossy(), "");
        said.split(';').next().unwrap_or_default().to_owned()
    }

    #[test]
    fn no_link_leads_out_of_where_machines_lie() {
        let link = |to: &'static str, name: &'static str| {
            said(move |state| symlink(to, state.join(name)).unwrap())
        };
        let refused = |name: &str| {
            format!("/home/machine/STATE/{name} leads out of the folders that may be read")
        };
        assert_eq!(link("../../../outside/file", "script.py"), refused("script.py"));
        assert_eq!(link("../../../outside", "inner"), refused("inner"));
        assert_eq!(link("../../../outside/file", "notes.txt"), "fine");
        assert_eq!(link("..", "round"), "fine");
        assert_eq!(link("nowhere", "script.py"), "fine");
    }

    #[test]
    fn links_behind_links_are_seen() {
        let behind = said(|state| {
            let other = state.join("../../other");
            fs::create_dir(&other).unwrap();
            fs::write(other.join("core_data.json"), "{}").unwrap();
            symlink("../../outside/file", other.join("script.py")).unwrap();
            symlink("../../other", state.join("inner")).unwrap();
        });
        assert_eq!(behind, "/home/other/script.py leads out of the folders that may be read");
    }

    #[test]
    fn only_files_of_a_size_are_read() {
        let large = said(|state| {
            let file = fs::File::create(state.join("script.py")).unwrap();
            file.set_len(BYTES_MAX + 1).unwrap();
        });
        assert_eq!(large, "/home/machine/STATE/script.py is not a regular file of at most 64 MiB");
        let socket = said(|state| {
            drop(std::os::unix::net::UnixListener::bind(state.join("script.py")).unwrap());
        });
        assert_eq!(socket, large);
    }
}
