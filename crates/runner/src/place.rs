//! Places of the machine as a run has met them: their names, flags and times. Knows no values.

use crate::Signals;
use parking_lot::RwLock;
use rafcon_engine::{NodeId, PathId};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64};

/// One place where a state can run.
#[derive(Debug)]
pub struct Place {
    /// Its number in the run.
    pub path: PathId,
    /// Which state stands there.
    pub node: NodeId,
    /// State ids from the root, joined by `/`.
    pub text: Arc<str>,
    /// What its script is asked to do.
    pub signals: Signals,
    /// When its state was entered last, in ns since the start.
    pub(crate) entered_ns: AtomicU64,
    /// Its line in the list of active scripts, counted from 1; 0 if it has none yet.
    pub(crate) line: AtomicU32,
}

impl Place {
    /// A place that nothing has happened at.
    pub(crate) fn new(path: PathId, node: NodeId, text: Arc<str>) -> Self {
        Self {
            path,
            node,
            text,
            signals: Signals::default(),
            entered_ns: AtomicU64::new(0),
            line: AtomicU32::new(0),
        }
    }
}

/// All places met so far, by number. Written by whoever drives the engine, read by all.
#[derive(Debug, Default)]
pub struct Places {
    list: RwLock<Vec<Option<Arc<Place>>>>,
}

impl Places {
    /// The place with this number, if the run has met it.
    pub fn get(&self, path: PathId) -> Option<Arc<Place>> {
        self.list.read().get(path.index()).cloned().flatten()
    }

    /// Uses the place with this number without counting a reference.
    pub(crate) fn with<T>(&self, path: PathId, use_it: impl FnOnce(&Arc<Place>) -> T) -> Option<T> {
        self.list.read().get(path.index()).and_then(Option::as_ref).map(use_it)
    }

    pub(crate) fn insert(&self, place: Arc<Place>) {
        let mut list = self.list.write();
        let index = place.path.index();
        if list.len() <= index {
            list.resize(index + 1, None);
        }
        list[index] = Some(place);
    }
}
