//! Folders of machines: where the fixtures are, what is in a folder, how to read it.

use rafcon_storage::{Libraries, Loaded, Root, load};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The library roots below `dir`, each named after its folder.
pub(crate) fn libraries(dir: &Path) -> Libraries {
    let Ok(entries) = fs::read_dir(dir) else { return Libraries::default() };
    let root = |dir: PathBuf| {
        let name = dir.file_name()?.to_str()?.into();
        Some(Root { name, dir })
    };
    Libraries::new(entries.filter_map(|entry| root(entry.ok()?.path())).collect())
}

/// Reads a machine that can be read.
pub(crate) fn read(dir: &Path, libraries: &Libraries) -> Loaded {
    match load(dir, libraries) {
        Ok(loaded) => loaded,
        Err(error) => panic!("{error}: {error:?}"),
    }
}

/// Every file below `dir` with its bytes.
pub(crate) fn files(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut waiting = vec![dir.to_owned()];
    while let Some(folder) = waiting.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                waiting.push(path);
            } else {
                let name = path.strip_prefix(dir).unwrap().to_owned();
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Copies a folder.
pub(crate) fn copy(from: &Path, to: &Path) {
    for (path, bytes) in files(from) {
        let path = to.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// Reads a machine without libraries; it must be readable.
pub(crate) fn loaded(dir: &Path) -> Loaded {
    read(dir, &Libraries::default())
}

/// The problems, one a line.
pub(crate) fn show_problems(loaded: &Loaded) -> String {
    loaded.problems.iter().map(|problem| problem.to_string() + "\n").collect()
}
