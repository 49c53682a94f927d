//! Finds the library contents that a machine shares, so that each is printed once.

use crate::{Kind, LibraryContent, State};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The contents that several library states share, by address.
pub(super) struct Shared<'m> {
    uses: BTreeMap<*const State, usize>,
    names: BTreeMap<*const State, String>,
    /// The contents with a name, each after those that it contains.
    pub(super) order: Vec<&'m Arc<State>>,
}

enum SharedStep<'m> {
    Look(&'m State),
    Leave(&'m Arc<State>),
}

impl<'m> Shared<'m> {
    pub(super) fn of(root: &'m State) -> Self {
        let mut shared = Self { uses: BTreeMap::new(), names: BTreeMap::new(), order: Vec::new() };
        let mut left = Vec::new();
        let mut steps = vec![SharedStep::Look(root)];
        while let Some(step) = steps.pop() {
            match step {
                SharedStep::Look(state) => shared.look(state, &mut steps),
                SharedStep::Leave(content) => left.push(content),
            }
        }
        left.retain(|content| shared.uses.get(&Arc::as_ptr(content)).is_some_and(|n| *n > 1));
        for (index, content) in left.iter().enumerate() {
            shared.names.insert(Arc::as_ptr(content), format!("L{}", index + 1));
        }
        shared.order = left;
        shared
    }

    fn look(&mut self, state: &'m State, steps: &mut Vec<SharedStep<'m>>) {
        if let Some(container) = state.container() {
            steps.extend(container.states.values().rev().map(|child| SharedStep::Look(child)));
        }
        let Some(content) = content(state) else { return };
        let uses = self.uses.entry(Arc::as_ptr(content)).or_default();
        *uses += 1;
        if *uses == 1 {
            steps.push(SharedStep::Leave(content));
            steps.push(SharedStep::Look(content));
        }
    }

    /// The name of a content that several states share.
    pub(super) fn name(&self, content: &Arc<State>) -> Option<&str> {
        self.names.get(&Arc::as_ptr(content)).map(String::as_str)
    }
}

/// The content of a library state, if the library was found.
pub(super) fn content(state: &State) -> Option<&Arc<State>> {
    match &state.kind {
        Kind::Library(library) => match &library.content {
            LibraryContent::Found(root) => Some(root),
            LibraryContent::Missing { .. } => None,
        },
        Kind::Execution(_)
        | Kind::Decider(_)
        | Kind::Hierarchy(_)
        | Kind::Barrier(_)
        | Kind::Preemptive(_) => None,
    }
}
