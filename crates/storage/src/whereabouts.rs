//! Finds the folder of a state by its path, also inside libraries. Uses loaded data and reads no files.

use crate::Libraries;
use crate::files::{Saved, StateFolder};
use crate::libraries::ReadLibrary;
use rafcon_model::{Kind, State, StateId, StatePath};
use std::path::PathBuf;
use std::sync::Arc;

impl Saved {
    /// Returns the folder of the state at `path` when the machine was loaded. `libraries` are those that it was loaded with. `None`
    /// if there is no such state.
    pub fn folder(&self, path: &StatePath, libraries: &Libraries) -> Option<PathBuf> {
        let (first, rest) = path.0.split_first()?;
        let root = Here::root(self);
        (root.state.id == *first).then_some(())?;
        let here = rest.iter().try_fold(root, |here, id| here.step(id, libraries))?;
        Some(here.dir)
    }
}

/// A state and its folder.
struct Here {
    dir: PathBuf,
    place: StateFolder,
    state: Arc<State>,
}

impl Here {
    fn root(saved: &Saved) -> Self {
        let dir = saved.dir.join(&*saved.place.folder);
        Self { dir, place: saved.place.clone(), state: Arc::clone(&saved.root) }
    }

    fn step(self, id: &StateId, libraries: &Libraries) -> Option<Self> {
        if let Kind::Library(library) = &self.state.kind {
            let parsed: Arc<ReadLibrary> = libraries.known(&library.path, &library.name)?;
            return (parsed.root.id == *id).then(|| Self::root(&parsed.saved));
        }
        let state = Arc::clone(self.state.container()?.states.get(id)?);
        let place = self.place.child(id)?.clone();
        Some(Self { dir: self.dir.join(&*place.folder), place, state })
    }
}

#[cfg(test)]
mod tests {
    use crate::{Libraries, Root, load};
    use expect_test::{Expect, expect};
    use rafcon_model::StatePath;
    use std::path::Path;

    const CORE: &str = r#"{"__jsonqualname__": "rafcon.core.states.CLASS", "state_id": "ID", "name": "n", "outcomes": {}}"#;

    fn state(folder: &Path, class: &str, id: &str) {
        write(folder, &CORE.replace("CLASS", class).replace("ID", id));
    }

    fn library(folder: &Path, id: &str) {
        let core = CORE.replace("CLASS", "library_state.LibraryState").replace("ID", id);
        let reference = r#""library_path": "lib", "library_name": "used", "name""#;
        write(folder, &core.replace(r#""name""#, reference));
    }

    fn write(folder: &Path, core: &str) {
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join("core_data.json"), core).unwrap();
    }

    fn check(path: &str, expect: &Expect) {
        let temp = tempfile::tempdir().unwrap();
        for machine in ["main", "lib/used"] {
            std::fs::create_dir_all(temp.path().join(machine)).unwrap();
            std::fs::write(temp.path().join(machine).join("statemachine.json"), "{}").unwrap();
        }
        state(&temp.path().join("main"), "hierarchy_state.HierarchyState", "ROOT");
        library(&temp.path().join("main/any name"), "LIB");
        state(&temp.path().join("lib/used"), "hierarchy_state.HierarchyState", "INNER");
        state(&temp.path().join("lib/used/leaf"), "execution_state.ExecutionState", "LEAF");
        let libraries =
            Libraries::new(vec![Root { name: "lib".into(), dir: temp.path().join("lib") }]);
        let loaded = load(&temp.path().join("main"), &libraries).unwrap();
        let folder = loaded.saved.folder(&StatePath::parse(path), &libraries);
        let base = std::fs::canonicalize(temp.path()).unwrap();
        let below = |dir: std::path::PathBuf| {
            let dir = std::fs::canonicalize(dir).unwrap();
            dir.strip_prefix(&base).unwrap().display().to_string()
        };
        expect.assert_eq(&folder.map_or_else(|| "nowhere".to_owned(), below));
    }

    #[test]
    fn folders_are_found_through_libraries() {
        check("ROOT", &expect!["main"]);
        check("ROOT/LIB", &expect!["main/any name"]);
        check("ROOT/LIB/INNER", &expect!["lib/used"]);
        check("ROOT/LIB/INNER/LEAF", &expect!["lib/used/leaf"]);
        check("ROOT/LIB/LEAF", &expect!["nowhere"]);
        check("OTHER", &expect!["nowhere"]);
    }
}
