//! Checks that all files of a machine may be read before an interrupted save of it is finished, because that moves files. Checks
//! links and kinds of files, not their content. Files that are only read are checked when they are opened.
//!
//! A link that is created between the check and the save is not detected: it takes write access to the machine's folder.

use super::bounds::{BYTES_MAX, Bounds};
use crate::files::{HEADER, MACHINE_LAYOUT, Part, STAGING, YAML_HEADER};
use crate::problem::LoadError;
use std::collections::BTreeSet;
use std::fs::{self, DirEntry, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// A check of every folder that a load would read.
struct Look<'h> {
    homes: &'h [PathBuf],
    waiting: Vec<PathBuf>,
    seen: BTreeSet<PathBuf>,
}

/// Refuses a machine with a part outside of these folders, or with a file that cannot be read.
pub(super) fn check(dir: &Path, bounds: Bounds<'_>) -> Result<(), LoadError> {
    let Some(homes) = bounds.0 else { return Ok(()) };
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

/// Returns true if a load reads the folder: it is a state or part of an interrupted save, and not another machine.
fn is_read(folder: &Path, listing: &[DirEntry]) -> bool {
    let has = |name: &str| listing.iter().any(|entry| entry.file_name() == name);
    let is_staged = folder.components().any(|part| part.as_os_str() == STAGING);
    let is_machine = |entry: &DirEntry| {
        entry.file_name() == HEADER && entry.file_type().is_ok_and(|kind| kind.is_file())
    };
    is_staged || (has(Part::Core.file_name()) && !listing.iter().any(is_machine))
}

/// Fault of an entry in a folder.
enum EntryFault {
    Outside,
    Unfit,
}

impl EntryFault {
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

    /// A path that cannot be resolved cannot be read either.
    fn entry(&mut self, entry: &DirEntry) -> Result<(), EntryFault> {
        let Ok(kind) = entry.file_type() else { return Ok(()) };
        if kind.is_dir() {
            self.wait(entry.path());
            return Ok(());
        }
        if kind.is_symlink() {
            return self.link(entry);
        }
        match entry.metadata() {
            Ok(about) if is_ours(entry) => check_fit(&about),
            Ok(_) | Err(_) => Ok(()),
        }
    }

    /// The target of a link. Resolves the whole path only for links, because that is the most expensive operation.
    fn link(&mut self, entry: &DirEntry) -> Result<(), EntryFault> {
        let path = entry.path();
        let (Ok(about), Ok(real)) = (fs::metadata(&path), fs::canonicalize(&path)) else {
            return Ok(());
        };
        let is_ours = is_ours(entry);
        if (is_ours || about.is_dir()) && !self.is_inside(&real) {
            return Err(EntryFault::Outside);
        }
        if about.is_dir() {
            self.wait(real);
            return Ok(());
        }
        if is_ours { check_fit(&about) } else { Ok(()) }
    }
}

/// Checks that a file can be read as a whole.
fn check_fit(about: &Metadata) -> Result<(), EntryFault> {
    let check_fit = about.is_file() && about.len() <= BYTES_MAX;
    if check_fit { Ok(()) } else { Err(EntryFault::Unfit) }
}

/// Returns true if a load reads files of this name.
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
    use super::BYTES_MAX;
    use crate::files::STAGING;
    use crate::{Libraries, load};
    use std::fs;
    use std::os::unix::fs::symlink;
    use std::path::Path;

    /// Returns the error for a machine after a change in the folder of its only state.
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
        let libraries = Libraries::default().within(vec![place.join("home")]);
        let said = load(&place.join("home/machine"), &libraries);
        let said = said.map_or_else(|error| error.to_string(), |_loaded| "fine".to_owned());
        let said = said.replace(&*place.to_string_lossy(), "");
        said.split(';').next().unwrap_or_default().to_owned()
    }

    /// Returns the error after a link with this name is added.
    fn linked(to: &str, name: &str) -> String {
        said(|state| symlink(to, state.join(name)).unwrap())
    }

    fn refused(name: &str) -> String {
        format!("/home/machine/{name} leads out of the folders that may be read")
    }

    #[test]
    fn no_link_leads_out_of_where_machines_lie() {
        assert_eq!(linked("../../../outside/file", "script.py"), refused("STATE/script.py"));
        assert_eq!(linked("../../../outside", "inner"), refused("STATE/inner"));
        assert_eq!(linked("../../../outside/inner", "inner"), refused("STATE/inner"));
        assert_eq!(linked("/dev/zero", "script.py"), refused("STATE/script.py"));
        assert_eq!(linked("../../../outside/file", "notes.txt"), "fine");
        assert_eq!(linked("..", "round"), "fine");
        assert_eq!(linked("nowhere", "script.py"), "fine");
        assert_eq!(linked("script.py", "script.py"), "fine");
        assert_eq!(linked("core_data.json", "semantic_data.json"), "fine");
    }

    #[test]
    fn no_link_stands_for_the_machine_its_root_or_its_header() {
        let replaced = |name: &'static str, to: &'static str| {
            said(move |state| {
                let place = state.parent().unwrap().join(name);
                if place.is_dir() {
                    fs::remove_dir_all(&place).unwrap();
                } else if place.exists() {
                    fs::remove_file(&place).unwrap();
                }
                symlink(to, place).unwrap();
            })
        };
        let header = replaced("statemachine.json", "../../outside/file");
        assert_eq!(header, refused("statemachine.json"));
        assert_eq!(replaced("STATE", "../../outside"), refused("STATE/core_data.json"));
        let machine = said(|state| {
            let machine = state.parent().unwrap();
            let outside = machine.join("../../outside/machine");
            fs::rename(machine, &outside).unwrap();
            symlink("../outside/machine", machine).unwrap();
        });
        assert_eq!(machine, "/home/machine leads out of the folders that may be read");
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
        assert_eq!(behind, refused("STATE/inner/script.py"));
    }

    #[test]
    fn only_files_of_a_size_are_read() {
        let large = |name: &'static str| {
            said(move |state| {
                let file = fs::File::create(state.join(name)).unwrap();
                file.set_len(BYTES_MAX + 1).unwrap();
            })
        };
        let unfit = "/home/machine/STATE/script.py is not a regular file of at most 64 MiB";
        assert_eq!(large("script.py"), unfit);
        let socket = said(|state| {
            drop(std::os::unix::net::UnixListener::bind(state.join("script.py")).unwrap());
        });
        assert_eq!(socket, unfit);
        let linked = said(|state| {
            drop(std::os::unix::net::UnixListener::bind(state.join("socket")).unwrap());
            symlink("socket", state.join("script.py")).unwrap();
        });
        assert_eq!(linked, unfit);
    }

    #[test]
    fn a_device_without_an_end_is_never_read_to_its_end() {
        let place = tempfile::tempdir().unwrap();
        for file in ["statemachine.json", "core_data.json"] {
            fs::write(place.path().join(file), "{}").unwrap();
        }
        symlink("/dev/zero", place.path().join("script.py")).unwrap();
        let said = load(place.path(), &Libraries::default()).unwrap_err().to_string();
        let unfit = "script.py is not a regular file of at most 64 MiB";
        assert!(said.contains(unfit), "{said}");
    }

    #[test]
    fn no_interrupted_save_is_finished_with_what_lies_outside() {
        let staged =
            said(|state| symlink("../../outside", state.join("..").join(STAGING)).unwrap());
        assert_eq!(staged, refused(STAGING));
        let moved = said(|state| {
            let staging = state.join("..").join(STAGING);
            fs::create_dir(&staging).unwrap();
            symlink("../../../outside/file", staging.join("a")).unwrap();
        });
        assert_eq!(moved, refused(&format!("{STAGING}/a")));
        let large = said(|state| {
            let staging = state.join("..").join(STAGING);
            fs::create_dir(&staging).unwrap();
            let file = fs::File::create(staging.join("a")).unwrap();
            file.set_len(BYTES_MAX + 1).unwrap();
        });
        let unfit = format!("/home/machine/{STAGING}/a is not a regular file of at most 64 MiB");
        assert_eq!(large, unfit);
    }
}
