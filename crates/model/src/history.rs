//! Undo and redo: a tree of edits and the place in it where the machine is now. Knows how to take edits back and make them
//! again; never who made them.

use crate::edit::{Edit, EditError, apply};
use crate::{Machine, Types};
use smol_str::SmolStr;

/// What was done to a machine, step by step. Steps that were undone stay as a branch when something else is done instead.
///
/// ```
/// use rafcon_model::edit::{Edit, StateEdit};
/// use rafcon_model::{BuiltinTypes, History, StatePath};
/// use rafcon_testkit::notation;
///
/// let mut machine = notation::parse("execution ROOT")?;
/// let mut history = History::default();
/// let rename = Edit::State(StatePath::parse("ROOT"), StateEdit::SetName("New".into()));
/// history.apply(&mut machine, "Rename", rename, &BuiltinTypes)?;
/// assert_eq!(history.undo_name(), Some("Rename"));
/// history.undo(&mut machine, &BuiltinTypes)?;
/// assert_eq!(machine.root.name, "ROOT");
/// history.redo(&mut machine, &BuiltinTypes)?;
/// assert_eq!(machine.root.name, "New");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct History {
    steps: Vec<HistoryStep>,
    /// The last step that is done.
    current: Option<StepId>,
    /// Where redo goes from the very beginning.
    first: Option<StepId>,
}

/// A step in a [`History`], counted in the order in which they were done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StepId(pub usize);

/// One named step.
#[derive(Debug, Clone)]
pub struct HistoryStep {
    /// The step before; `None` for one from the very beginning.
    pub parent: Option<StepId>,
    /// For people: "Rename state".
    pub name: SmolStr,
    /// Takes the step back if it is done, makes it again if not.
    edit: Edit,
    /// Where redo goes from here: the step that was done or undone last.
    next: Option<StepId>,
}

impl History {
    /// Applies an edit and remembers it under a name. A refused edit leaves no step.
    pub fn apply(
        &mut self,
        machine: &mut Machine,
        name: impl AsRef<str>,
        edit: Edit,
        types: &dyn Types,
    ) -> Result<StepId, EditError> {
        let back = apply(machine, edit, types)?;
        Ok(self.record(name, back))
    }

    /// Remembers an edit that was applied already, by what takes it back.
    pub fn record(&mut self, name: impl AsRef<str>, back: Edit) -> StepId {
        let id = StepId(self.steps.len());
        let (parent, name) = (self.current, SmolStr::new(name));
        self.steps.push(HistoryStep { parent, name, edit: back, next: None });
        self.set_next(parent, id);
        self.current = Some(id);
        id
    }

    /// Takes the last step back; `None` if there is none. Refused if others have changed the machine so that it cannot be
    /// taken back.
    pub fn undo(
        &mut self,
        machine: &mut Machine,
        types: &dyn Types,
    ) -> Result<Option<StepId>, EditError> {
        let Some(id) = self.current else { return Ok(None) };
        self.swap(machine, id, types)?;
        self.current = self.step(id).and_then(|step| step.parent);
        self.set_next(self.current, id);
        Ok(Some(id))
    }

    /// Makes the step again that was undone last; `None` if there is none.
    pub fn redo(
        &mut self,
        machine: &mut Machine,
        types: &dyn Types,
    ) -> Result<Option<StepId>, EditError> {
        let Some(id) = self.next() else { return Ok(None) };
        self.swap(machine, id, types)?;
        self.current = Some(id);
        Ok(Some(id))
    }

    /// The name of the step that undo takes back.
    pub fn undo_name(&self) -> Option<&str> {
        self.current.and_then(|id| self.step(id)).map(|step| step.name.as_str())
    }

    /// The name of the step that redo makes again.
    pub fn redo_name(&self) -> Option<&str> {
        self.next().and_then(|id| self.step(id)).map(|step| step.name.as_str())
    }

    /// The last step that is done.
    pub fn current(&self) -> Option<StepId> {
        self.current
    }

    /// A step.
    pub fn step(&self, id: StepId) -> Option<&HistoryStep> {
        self.steps.get(id.0)
    }

    /// All steps, also those on branches, in the order in which they were done.
    pub fn steps(&self) -> impl Iterator<Item = (StepId, &HistoryStep)> {
        self.steps.iter().enumerate().map(|(index, step)| (StepId(index), step))
    }

    fn next(&self) -> Option<StepId> {
        match self.current {
            Some(id) => self.step(id)?.next,
            None => self.first,
        }
    }

    fn set_next(&mut self, parent: Option<StepId>, next: StepId) {
        match parent {
            Some(parent) => {
                if let Some(step) = self.steps.get_mut(parent.0) {
                    step.next = Some(next);
                }
            }
            None => self.first = Some(next),
        }
    }

    /// Applies the edit of a step, and keeps in its place what takes that back.
    fn swap(
        &mut self,
        machine: &mut Machine,
        id: StepId,
        types: &dyn Types,
    ) -> Result<(), EditError> {
        if let Some(step) = self.steps.get_mut(id.0) {
            step.edit = apply(machine, step.edit.clone(), types)?;
        }
        Ok(())
    }
}
