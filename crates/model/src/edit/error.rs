//! Reasons of refused edits.

use crate::problems::Problem;
use crate::rules::{Fault, Part, Rule};
use crate::{OutcomeId, StatePath};

/// A refusal: what, where and the remedy. Nothing has changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}, {part}: {what}; {}", .rule.way_out())]
pub struct EditError {
    /// Path of the state that the rule is about, even if no such state exists.
    pub path: StatePath,
    /// The part of the state.
    pub part: Part,
    /// The rule that forbids the edit.
    pub rule: Rule,
    /// The fault, for the user.
    pub what: String,
}

impl EditError {
    pub(super) fn new(path: &StatePath, part: Part, rule: Rule, what: impl Into<String>) -> Self {
        Self { path: path.clone(), part, rule, what: what.into() }
    }

    /// A refusal about a state as a whole.
    pub(super) fn state(path: &StatePath, rule: Rule, what: impl Into<String>) -> Self {
        Self::new(path, Part::State, rule, what)
    }

    pub(super) fn fault(path: &StatePath, part: Part, fault: Fault) -> Self {
        Self { path: path.clone(), part, rule: fault.rule, what: fault.what }
    }

    pub(super) fn no_such_state(path: &StatePath) -> Self {
        Self::state(path, Rule::NoSuchState, "there is no such state")
    }

    pub(super) fn no_such_element(path: &StatePath, part: Part) -> Self {
        Self::new(path, part, Rule::NoSuchElement, "it does not exist")
    }

    pub(super) fn taken(path: &StatePath, part: Part) -> Self {
        Self::new(path, part, Rule::IdTaken, "something else has this id")
    }

    pub(super) fn mandatory(path: &StatePath, id: OutcomeId) -> Self {
        let what = "every state has this outcome";
        Self::new(path, Part::Outcome(id), Rule::OutcomeMandatory, what)
    }

    /// The remedy for the user.
    pub fn way_out(&self) -> &'static str {
        self.rule.way_out()
    }
}

impl From<Problem> for EditError {
    fn from(problem: Problem) -> Self {
        let Problem { path, part, rule, what } = problem;
        Self { path, part, rule, what }
    }
}
