//! History of one execution of a container, to the extent that later events and steps back depend on it: ends of children and
//! values of scoped variables, in order.
//!
//! Handles one container. Does not know which states are active.

use crate::journal::record::{Kept, PlaceNumber};
use std::collections::{BTreeMap, VecDeque};

/// Maximum nesting of ended containers. Deeper levels are dropped, so that freeing them cannot overflow the stack.
const DEPTH_MAX: usize = 200;

/// Inside of a container: the result of steps that are too old to undo, and the steps since.
#[derive(Debug, Clone, Default)]
pub(super) struct Inside {
    scoped: BTreeMap<u64, ValueAt>,
    ended: BTreeMap<PlaceNumber, End>,
    steps: VecDeque<Step>,
    /// Number of ends here and in the containers that ended here.
    weight: usize,
    /// Nesting depth of ended containers in it.
    depth: usize,
    /// Number of open ends.
    open: usize,
    /// True if a step was just undone: the values recorded now are those that the variables already have.
    undone: bool,
}

#[derive(Debug, Clone)]
pub(super) enum Step {
    Scoped(u64, ValueAt),
    End(End),
}

/// Value of a scoped variable.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ValueAt {
    pub(super) value: Kept,
    pub(super) order: u64,
}

/// The end of a child.
#[derive(Debug, Clone)]
pub(super) struct End {
    pub(super) place: PlaceNumber,
    /// Record of its entry. For a skipped child, the record of its end.
    pub(super) entered: u64,
    pub(super) inputs: Vec<Kept>,
    pub(super) outcome: i64,
    pub(super) outputs: Vec<Kept>,
    pub(super) error: Option<Kept>,
    pub(super) order: u64,
    /// Inside of the child, if it was a container.
    pub(super) inside: Option<Box<Inside>>,
    /// True if the child was entered backwards and has not been left since.
    pub(super) is_open: bool,
}

impl End {
    /// Returns true if the state was skipped.
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
    /// Returns true if a step was just undone.
    pub(super) fn is_undone(&self) -> bool {
        self.undone
    }

    /// Records that a step was just undone.
    pub(super) fn set_undone(&mut self) {
        self.undone = true;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.steps.is_empty() && self.scoped.is_empty() && self.ended.is_empty()
    }

    /// A state starts or ends. Values recorded from here on are new.
    pub(super) fn begin(&mut self) {
        self.undone = false;
    }

    /// Sets a variable. After a step back it may already have this value. Its order is then kept.
    pub(super) fn set(&mut self, port: u64, variable: ValueAt) {
        if self.undone && self.scoped().get(&port).is_some_and(|now| now.value == variable.value) {
            return;
        }
        self.push(Step::Scoped(port, variable));
    }

    /// Adds the end of a child.
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

    /// Enters a child backwards. Returns its last end with its inside.
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

    /// Leaves a child backwards: restores the state before its entry. Later steps of other branches are kept.
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

    /// Removes the last end of the child if it was skipped.
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

    /// Returns the number of ends that can be undone, including those in containers that ended here.
    pub(super) fn weight(&self) -> usize {
        self.weight
    }

    /// Makes the oldest step permanent. Returns false if there are no steps.
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

    /// Returns the current variables by port.
    pub(super) fn scoped(&self) -> BTreeMap<u64, &ValueAt> {
        let mut now: BTreeMap<u64, &ValueAt> = self.scoped.iter().map(|(p, v)| (*p, v)).collect();
        now.extend(self.steps.iter().filter_map(|step| match step {
            Step::Scoped(port, variable) => Some((*port, variable)),
            Step::End(_) => None,
        }));
        now
    }

    /// Returns the last end of each child.
    pub(super) fn ended(&self) -> BTreeMap<PlaceNumber, &End> {
        let mut now: BTreeMap<PlaceNumber, &End> =
            self.ended.iter().map(|(place, end)| (*place, end)).collect();
        now.extend(self.ends().map(|end| (end.place, end)));
        now
    }

    /// Returns the child that ended last.
    pub(super) fn last(&self) -> Option<PlaceNumber> {
        let old = || self.ended.values().max_by_key(|end| end.order);
        self.ends().next_back().or_else(old).map(|end| end.place)
    }

    /// Returns true if this child was entered backwards and has not been left since.
    pub(super) fn is_open(&self, place: PlaceNumber) -> bool {
        self.find_open(place).is_some()
    }

    /// Returns all permanent results and steps, the oldest first.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(order: u64, inside: Option<Box<Inside>>) -> End {
        let (inputs, outputs) = (Vec::new(), Vec::new());
        let place = PlaceNumber(0);
        let (entered, outcome, error, is_open) = (order, 0, None, false);
        End { place, entered, inputs, outcome, outputs, error, order, inside, is_open }
    }

    /// Creates containers that ended inside each other, with this number of levels.
    fn nested(levels: u64) -> Inside {
        let mut inside = Inside::default();
        for level in 0..=levels {
            let mut around = Inside::default();
            around.end(ended(level, (level > 0).then(|| Box::new(inside))));
            inside = around;
        }
        inside
    }

    /// Counts the nested levels.
    fn depth(inside: &Inside) -> usize {
        let inner = inside.ends().next().and_then(|end| end.inside.as_deref());
        inner.map_or(0, |inside| 1 + depth(inside))
    }

    #[test]
    fn containers_that_ended_too_deep_lose_what_is_in_them_and_others_nest_on() {
        for (levels, kept) in [(200, 200), (201, 1), (210, 10)] {
            let inside = nested(levels);
            assert_eq!((depth(&inside), inside.weight()), (kept, kept + 1), "{levels} levels");
        }
        assert!(depth(&nested(100_000)) <= DEPTH_MAX);
    }
}
