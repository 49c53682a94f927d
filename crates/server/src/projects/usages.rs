//! Usages of a library according to files. Knows the layout of machines on disk. Searches the files of states one by one, and
//! parses only those that contain the key of a library.

use super::tree::{is_foreign, is_machine};
use rafcon_storage::files::Part;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Maximum number of folders searched.
const FOLDERS_MAX: usize = 200_000;
/// Maximum depth below a project.
const DEPTH_MAX: usize = 512;
/// Larger files are skipped.
const BYTES_MAX: u64 = 16 << 20;

/// A state that runs the library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Use {
    /// Folder of the machine.
    pub(crate) machine: PathBuf,
    /// Ids and names of the states, from the root on.
    pub(crate) states: Vec<(String, String)>,
}

/// A search for the usages of a library.
#[derive(Debug)]
pub(crate) struct Search<'s> {
    /// Path of the library.
    pub(crate) path: &'s str,
    pub(crate) name: &'s str,
    /// Folders that the search skips.
    pub(crate) hidden: &'s BTreeSet<PathBuf>,
    /// Maximum number of usages.
    pub(crate) most: usize,
    pub(crate) found: Vec<Use>,
    /// Maximum number of folders searched.
    folders: usize,
    seen: BTreeSet<PathBuf>,
}

/// A folder in the search.
#[derive(Debug)]
struct SearchedFolder {
    path: PathBuf,
    depth: usize,
    /// The enclosing machine, and the files of the enclosing states.
    machine: Option<(PathBuf, Vec<PathBuf>)>,
}

impl<'s> Search<'s> {
    pub(crate) fn new(
        path: &'s str,
        name: &'s str,
        hidden: &'s BTreeSet<PathBuf>,
        most: usize,
    ) -> Self {
        let (found, seen) = (Vec::new(), BTreeSet::new());
        Self { path, name, hidden, most, found, folders: FOLDERS_MAX, seen }
    }

    /// True if the search reached a limit, so that it may have missed usages.
    pub(crate) fn is_full(&self) -> bool {
        self.found.len() >= self.most || self.seen.len() >= self.folders
    }

    /// Searches a folder and everything below it, except folders that were already searched.
    pub(crate) fn look(&mut self, folder: &Path) {
        let mut waiting = vec![SearchedFolder { path: folder.to_owned(), depth: 0, machine: None }];
        while let Some(folder) = waiting.pop() {
            if self.is_full() {
                return;
            }
            let is_new =
                !self.hidden.contains(&folder.path) && self.seen.insert(folder.path.clone());
            if !is_new || folder.depth > DEPTH_MAX {
                continue;
            }
            let folder = self.at(folder);
            let mut inside: Vec<_> = folders(&folder.path);
            inside.sort_unstable_by(|a, b| b.cmp(a));
            waiting.extend(inside.into_iter().map(|path| folder.inner(path)));
        }
    }

    /// Classifies a folder as a machine, a state, or neither.
    fn at(&mut self, folder: SearchedFolder) -> SearchedFolder {
        let SearchedFolder { path, depth, machine } = folder;
        let machine = if is_machine(&path) { Some((path.clone(), Vec::new())) } else { machine };
        let machine = machine.map(|(home, mut states)| {
            let core = path.join(Part::Core.file_name());
            if is_fit(&core) {
                states.push(core);
                self.state(&home, &states);
            }
            (home, states)
        });
        SearchedFolder { path, depth, machine }
    }

    /// Checks the last of these nested states.
    fn state(&mut self, home: &Path, states: &[PathBuf]) {
        if states.last().is_some_and(|core| self.is_used(core)) {
            let states = states.iter().filter_map(|core| about(core)).collect();
            self.found.push(Use { machine: home.to_owned(), states });
        }
    }

    fn is_used(&self, core: &Path) -> bool {
        const KEY: &str = "\"library_name\"";
        let Ok(text) = fs::read_to_string(core) else { return false };
        if !text.contains(KEY) {
            return false;
        }
        let Ok(state) = serde_json::from_str::<Value>(&text) else { return false };
        state["library_name"] == self.name && state["library_path"] == self.path
    }
}

impl SearchedFolder {
    fn inner(&self, path: PathBuf) -> Self {
        Self { path, depth: self.depth + 1, machine: self.machine.clone() }
    }
}

/// The folders in a folder, without links.
fn folders(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let is_shown = |entry: &fs::DirEntry| {
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        is_folder && entry.file_name().to_str().is_some_and(|name| !is_foreign(name))
    };
    entries.flatten().filter(is_shown).map(|entry| entry.path()).collect()
}

/// True for a file that is small enough to read and is not a link.
fn is_fit(core: &Path) -> bool {
    core.symlink_metadata().is_ok_and(|about| about.is_file() && about.len() <= BYTES_MAX)
}

/// Id and name of a state, from its file.
fn about(core: &Path) -> Option<(String, String)> {
    let state: Value = serde_json::from_str(&fs::read_to_string(core).ok()?).ok()?;
    let id = state["state_id"].as_str()?.to_owned();
    let name = state["name"].as_str().unwrap_or(&id).to_owned();
    Some((id, name))
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MAX, DEPTH_MAX, Part, Search, is_fit};
    use rafcon_storage::files::HEADER;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::PathBuf;

    /// A project may be a home folder, with millions of folders without machines.
    #[test]
    fn a_search_ends_also_where_no_machines_are() {
        let place = tempfile::tempdir().unwrap();
        for number in 0..50 {
            fs::create_dir_all(place.path().join(format!("photos/{number}"))).unwrap();
        }
        let hidden = BTreeSet::new();
        let mut search = Search { folders: 20, ..Search::new("skills", "grip", &hidden, 10) };
        search.look(place.path());
        assert_eq!((search.is_full(), search.seen.len()), (true, 20));
    }

    #[test]
    fn what_lies_too_deep_or_is_too_large_is_not_looked_at() {
        let place = tempfile::tempdir().unwrap();
        let core = r#"{"state_id": "R", "library_path": "skills", "library_name": "grip"}"#;
        let machine = |depth: usize| {
            let folder = place.path().join("d/".repeat(depth));
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join(HEADER), "{}").unwrap();
            fs::write(folder.join(Part::Core.file_name()), core).unwrap();
            folder
        };
        let (deep, deeper) = (machine(DEPTH_MAX), machine(DEPTH_MAX + 1));
        let hidden = BTreeSet::new();
        let found = || {
            let mut search = Search::new("skills", "grip", &hidden, 10);
            search.look(place.path());
            assert!(!search.is_full());
            search.found.into_iter().map(|used| used.machine).collect::<Vec<_>>()
        };
        assert_eq!(found(), std::slice::from_ref(&deep));
        let core = fs::OpenOptions::new().write(true).open(deep.join(Part::Core.file_name()));
        let core = core.unwrap();
        core.set_len(BYTES_MAX).unwrap();
        assert!(is_fit(&deep.join(Part::Core.file_name())));
        core.set_len(BYTES_MAX + 1).unwrap();
        assert_eq!(found(), Vec::<PathBuf>::new());
        assert!(deeper.exists());
    }

    #[test]
    fn a_search_ends_with_the_uses_that_are_wanted() {
        let place = tempfile::tempdir().unwrap();
        for number in 0..3 {
            let folder = place.path().join(number.to_string());
            fs::create_dir(&folder).unwrap();
            fs::write(folder.join(HEADER), "{}").unwrap();
            let core = r#"{"state_id": "R", "library_path": "skills", "library_name": "grip"}"#;
            fs::write(folder.join(Part::Core.file_name()), core).unwrap();
        }
        let hidden = BTreeSet::new();
        let search = |most: usize| {
            let mut search = Search::new("skills", "grip", &hidden, most);
            search.look(place.path());
            (search.found.len(), search.is_full())
        };
        assert_eq!([2, 4].map(search), [(2, true), (3, false)]);
    }
}
