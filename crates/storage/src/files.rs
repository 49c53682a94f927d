//! A machine on disk (`docs/format.md`, files): the names of its files, the folders of its states, and files
//! whose bytes the model cannot hold. Reads and writes nothing.

use rafcon_model::{Header, State, StateId};
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::sync::Arc;

/// Identifies a folder as a machine, and describes the machine as a whole.
pub const HEADER: &str = "statemachine.json";
/// The header of very old versions; no longer read.
pub const YAML_HEADER: &str = "statemachine.yaml";
/// Layout of the machine as a whole.
pub const MACHINE_LAYOUT: &str = "sm_meta_data.json";
/// The folder in which a save is prepared; exists only during a save, or after it was interrupted.
pub const STAGING: &str = ".rafcon-save";

/// One of the files of a state's folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// Core data of the state.
    Core,
    /// The Python text of an execution state.
    Script,
    /// Semantic data of the user.
    Semantic,
    /// Layout of the state and its parts.
    Layout,
}

impl Part {
    /// All files of a state.
    pub const ALL: [Self; 4] = [Self::Core, Self::Script, Self::Semantic, Self::Layout];

    /// Returns the file name of the part.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Core => "core_data.json",
            Self::Script => "script.py",
            Self::Semantic => "semantic_data.json",
            Self::Layout => "meta_data.json",
        }
    }
}

/// The folder of a state and of the states in it. Cloning is cheap.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StateFolder {
    /// The folder's name in the parent's folder; empty for the root of the current layout.
    pub(crate) folder: Arc<OsStr>,
    pub(crate) extra: Option<Box<Oddities>>,
    children: Option<Arc<Vec<(StateId, Self)>>>,
}

/// Facts about the files of a state that its state in memory does not have.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Oddities {
    /// Files that could not be decoded; written back as they are until their part is changed.
    pub(crate) verbatim: BTreeMap<Part, Arc<[u8]>>,
    /// The state in memory differs from its file (its id was repaired), so the next save writes it.
    pub(crate) stale: bool,
}

impl StateFolder {
    /// Creates a folder with children in any order.
    pub(crate) fn new(folder: OsString, mut children: Vec<(StateId, Self)>) -> Self {
        children.sort_by(|a, b| a.0.cmp(&b.0));
        let children = if children.is_empty() { None } else { Some(Arc::new(children)) };
        Self { folder: folder.into(), extra: None, children }
    }

    /// Returns the folder with another name.
    pub(crate) fn in_folder(self, folder: OsString) -> Self {
        Self { folder: folder.into(), ..self }
    }

    /// Returns the folder with other oddities.
    pub(crate) fn with(mut self, oddities: Oddities) -> Self {
        self.extra = (oddities != Oddities::default()).then(|| Box::new(oddities));
        self
    }

    /// Marks the state's file to be written although the state did not change, unless the file could not be decoded.
    pub(crate) fn mark_stale(&mut self) {
        let extra = self.extra.get_or_insert_default();
        extra.stale = !extra.verbatim.contains_key(&Part::Core);
    }

    pub(crate) fn children(&self) -> &[(StateId, Self)] {
        self.children.as_deref().map_or(&[], Vec::as_slice)
    }

    pub(crate) fn child(&self, id: &StateId) -> Option<&Self> {
        let children = self.children();
        let index = children.binary_search_by(|(child, _)| child.cmp(id)).ok()?;
        Some(&children[index].1)
    }

    pub(crate) fn verbatim(&self, part: Part) -> Option<&Arc<[u8]>> {
        self.extra.as_ref()?.verbatim.get(&part)
    }

    pub(crate) fn is_stale(&self) -> bool {
        self.extra.as_ref().is_some_and(|extra| extra.stale)
    }
}

/// The machine on disk as it was last read or written, and its folders. A save compares with it.
#[derive(Debug, Clone)]
pub struct Saved {
    pub(crate) dir: PathBuf,
    pub(crate) header: Header,
    pub(crate) root: Arc<State>,
    pub(crate) place: StateFolder,
    /// The files have an older layout, or an unreadable header: a save rewrites all of them.
    pub(crate) outdated: bool,
    /// A state differs from its file because its id was repaired.
    pub(crate) stale: bool,
}

impl Saved {
    /// Returns the folder of the machine.
    pub fn dir(&self) -> &std::path::Path {
        &self.dir
    }

    /// Returns the root state on disk.
    pub fn root(&self) -> &Arc<State> {
        &self.root
    }
}
