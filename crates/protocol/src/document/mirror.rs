//! A client's copy of a document, updated by changes.

use super::{Change, Document, HeaderDocument, StateDocument};
use rafcon_model::StatePath;
use std::collections::BTreeMap;

/// A machine as held by a client: states by path.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mirror {
    header: HeaderDocument,
    states: BTreeMap<StatePath, StateDocument>,
}

impl Mirror {
    /// Creates a mirror of a document.
    pub fn new(document: Document) -> Self {
        let states = document.states.into_iter();
        let states = states.map(|state| (StatePath::parse(&state.path), state)).collect();
        Self { header: document.header, states }
    }

    /// Returns the state at a path.
    pub fn state(&self, path: &str) -> Option<&StateDocument> {
        self.states.get(&StatePath::parse(path))
    }

    /// Returns all states, each after its parent.
    pub fn states(&self) -> impl Iterator<Item = &StateDocument> {
        self.states.values()
    }

    /// Applies one change. The changes of a revision belong together: until all are applied, a connection may refer to a missing
    /// state.
    pub fn apply(&mut self, change: Change) {
        match change {
            Change::Header { header } => self.header = header,
            Change::StateRemoved { path } => self.remove(&StatePath::parse(&path)),
            Change::State { state } => self.put(*state),
            Change::Transition { path, id, transition } => {
                if let Some(state) = self.states.get_mut(&StatePath::parse(&path)) {
                    put(&mut state.transitions, id, |t| t.id, transition);
                }
            }
            Change::DataFlow { path, id, data_flow } => {
                if let Some(state) = self.states.get_mut(&StatePath::parse(&path)) {
                    put(&mut state.data_flows, id, |f| f.id, data_flow);
                }
            }
        }
    }

    /// Returns the current document.
    pub fn document(&self) -> Document {
        Document { header: self.header.clone(), states: self.states.values().cloned().collect() }
    }

    fn put(&mut self, mut state: StateDocument) {
        let path = StatePath::parse(&state.path);
        if let Some(earlier) = self.states.remove(&path) {
            (state.transitions, state.data_flows) = (earlier.transitions, earlier.data_flows);
        }
        self.states.insert(path, state);
    }

    fn remove(&mut self, path: &StatePath) {
        let inside = self.states.range(path.clone()..).map(|(inner, _)| inner);
        let inside = inside.take_while(|inner| inner.0.starts_with(&path.0));
        for path in inside.cloned().collect::<Vec<_>>() {
            self.states.remove(&path);
        }
    }
}

/// Inserts, replaces or removes a connection.
fn put<T>(list: &mut Vec<T>, id: i64, id_of: impl Fn(&T) -> i64, new: Option<T>) {
    match (list.binary_search_by_key(&id, &id_of), new) {
        (Ok(index), Some(new)) => list[index] = new,
        (Ok(index), None) => {
            list.remove(index);
        }
        (Err(index), Some(new)) => list.insert(index, new),
        (Err(_), None) => {}
    }
}
