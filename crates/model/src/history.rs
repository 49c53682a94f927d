//! Undo and redo: a tree of edits and the current position in it. Knows how to undo and redo
//! edits; never who made them.

use crate::edit::{Edit, EditError, apply};
use crate::{Machine, Types};
use smol_str::SmolStr;

/// The edits of a machine, step by step. Undone steps stay as a branch when another edit follows.
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
    /// The last step that is done; `None` if no step is done.
    current: Option<StepId>,
    /// The step that redo applies at the beginning.
    first: Option<StepId>,
}

/// The number of a step in a [`History`], in the order of the edits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StepId(pub usize);

/// An edit of a [`History`], done or undone.
#[derive(Debug, Clone)]
pub struct HistoryStep {
    /// The previous step; `None` at the beginning.
    pub parent: Option<StepId>,
    /// For people: "Rename state".
    pub name: SmolStr,
    /// Undoes the step if it is done, redoes it if not.
    edit: Edit,
    /// The step that redo applies from here: the last one done or undone.
    next: Option<StepId>,
}

impl History {
    /// Applies an edit and adds it under a name. A refused edit adds no step.
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

    /// Adds an edit that is already applied, by its inverse.
    pub fn record(&mut self, name: impl AsRef<str>, back: Edit) -> StepId {
        let id = StepId(self.steps.len());
        let (parent, name) = (self.current, SmolStr::new(name));
        self.steps.push(HistoryStep { parent, name, edit: back, next: None });
        self.set_next(parent, id);
        self.current = Some(id);
        id
    }

    /// Undoes the current step; `None` if there is none. Refused if other changes of the machine prevent
    /// it.
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

    /// Redoes the last undone step; `None` if there is none.
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

    /// The name of the step that undo would undo.
    pub fn undo_name(&self) -> Option<&str> {
        self.current.and_then(|id| self.step(id)).map(|step| step.name.as_str())
    }

    /// The name of the step that redo would redo.
    pub fn redo_name(&self) -> Option<&str> {
        self.next().and_then(|id| self.step(id)).map(|step| step.name.as_str())
    }

    /// The step that undo would undo; `None` if there is none.
    pub fn current(&self) -> Option<StepId> {
        self.current
    }

    /// The step with this number; `None` if it does not exist.
    pub fn step(&self, id: StepId) -> Option<&HistoryStep> {
        self.steps.get(id.0)
    }

    /// All steps, including those on branches, in the order of the edits.
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

    /// Applies the edit of a step, and replaces it by its inverse.
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
