//! Folders that the system watches. Knows their selection and the system's interface, but not the meaning of changes.
//!
//! Each watch takes memory of the system. Projects are therefore watched only down to their machines; libraries and open machines
//! are watched down to the last state. Links are not followed.

use crate::log;
use crate::projects::{is_foreign, is_machine};
use notify::{ErrorKind, RecommendedWatcher, RecursiveMode, Watcher as _};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Maximum number of watched folders.
const MOST: usize = 100_000;

/// Folders that must be watched.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Plan {
    /// Watched with all folders inside.
    pub(super) whole: Vec<PathBuf>,
    /// Watched down to machines.
    pub(super) outside: Vec<PathBuf>,
    /// Never watched, including their content.
    pub(super) hidden: Vec<PathBuf>,
}

/// The folders that the system watches.
#[derive(Debug)]
pub(super) struct Folders {
    watcher: RecommendedWatcher,
    watched: BTreeSet<PathBuf>,
    /// Maximum number of watches.
    most: usize,
    is_full: bool,
}

impl Folders {
    /// Starts without watched folders.
    pub(super) fn new(watcher: RecommendedWatcher) -> Self {
        Self { watcher, watched: BTreeSet::new(), most: MOST, is_full: false }
    }

    /// True if the folder is watched.
    pub(super) fn knows(&self, folder: &Path) -> bool {
        self.watched.contains(folder)
    }

    /// Watches exactly the planned folders, as they exist now.
    pub(super) fn follow(&mut self, plan: &Plan) {
        self.is_full = false;
        let mut wanted = BTreeSet::new();
        for folder in &plan.whole {
            self.descend(folder, &mut wanted, &|_folder| true, plan);
        }
        for folder in &plan.outside {
            self.descend(folder, &mut wanted, &|folder| !is_machine(folder), plan);
        }
        let idle = self.watched.difference(&wanted).cloned().collect();
        self.leave(idle);
    }

    /// Removes the watches of deleted or moved folders, whose events would have wrong paths.
    pub(super) fn forget(&mut self, gone: &BTreeSet<PathBuf>) {
        for path in gone {
            let below = self.watched.range(path.clone()..).take_while(|it| it.starts_with(path));
            let below = below.cloned().collect();
            self.leave(below);
        }
    }

    /// Removes the watches of all folders.
    pub(super) fn forget_all(&mut self) {
        self.leave(self.watched.clone());
    }

    /// Each folder is watched before it is read, so that a new entry in between causes an event.
    fn descend(
        &mut self,
        from: &Path,
        wanted: &mut BTreeSet<PathBuf>,
        enter: &dyn Fn(&Path) -> bool,
        plan: &Plan,
    ) {
        let mut open = vec![from.to_owned()];
        while let Some(folder) = open.pop() {
            let is_new = !plan.hidden.contains(&folder) && wanted.insert(folder.clone());
            if is_new && self.ask(&folder) && enter(&folder) {
                open.extend(inside(&folder));
            }
        }
    }

    /// Watches a folder. Returns `false` if it does not exist or the system cannot watch it.
    fn ask(&mut self, folder: &Path) -> bool {
        if self.watched.contains(folder) {
            return true;
        }
        if self.is_full {
            return false;
        }
        let asked = if self.watched.len() < self.most {
            self.watcher.watch(folder, RecursiveMode::NonRecursive)
        } else {
            Err(notify::Error::new(ErrorKind::MaxFilesWatch))
        };
        match asked {
            Ok(()) => self.watched.insert(folder.to_owned()),
            Err(error) => {
                self.is_full = matches!(error.kind, ErrorKind::MaxFilesWatch);
                if self.is_full {
                    self.say_full();
                }
                false
            }
        }
    }

    fn say_full(&self) {
        log::say(&format!(
            "{} folders are watched and the system allows no more: changes that other programs make elsewhere are seen \
             when a machine is opened or saved; raise fs.inotify.max_user_watches, or serve fewer folders",
            self.watched.len()
        ));
    }

    /// Errors are ignored: the folder may no longer exist.
    fn leave(&mut self, folders: BTreeSet<PathBuf>) {
        for folder in folders {
            self.watched.remove(&folder);
            self.watcher.unwatch(&folder).unwrap_or_default();
        }
    }
}

/// The folders in a folder. Empty if it cannot be read.
fn inside(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_ours = |entry: &fs::DirEntry| {
        !is_foreign(&entry.file_name().to_string_lossy())
            && entry.file_type().is_ok_and(|kind| kind.is_dir())
    };
    entries.filter(is_ours).map(|entry| entry.path()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::{Expect, expect};

    /// Makes folders (a trailing `!` marks a machine), follows a plan, and prints the watched folders.
    struct Place {
        place: tempfile::TempDir,
        folders: Folders,
    }

    impl Place {
        fn new(paths: &[&str]) -> Self {
            let place = tempfile::tempdir().unwrap();
            let watcher = notify::recommended_watcher(|_event| {}).unwrap();
            let made = Self { place, folders: Folders::new(watcher) };
            for path in paths {
                made.make(path);
            }
            made
        }

        fn make(&self, path: &str) {
            let folder = self.path(path.trim_end_matches('!'));
            fs::create_dir_all(&folder).unwrap();
            if path.ends_with('!') {
                fs::write(folder.join("statemachine.json"), "{}").unwrap();
            }
        }

        fn path(&self, path: &str) -> PathBuf {
            self.place.path().join(path)
        }

        fn follow(&mut self, whole: &[&str], outside: &[&str]) {
            let paths = |list: &[&str]| list.iter().map(|path| self.path(path)).collect();
            let plan =
                Plan { whole: paths(whole), outside: paths(outside), hidden: paths(&["p/runs"]) };
            self.folders.follow(&plan);
        }

        fn check(&self, expected: &Expect) {
            let inside = |folder: &PathBuf| {
                folder.strip_prefix(self.place.path()).unwrap().display().to_string()
            };
            expected
                .assert_eq(&self.folders.watched.iter().map(inside).collect::<Vec<_>>().join(" "));
        }
    }

    #[test]
    fn projects_are_followed_to_their_machines_and_open_machines_to_their_states() {
        let mut place = Place::new(&[
            "p/a!",
            "p/a/STATE/INNER",
            "p/b/c!",
            "p/b/c/STATE",
            "p/.git/x",
            "p/runs/1",
        ]);
        place.follow(&[], &["p"]);
        place.check(&expect!["p p/a p/b p/b/c"]);
        place.follow(&["p/a"], &["p"]);
        place.check(&expect!["p p/a p/a/STATE p/a/STATE/INNER p/b p/b/c"]);
        place.follow(&[], &["p"]);
        place.check(&expect!["p p/a p/b p/b/c"]);
    }

    #[test]
    fn what_is_gone_is_forgotten_and_what_comes_in_its_place_is_followed() {
        let mut place = Place::new(&["p/a/b", "p/ab"]);
        place.follow(&["p"], &[]);
        fs::remove_dir_all(place.path("p/a")).unwrap();
        place.folders.forget(&BTreeSet::from([place.path("p/a")]));
        place.check(&expect!["p p/ab"]);
        place.make("p/a/c");
        place.follow(&["p"], &["missing"]);
        place.check(&expect!["p p/a p/a/c p/ab"]);
        place.folders.forget_all();
        place.check(&expect![""]);
    }

    #[test]
    fn of_too_many_folders_some_are_watched_and_others_once_there_is_room() {
        let mut place = Place::new(&["p/a/b", "q"]);
        assert_eq!(place.folders.most, MOST);
        place.folders.most = 2;
        place.follow(&["p", "q"], &[]);
        place.check(&expect!["p p/a"]);
        place.follow(&["p/a", "q"], &[]);
        place.check(&expect!["p/a"]);
        place.follow(&["p/a", "q"], &[]);
        place.check(&expect!["p/a p/a/b"]);
        place.follow(&["q"], &[]);
        place.follow(&["q"], &[]);
        place.check(&expect!["q"]);
    }
}
