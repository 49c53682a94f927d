//! Who did what, and what each may take back: one's own last step, unless somebody else built on it. Pure: knows places and
//! authors, nothing of the machine.

use super::merge::Layouts;
use super::places::MachinePlace;
use rafcon_model::Machine;
use rafcon_model::edit::Edit;
use std::collections::{BTreeMap, VecDeque};

/// Older steps can no longer be taken back.
const STEPS_MAX: usize = 10_000;

/// How a step is taken back, or made again.
#[derive(Debug, Clone)]
pub(super) enum StepUndo {
    /// By an edit.
    Edit(Edit),
    /// By another machine: the files were read again.
    Whole(Machine),
}

/// One step of somebody.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) author: String,
    /// For people: "Rename state".
    pub(super) name: String,
    /// What it changed.
    pub(super) places: Vec<MachinePlace>,
    /// The layouts that it left behind.
    pub(super) layouts: Layouts,
    /// Takes it back if it is done, makes it again if not.
    pub(super) way: StepUndo,
}

/// A step and when it was done and undone, in revisions.
#[derive(Debug)]
struct RecordedStep {
    step: Step,
    done_at: u64,
    undone_at: Option<u64>,
}

/// The steps of one author, the last one last.
#[derive(Debug, Default)]
struct OwnSteps {
    done: Vec<u64>,
    undone: Vec<u64>,
}

/// The steps of a machine since it was opened.
#[derive(Debug, Default)]
pub(super) struct Steps {
    kept: VecDeque<RecordedStep>,
    /// The number of the first kept step.
    first: u64,
    authors: BTreeMap<String, OwnSteps>,
}

/// Which way along one's own steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StepDirection {
    /// Take the last one back.
    Undo,
    /// Make the last one again that was taken back.
    Redo,
}

/// Why a step cannot be taken back or made again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum StepRefusal {
    /// There is none.
    Nothing,
    /// Somebody else built on it.
    BuiltUpon {
        /// The step's name.
        step: String,
        /// Who did.
        by: String,
        /// By which step.
        later: String,
        /// At which place.
        place: String,
    },
}

impl Steps {
    /// Remembers a step that was done just now. What its author had taken back can no longer be made again.
    pub(super) fn done(&mut self, step: Step, revision: u64) {
        let own = self.authors.entry(step.author.clone()).or_default();
        own.undone.clear();
        own.done.push(self.first + self.kept.len() as u64);
        self.kept.push_back(RecordedStep { step, done_at: revision, undone_at: None });
        if self.kept.len() > STEPS_MAX {
            self.kept.pop_front();
            self.first += 1;
            self.authors.values_mut().for_each(|own| own.forget(self.first));
        }
    }

    /// The step that an author would take back or make again, and its number.
    pub(super) fn next(
        &self,
        author: &str,
        along: StepDirection,
    ) -> Result<(u64, &Step), StepRefusal> {
        let own = self.authors.get(author).ok_or(StepRefusal::Nothing)?;
        let list = match along {
            StepDirection::Undo => &own.done,
            StepDirection::Redo => &own.undone,
        };
        let number = *list.last().ok_or(StepRefusal::Nothing)?;
        let kept = self.kept(number).ok_or(StepRefusal::Nothing)?;
        self.unless_built_upon(kept)?;
        Ok((number, &kept.step))
    }

    /// The step was taken back or made again, which is `step` from now on.
    pub(super) fn moved(&mut self, number: u64, along: StepDirection, step: Step, revision: u64) {
        let own = self.authors.entry(step.author.clone()).or_default();
        match along {
            StepDirection::Undo => own.undone.extend(own.done.pop()),
            StepDirection::Redo => own.done.extend(own.undone.pop()),
        }
        let index = usize::try_from(number.saturating_sub(self.first)).unwrap_or(usize::MAX);
        if let Some(kept) = self.kept.get_mut(index) {
            kept.step = step;
            match along {
                StepDirection::Undo => kept.undone_at = Some(revision),
                StepDirection::Redo => (kept.done_at, kept.undone_at) = (revision, None),
            }
        }
    }

    fn kept(&self, number: u64) -> Option<&RecordedStep> {
        self.kept.get(usize::try_from(number.checked_sub(self.first)?).ok()?)
    }

    fn unless_built_upon(&self, mine: &RecordedStep) -> Result<(), StepRefusal> {
        let since = mine.undone_at.unwrap_or(mine.done_at);
        let others = self.kept.iter().rev();
        let mut others =
            others.filter(|other| other.step.author != mine.step.author && other.is_new(since));
        let built = others.find_map(|other| {
            let place = mine.step.place_under(&other.step)?;
            Some(StepRefusal::BuiltUpon {
                step: mine.step.name.clone(),
                by: other.step.author.clone(),
                later: other.step.name.clone(),
                place: place.to_string(),
            })
        });
        built.map_or(Ok(()), Err)
    }
}

impl RecordedStep {
    /// Whether it makes a difference to how things stood at a revision: done and undone since then is nothing.
    fn is_new(&self, since: u64) -> bool {
        match self.undone_at {
            None => self.done_at > since,
            Some(undone_at) => undone_at > since && self.done_at <= since,
        }
    }
}

impl Step {
    /// The place of this step that a later one builds upon. Layouts are told apart more finely where they are merged.
    fn place_under(&self, later: &Self) -> Option<&MachinePlace> {
        let is_upon = |place: &&MachinePlace| {
            later.places.iter().any(|later| place.is_built_upon(later) && !place.is_layout(later))
        };
        self.places.iter().find(is_upon)
    }
}

impl OwnSteps {
    fn forget(&mut self, first: u64) {
        self.done.retain(|number| *number >= first);
        self.undone.retain(|number| *number >= first);
    }
}
