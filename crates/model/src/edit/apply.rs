//! The only place where a machine changes: runs the steps of an edit, checks every part that they touch, and undoes them
//! if a rule is broken that was not broken before.

use super::Edit;
use super::error::EditError;
use super::forget::forget_places;
use super::plan::plan;
use super::scope::Walk;
use super::scope::{Place, scope_after, scope_before};
use super::step::{Set, Step};
use crate::rules::{Fault, Part, Rule, errors_of};
use crate::{Machine, StateId, StatePath, Types};
use std::collections::BTreeSet;

/// Undoes an edit by its steps in reverse. May restore faults from before the edit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Restore {
    /// The steps, in this order.
    pub steps: Vec<Step>,
    /// Rules that were broken before the edit.
    pub tolerated: Vec<(StatePath, Part, Rule)>,
}

/// Changes the machine in place, and returns the edit that undoes the change. An error changes nothing.
///
/// No edit breaks a rule of the machine: old faults may stay, but none is added. States that only this
/// machine holds are changed in place; those that it shares with a clone are copied first.
pub fn apply(machine: &mut Machine, edit: Edit, types: &dyn Types) -> Result<Edit, EditError> {
    let mut done = Restore::default();
    match edit_all(machine, edit, types, &mut done) {
        Ok(()) => {
            repair(machine, &done.steps);
            done.steps.reverse();
            Ok(Edit::Restore(Box::new(done)))
        }
        Err(error) => {
            take_back(machine, done.steps);
            Err(error)
        }
    }
}

/// Applies an edit; adds the inverse steps to `done`, even if it is refused in the middle.
fn edit_all(
    machine: &mut Machine,
    edit: Edit,
    types: &dyn Types,
    done: &mut Restore,
) -> Result<(), EditError> {
    match edit {
        Edit::Batch(edits) => {
            edits.into_iter().try_for_each(|edit| edit_all(machine, edit, types, done))
        }
        Edit::Restore(restore) => {
            Run::new(types, restore.tolerated).run(machine, restore.steps, done)
        }
        edit => {
            let steps = forget_places(machine, plan(machine, edit, types)?);
            Run::new(types, Vec::new()).run(machine, steps, done)
        }
    }
}

/// Forgets the damage of states whose `core_data.json` these steps replace.
fn repair(machine: &mut Machine, steps: &[Step]) {
    for step in steps.iter().filter(|step| step.replaces_core()) {
        let is_damaged = machine.state(&step.at).is_some_and(|state| state.damage.is_some());
        if let Some(state) = machine.state_mut(&step.at).filter(|_| is_damaged) {
            state.damage = None;
        }
    }
}

fn take_back(machine: &mut Machine, steps: Vec<Step>) {
    for step in steps.into_iter().rev() {
        let back = step.run(machine);
        debug_assert!(back.is_ok(), "a step that was just made can be taken back");
    }
}

/// A broken rule and its place.
type Known = (StatePath, Part, Rule);

/// The state while the steps of an edit run.
struct Run<'t> {
    types: &'t dyn Types,
    /// The places that the edit may have broken.
    touched: BTreeSet<Place>,
    /// The rules that were broken there before, with repetitions.
    before: Vec<Known>,
    /// Rules that may be broken in addition.
    tolerated: Vec<Known>,
    /// Changed ids: path before, new id.
    renamed: Vec<(StatePath, StateId)>,
}

impl<'t> Run<'t> {
    fn new(types: &'t dyn Types, tolerated: Vec<Known>) -> Self {
        let (touched, before, renamed) = (BTreeSet::new(), Vec::new(), Vec::new());
        Self { types, touched, before, tolerated, renamed }
    }

    fn run(
        mut self,
        machine: &mut Machine,
        steps: Vec<Step>,
        done: &mut Restore,
    ) -> Result<(), EditError> {
        for step in steps {
            let mut walk = Walk::new(machine);
            for place in scope_before(&step, &mut walk) {
                self.touch(&mut walk, place);
            }
            if let Set::Id(id) = &step.set {
                self.rename(&step.at, id);
            }
            let back = step.run(machine)?;
            self.touched.extend(scope_after(&back, &mut Walk::new(machine)));
            done.steps.push(back);
        }
        self.check(machine)?;
        done.tolerated.extend(self.before_by_old_names());
        Ok(())
    }

    /// Notes a place and the rules broken there, unless it is noted already.
    fn touch(&mut self, walk: &mut Walk<'_>, place: Place) {
        if self.touched.contains(&place) {
            return;
        }
        let faults = faults_at(walk, &place, self.types);
        self.before.extend(faults.into_iter().map(|f| (place.0.clone(), place.1, f.rule)));
        self.touched.insert(place);
    }

    /// Updates the notes after a change of a state's id.
    fn rename(&mut self, path: &StatePath, id: &StateId) {
        let renamed = |at: StatePath| with_new_id(at, path, id);
        let touched = std::mem::take(&mut self.touched);
        self.touched = touched.into_iter().map(|(at, part)| (renamed(at), part)).collect();
        let before = std::mem::take(&mut self.before);
        self.before =
            before.into_iter().map(|(at, part, rule)| (renamed(at), part, rule)).collect();
        self.renamed.push((path.clone(), id.clone()));
    }

    fn check(&self, machine: &Machine) -> Result<(), EditError> {
        let mut walk = Walk::new(machine);
        for place in &self.touched {
            let faults = faults_at(&mut walk, place, self.types);
            for (index, fault) in faults.iter().enumerate() {
                let rule = fault.rule;
                let count = faults[..=index].iter().filter(|f| f.rule == rule).count();
                if rule.refuses_edits() && count > self.allowed(&(place.0.clone(), place.1, rule)) {
                    return Err(EditError::fault(&place.0, place.1, fault.clone()));
                }
            }
        }
        Ok(())
    }

    /// Number of permitted violations of a rule at a place.
    fn allowed(&self, known: &Known) -> usize {
        let count = |list: &[Known]| list.iter().filter(|other| *other == known).count();
        count(&self.before).max(count(&self.tolerated))
    }

    /// The rules broken before, under the ids of that time.
    fn before_by_old_names(mut self) -> impl Iterator<Item = Known> {
        self.renamed.reverse();
        let renamed = self.renamed;
        self.before.into_iter().map(move |(at, part, rule)| {
            let old = |at, (path, id): &(StatePath, StateId)| match (path.parent(), path.last()) {
                (Some(parent), Some(old)) => with_new_id(at, &parent.child(id.clone()), old),
                (None, Some(old)) => with_new_id(at, &StatePath::root(id.clone()), old),
                _ => at,
            };
            (renamed.iter().fold(at, old), part, rule)
        })
    }
}

/// The path after a change of the id of the state at `path`.
fn with_new_id(mut at: StatePath, path: &StatePath, id: &StateId) -> StatePath {
    if at.0.starts_with(&path.0)
        && let Some(index) = path.0.len().checked_sub(1)
    {
        at.0[index] = id.clone();
    }
    at
}

fn faults_at(walk: &mut Walk<'_>, (path, part): &Place, types: &dyn Types) -> Vec<Fault> {
    let found = walk.find(&path.0);
    found.map_or_else(Vec::new, |(parent, state)| errors_of(parent, state, *part, types))
}
