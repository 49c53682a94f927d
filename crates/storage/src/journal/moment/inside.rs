//! What happened in one run of a container, as far as it matters for what comes next and for steps back: how its children
//! ended and what its scoped variables were, in order.
//!
//! Knows one container. Must never know which states are active.

use crate::journal::record::{Kept, PlaceNumber};
use std::collections::{BTreeMap, VecDeque};

/// Deeper nests of ended containers are forgotten from the bottom: dropping them must not take the whole stack.
const DEPTH_MAX: usize = 200;

/// The inside of a container: what is too old to be undone, and the steps since.
#[derive(Debug, Clone, Default)]
pub(super) struct Inside {
    scoped: BTreeMap<u64, ScopedValue>,
    ended: BTreeMap<PlaceNumber, End>,
    steps: VecDeque<Step>,
    /// Ends here and in the containers that ended here.
    weight: usize,
    /// Levels of containers in it that ended.
    depth: usize,
    /// How many ends are open.
    open: usize,
    /// A step was just undone: what is now said about variables, they have already.
    undone: bool,
}

#[derive(Debug, Clone)]
pub(super) enum Step {
    Scoped(u64, ScopedValue),
    End(End),
}

/// The value of a scoped variable.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ScopedValue {
    pub(super) value: Kept,
    pub(super) order: u64,
}

/// How a child ended.
#[derive(Debug, Clone)]
pub(super) struct End {
    pub(super) place: PlaceNumber,
    /// The record that it was entered by; that by which it ended if it was skipped.
    pub(super) entered: u64,
    pub(super) inputs: Vec<Kept>,
    pub(super) outcome: i64,
    pub(super) outputs: Vec<Kept>,
    pub(super) error: Option<Kept>,
    pub(super) order: u64,
    /// What was in it, if it was a container.
    pub(super) inside: Option<Box<Inside>>,
    /// It was entered backwards and has not been left since.
    pub(super) is_open: bool,
}

impl End {
    /// Whether it ended without having begun.
    fn is_skipped(&self) -> bool {
        self.entered == self.order
    }

    fn weight(&self) -> usize {
        1 + self.inside.as_ref().map_or(0, |inside| inside.weight)
    }

    fn depth(&self) -> usize {
        self.inside.as_ref().map_or(0, |inside| inside.depth + 1)
    }
}

impl Inside {
    /// Whether a step was just undone.
    pub(super) fn is_undone(&self) -> bool {
        self.undone
    }

    /// As it was when a step was just undone.
    pub(super) fn set_undone(&mut self) {
        self.undone = true;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.steps.is_empty() && self.scoped.is_empty() && self.ended.is_empty()
    }

    /// Something begins or ends: what is said about variables from here on is new.
    pub(super) fn begin(&mut self) {
        self.undone = false;
    }

    /// A variable got a value. After a step back it may have that value already; it is then as old as it was.
    pub(super) fn set(&mut self, port: u64, variable: ScopedValue) {
        if self.undone && self.scoped().get(&port).is_some_and(|now| now.value == variable.value) {
            return;
        }
        self.push(Step::Scoped(port, variable));
    }

    /// A child ended.
    pub(super) fn end(&mut self, mut end: End) {
        if end.depth() > DEPTH_MAX
            && let Some(inside) = &mut end.inside
        {
            inside.forget_insides();
        }
        self.depth = self.depth.max(end.depth());
        let Some(index) = self.find_open(end.place) else { return self.push(Step::End(end)) };
        self.open -= 1;
        self.weight += end.weight();
        if let Some(old) = self.steps.get_mut(index) {
            let old = std::mem::replace(old, Step::End(end));
            self.weight -= weight(&old);
        }
    }

    /// A child is entered backwards: gives back how it ended, with what was in it.
    pub(super) fn reopen(&mut self, place: PlaceNumber) -> Option<End> {
        let end = self.steps.iter_mut().rev().find_map(|step| match step {
            Step::End(end) if end.place == place && !end.is_open => Some(end),
            _ => None,
        })?;
        let inside = end.inside.take();
        end.is_open = true;
        self.open += 1;
        self.weight -= inside.as_ref().map_or(0, |inside| inside.weight);
        Some(End { inside, ..end.clone() })
    }

    /// A child is left backwards: everything is as it was before it began. What other branches did since stays.
    pub(super) fn undo(&mut self, place: PlaceNumber, is_decider: impl Fn(PlaceNumber) -> bool) {
        self.undone = true;
        let Some(index) = self.find_open(place) else { return };
        self.open -= 1;
        let others = self.steps.iter().skip(index + 1).any(
            |step| matches!(step, Step::End(end) if end.place != place && !is_decider(end.place)),
        );
        let gone = if others {
            self.steps.remove(index).into_iter().collect()
        } else {
            self.steps.split_off(index)
        };
        self.weight -= gone.iter().map(weight).sum::<usize>();
    }

    /// The child is as if it had not been skipped, if that is how it ended last.
    pub(super) fn forget_skipped(&mut self, place: PlaceNumber) {
        let is_end = |step: &Step| matches!(step, Step::End(end) if end.place == place);
        let Some(index) = self.steps.iter().rposition(is_end) else {
            if self.ended.get(&place).is_some_and(End::is_skipped) {
                self.ended.remove(&place);
            }
            return;
        };
        if matches!(&self.steps[index], Step::End(end) if end.is_skipped()) {
            let gone = self.steps.remove(index);
            self.weight -= gone.iter().map(weight).sum::<usize>();
        }
    }

    /// How many ends can be undone, with those in containers that ended here.
    pub(super) fn weight(&self) -> usize {
        self.weight
    }

    /// Makes the oldest step one that cannot be undone any more; false if there is none.
    pub(super) fn settle_oldest(&mut self) -> bool {
        match self.steps.front() {
            None | Some(Step::End(End { is_open: true, .. })) => return false,
            Some(step) => self.weight -= weight(step),
        }
        match self.steps.pop_front() {
            Some(Step::Scoped(port, variable)) => {
                self.scoped.insert(port, variable);
            }
            Some(Step::End(end)) => {
                self.ended.insert(end.place, End { inside: None, ..end });
            }
            None => {}
        }
        true
    }

    /// The variables as they are now, by port.
    pub(super) fn scoped(&self) -> BTreeMap<u64, &ScopedValue> {
        let mut now: BTreeMap<u64, &ScopedValue> =
            self.scoped.iter().map(|(p, v)| (*p, v)).collect();
        now.extend(self.steps.iter().filter_map(|step| match step {
            Step::Scoped(port, variable) => Some((*port, variable)),
            Step::End(_) => None,
        }));
        now
    }

    /// How each child ended last.
    pub(super) fn ended(&self) -> BTreeMap<PlaceNumber, &End> {
        let mut now: BTreeMap<PlaceNumber, &End> =
            self.ended.iter().map(|(place, end)| (*place, end)).collect();
        now.extend(self.ends().map(|end| (end.place, end)));
        now
    }

    /// The child that ended last.
    pub(super) fn last(&self) -> Option<PlaceNumber> {
        let old = || self.ended.values().max_by_key(|end| end.order);
        self.ends().next_back().or_else(old).map(|end| end.place)
    }

    /// Whether this child was entered backwards and has not been left since.
    pub(super) fn is_open(&self, place: PlaceNumber) -> bool {
        self.find_open(place).is_some()
    }

    /// Everything, the oldest first.
    pub(super) fn all(&self) -> Vec<Step> {
        let scoped =
            self.scoped.iter().map(|(port, variable)| Step::Scoped(*port, variable.clone()));
        let ended = self.ended.values().cloned().map(Step::End);
        let mut all: Vec<Step> = scoped.chain(ended).collect();
        all.sort_by_key(|step| match step {
            Step::Scoped(_, variable) => variable.order,
            Step::End(end) => end.order,
        });
        all.extend(self.steps.iter().cloned());
        all
    }

    fn ends(&self) -> impl DoubleEndedIterator<Item = &End> {
        self.steps.iter().filter_map(|step| match step {
            Step::End(end) => Some(end),
            Step::Scoped(..) => None,
        })
    }

    fn find_open(&self, place: PlaceNumber) -> Option<usize> {
        if self.open == 0 {
            return None;
        }
        let is_open =
            |step: &Step| matches!(step, Step::End(end) if end.is_open && end.place == place);
        self.steps.iter().rposition(is_open)
    }

    fn push(&mut self, step: Step) {
        self.weight += weight(&step);
        self.steps.push_back(step);
    }

    fn forget_insides(&mut self) {
        for step in &mut self.steps {
            if let Step::End(end) = step {
                end.inside = None;
            }
        }
        (self.weight, self.depth) = (self.ends().count(), 0);
    }
}

fn weight(step: &Step) -> usize {
    match step {
        Step::Scoped(..) => 0,
        Step::End(end) => end.weight(),
    }
}
