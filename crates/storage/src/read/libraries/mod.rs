//! Libraries: machines that other machines use. Finds each by its path and name, reads it once and shares it. Tracks the machines
//! that are being read, to detect cycles.

mod roots;
mod tree;

pub use roots::{Root, RootNote, roots};
pub use tree::{EntryKind, LibraryEntry};

use super::load_folder;
use super::packed::load_packed_folder;
use crate::files::{HEADER, Saved};
use crate::journal::Packed;
use crate::problem::LoadProblem;
use parking_lot::Mutex;
use rafcon_model::State;
use smol_str::{SmolStr, ToSmolStr as _, format_smolstr};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The maximum nesting of libraries within libraries.
const MAX_NESTING: usize = 100;

/// The libraries that machines can use. Each is read at its first use, and kept.
#[derive(Debug, Default)]
pub struct Libraries {
    roots: Vec<Root>,
    homes: Option<Vec<PathBuf>>,
    packed: Option<Arc<Packed>>,
    known: Mutex<BTreeMap<PathBuf, Arc<ReadLibrary>>>,
    answers: Mutex<BTreeMap<(SmolStr, SmolStr), Answer>>,
}

type Answer = Result<Arc<ReadLibrary>, SmolStr>;

/// A library, loaded from its folder or from packed files.
#[derive(Debug)]
pub(crate) struct ReadLibrary {
    pub(crate) root: Arc<State>,
    pub(crate) version: Option<SmolStr>,
    pub(crate) problems: Vec<LoadProblem>,
    pub(crate) saved: Saved,
}

/// The machines that are being read, the innermost first: a request for one of them is a cycle.
#[derive(Debug)]
pub(crate) struct Loading<'a> {
    dir: PathBuf,
    around: Option<&'a Self>,
    nesting: usize,
}

impl<'a> Loading<'a> {
    /// A machine that is not read as a library.
    pub(crate) fn first(dir: PathBuf) -> Self {
        Self { dir, around: None, nesting: 0 }
    }

    fn within(dir: PathBuf, around: &'a Self) -> Self {
        Self { dir, around: Some(around), nesting: around.nesting + 1 }
    }

    fn contains(&self, dir: &Path) -> bool {
        self.dir == dir || self.around.is_some_and(|around| around.contains(dir))
    }
}

impl Libraries {
    /// Libraries below these roots; of two roots with one name the first counts.
    pub fn new(roots: Vec<Root>) -> Self {
        Self { roots, ..Self::default() }
    }

    /// Restricts reading, for programs that load on behalf of others: all files of machines and libraries must be in these
    /// folders, links resolved. The paths of the folders contain no links.
    #[must_use]
    pub fn within(self, homes: Vec<PathBuf>) -> Self {
        Self { homes: Some(homes), ..self }
    }

    /// Reads from a pack of a run and never from the disk: the roots only give the original folders of the files.
    #[must_use]
    pub fn packed(self, packed: Arc<Packed>) -> Self {
        Self { packed: Some(packed), ..self }
    }

    /// The folders from which files may be read; `None` means anywhere.
    pub(crate) fn homes(&self) -> Option<&[PathBuf]> {
        self.homes.as_deref()
    }

    /// The roots in the given order.
    pub fn roots(&self) -> &[Root] {
        &self.roots
    }

    /// Forgets all loaded libraries, so that changed files are read again.
    pub fn refresh(&self) {
        self.answers.lock().clear();
        self.known.lock().clear();
    }

    /// The folder of a library reference, whether or not it exists; `Err` is the reason why there is none.
    pub fn folder(&self, path: &str, name: &str) -> Result<PathBuf, SmolStr> {
        if path.split('/').any(str::is_empty) || name.is_empty() {
            return Err(format_smolstr!("`{path}` is not a library path such as `root/folder`"));
        }
        let parts = |text: &str| text.split('/').map(str::to_owned).collect::<Vec<_>>();
        let wanted = parts(path);
        let root = self.roots.iter().filter(|root| wanted.starts_with(&parts(&root.name)));
        let root = root.max_by_key(|root| (root.name.len(), std::cmp::Reverse(self.rank(root))));
        let root =
            root.ok_or_else(|| format_smolstr!("no library root is named `{}`", wanted[0]))?;
        let inside = &wanted[parts(&root.name).len()..];
        Ok(inside.iter().fold(root.dir.clone(), |dir, part| dir.join(part)).join(name))
    }

    fn rank(&self, root: &Root) -> Option<usize> {
        self.roots.iter().position(|other| other == root)
    }

    /// The library path and name of the machine in `dir`; compares whole folder names.
    pub fn reference(&self, dir: &Path) -> Option<(SmolStr, SmolStr)> {
        let dir = fs::canonicalize(dir).ok()?;
        let below = |root: &Root| {
            let inside =
                dir.strip_prefix(fs::canonicalize(&root.dir).ok()?).ok()?.to_str()?.to_owned();
            let (folder, name) = inside.rsplit_once('/').unwrap_or(("", &inside));
            let path = if folder.is_empty() {
                root.name.clone()
            } else {
                format_smolstr!("{}/{folder}", root.name)
            };
            (!name.is_empty()).then(|| (path, SmolStr::new(name)))
        };
        self.roots.iter().filter_map(below).min_by_key(|(path, _)| path.len())
    }

    /// The library, read now or earlier; `Err` is the reason why it is missing.
    pub(crate) fn resolve(&self, path: &str, name: &str, loading: &Loading<'_>) -> Answer {
        let key = (SmolStr::new(path), SmolStr::new(name));
        if let Some(answer) = self.answers.lock().get(&key) {
            return answer.clone();
        }
        let answer = match self.existing(path, name) {
            Err(reason) => Err(reason),
            Ok(dir) if loading.contains(&dir) => {
                return Err(format_smolstr!("{} contains itself", dir.display()));
            }
            Ok(dir) => self.read(&dir, path, name, loading),
        };
        self.answers.lock().entry(key).or_insert(answer).clone()
    }

    /// A library that was read earlier.
    pub(crate) fn known(&self, path: &str, name: &str) -> Option<Arc<ReadLibrary>> {
        let answer = self.answers.lock().get(&(path.into(), name.into())).cloned();
        answer?.ok()
    }

    /// The identity of the library: its folder with links resolved, or its folder in the pack.
    fn existing(&self, path: &str, name: &str) -> Result<PathBuf, SmolStr> {
        if let Some(packed) = &self.packed {
            let folder = packed.library_folder(path, name).map(PathBuf::from);
            return folder.ok_or_else(|| format_smolstr!("the run has kept no {path}/{name}"));
        }
        let dir = self.folder(path, name)?;
        let found = fs::canonicalize(&dir);
        let found = found.map_err(|error| format_smolstr!("{}: {error}", dir.display()))?;
        if fs::exists(found.join(HEADER)).unwrap_or(false) {
            Ok(found)
        } else {
            Err(format_smolstr!("{} has no {HEADER}", dir.display()))
        }
    }

    fn read(&self, dir: &Path, path: &str, name: &str, loading: &Loading<'_>) -> Answer {
        if let Some(parsed) = self.known.lock().get(dir) {
            return Ok(Arc::clone(parsed));
        }
        if loading.nesting >= MAX_NESTING {
            return Err(format_smolstr!("libraries nest deeper than {MAX_NESTING} levels"));
        }
        let within = Loading::within(dir.to_owned(), loading);
        let loaded = match &self.packed {
            Some(packed) => {
                let lay = self.folder(path, name).unwrap_or_else(|_no_root| dir.to_owned());
                load_packed_folder(packed, &dir.to_string_lossy(), &lay, self, &within)
            }
            None => load_folder(dir, self, &within),
        };
        let loaded = loaded.map_err(|error| error.to_smolstr())?;
        let parsed = Arc::new(ReadLibrary {
            root: loaded.machine.root,
            version: loaded.machine.header.version,
            problems: loaded.problems,
            saved: loaded.saved,
        });
        Ok(Arc::clone(self.known.lock().entry(dir.to_owned()).or_insert(parsed)))
    }
}
