//! Keeps one copy of what many states have in common. Knows equality only.

use rafcon_model::Outcomes;
use std::collections::BTreeSet;
use std::sync::Arc;

/// How many different lists of outcomes are remembered.
const LISTS: usize = 16;

/// The shared copies of one reader thread.
#[derive(Debug, Default)]
pub(crate) struct Interner {
    texts: BTreeSet<Arc<str>>,
    outcomes: Vec<Outcomes>,
}

impl Interner {
    /// The shared copy of `text`.
    pub(crate) fn text(&mut self, text: &str) -> Arc<str> {
        if let Some(shared) = self.texts.get(text) {
            return Arc::clone(shared);
        }
        let shared: Arc<str> = text.into();
        self.texts.insert(Arc::clone(&shared));
        shared
    }

    /// The shared copy of `outcomes`.
    pub(crate) fn outcomes(&mut self, outcomes: Outcomes) -> Outcomes {
        if let Some(shared) = self.outcomes.iter().find(|shared| **shared == outcomes) {
            return shared.clone();
        }
        if self.outcomes.len() < LISTS {
            self.outcomes.push(outcomes.clone());
        }
        outcomes
    }
}
