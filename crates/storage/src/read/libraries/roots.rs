//! Library roots from the config, the environment and the command line. Determines names and folders, and reads no library.

use crate::config::{Config, Environment, clean_path};
use smol_str::SmolStr;
use std::path::{Path, PathBuf};

/// A named folder with libraries below it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Root {
    /// First part of its library paths.
    pub name: SmolStr,
    /// Folder of the root.
    pub dir: PathBuf,
}

/// A fact about the roots that the user should know.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RootNote {
    /// The folder does not exist.
    #[error("library root {name}: {} does not exist; correct the path or remove it", dir.display())]
    NoFolder {
        /// Name of the root.
        name: SmolStr,
        /// Folder that does not exist.
        dir: PathBuf,
    },
    /// A later source assigns another folder to this name.
    #[error("library root {name} is now {}, not {}; rename one to use both", new.display(), old.display())]
    Replaced {
        /// Name of the root.
        name: SmolStr,
        /// Folder that was replaced.
        old: PathBuf,
        /// Folder that the name means from now on.
        new: PathBuf,
    },
}

/// Returns the roots in a defined order: those of the config, then those of `RAFCON_LIBRARY_PATH` in its order, then `given` (from
/// the command line). A later root replaces an earlier one of this name. If none of the config's roots exists, the default ones
/// below `RAFCON_LIB_PATH` are used instead.
pub fn roots(
    config: &Config,
    environment: &Environment<'_>,
    given: &[(String, PathBuf)],
) -> (Vec<Root>, Vec<RootNote>) {
    let mut found = FoundRoot::default();
    for (name, dir) in &config.library_paths {
        found.add(name, dir.clone());
    }
    if found.roots.is_empty() {
        for (name, dir) in default_roots(environment) {
            found.add(name, dir);
        }
    }
    for dir in search_path(environment) {
        let name = dir.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        found.add(&name, dir);
    }
    for (name, dir) in given {
        found.add(name, dir.clone());
    }
    (found.roots, found.notes)
}

fn search_path(environment: &Environment<'_>) -> Vec<PathBuf> {
    let text = environment("RAFCON_LIBRARY_PATH").unwrap_or_default();
    let parts = text.split(':').filter(|part| !part.trim().is_empty());
    parts.map(|part| clean_path(part, Path::new(""), environment)).collect()
}

/// Default roots of the reference.
fn default_roots(environment: &Environment<'_>) -> Vec<(&'static str, PathBuf)> {
    const DEFAULTS: [(&str, &str); 6] = [
        ("generic", "generic"),
        ("tutorials", "../examples/tutorials"),
        ("ros", "../examples/libraries/ros_libraries"),
        ("ros2", "../examples/ros2_libraries"),
        ("turtle_libraries", "../examples/libraries/turtle_libraries"),
        ("advanced_examples", "../examples/advanced_examples"),
    ];
    let Some(base) = environment("RAFCON_LIB_PATH") else { return Vec::new() };
    let dir = |below: &str| clean_path(&format!("{base}/{below}"), Path::new(""), environment);
    let roots = DEFAULTS.iter().map(|(name, below)| (*name, dir(below)));
    roots.filter(|(_, dir)| dir.is_dir()).collect()
}

#[derive(Default)]
struct FoundRoot {
    roots: Vec<Root>,
    notes: Vec<RootNote>,
}

impl FoundRoot {
    fn add(&mut self, name: &str, dir: PathBuf) {
        let name = SmolStr::new(name);
        if !dir.is_dir() {
            return self.notes.push(RootNote::NoFolder { name, dir });
        }
        let Some(earlier) = self.roots.iter_mut().find(|root| root.name == name) else {
            return self.roots.push(Root { name, dir });
        };
        if earlier.dir != dir {
            let old = std::mem::replace(&mut earlier.dir, dir.clone());
            self.notes.push(RootNote::Replaced { name, old, new: dir });
        }
    }
}
