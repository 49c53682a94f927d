//! Where the states of a machine lie on disk: folder names, and files whose bytes the model cannot hold.
//! Knows places, neither reads nor writes them.

use crate::files::Part;
use rafcon_model::{Header, State, StateId};
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::sync::Arc;

/// The folder of a state and of the states in it. Cloning is cheap.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StateFolder {
    /// The folder's name in the parent's folder; empty for the root of the current layout.
    pub(crate) folder: Arc<OsStr>,
    pub(crate) extra: Option<Box<Oddities>>,
    children: Option<Arc<Vec<(StateId, Self)>>>,
}

/// What a folder holds that its state in memory does not tell.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Oddities {
    /// Files that could not be read as what they should be; written back as they are until their part is changed.
    pub(crate) verbatim: BTreeMap<Part, Arc<[u8]>>,
    /// The state in memory differs from its file (its id was repaired), so the next save writes it.
    pub(crate) stale: bool,
}

impl StateFolder {
    /// A place with children in any order.
    pub(crate) fn new(folder: OsString, mut children: Vec<(StateId, Self)>) -> Self {
        children.sort_by(|a, b| a.0.cmp(&b.0));
        let children = if children.is_empty() { None } else { Some(Arc::new(children)) };
        Self { folder: folder.into(), extra: None, children }
    }

    /// The same place in a folder of this name.
    pub(crate) fn in_folder(self, folder: OsString) -> Self {
        Self { folder: folder.into(), ..self }
    }

    /// The same place with other things that only its files tell.
    pub(crate) fn with(mut self, oddities: Oddities) -> Self {
        self.extra = (oddities != Oddities::default()).then(|| Box::new(oddities));
        self
    }

    /// The state's file has to be written although nobody changed the state; not if the file could not be read at all.
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

/// What is on disk: the machine as it was last read or written, and where. A save compares with it.
#[derive(Debug, Clone)]
pub struct Saved {
    pub(crate) dir: PathBuf,
    pub(crate) header: Header,
    pub(crate) root: Arc<State>,
    pub(crate) place: StateFolder,
    /// The files are of an older layout, or their header could not be read: a save writes all of them anew.
    pub(crate) outdated: bool,
    /// Some state differs from its file because its id was repaired.
    pub(crate) stale: bool,
}

impl Saved {
    /// The folder of the machine.
    pub fn dir(&self) -> &std::path::Path {
        &self.dir
    }

    /// The root state as it is on disk.
    pub fn root(&self) -> &Arc<State> {
        &self.root
    }
}
