//! The transitions of a container, found by id, by origin and by target.

use crate::ids;
use crate::sorted::{MANY, Sorted};
use crate::{Origin, OutcomeId, StateId, Transition, TransitionId};
use imbl::OrdSet;
use std::sync::Arc;

/// The transitions of one container. Cloning shares everything.
#[derive(Debug, Clone, Default)]
pub struct Transitions {
    by_id: Sorted<TransitionId, Transition>,
    /// Indexes, only for many transitions.
    index: Option<Arc<TransitionIndex>>,
}

type TransitionEnd = (Option<StateId>, Option<OutcomeId>);

#[derive(Debug, Clone, Default)]
struct TransitionIndex {
    by_origin: OrdSet<(TransitionEnd, TransitionId)>,
    by_target: OrdSet<(TransitionEnd, TransitionId)>,
}

impl PartialEq for Transitions {
    fn eq(&self, other: &Self) -> bool {
        self.by_id == other.by_id
    }
}

impl Transitions {
    /// All, sorted by id.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Transition> {
        self.by_id.values()
    }

    /// The number of transitions.
    pub fn len(&self) -> usize {
        self.by_id.len()
    }

    /// True if there are no transitions.
    pub fn is_empty(&self) -> bool {
        self.by_id.is_empty()
    }

    /// The transition with this id.
    pub fn get(&self, id: TransitionId) -> Option<&Transition> {
        self.by_id.get(&id)
    }

    /// The ids of transitions that differ in `newer`, or exist in only one of both.
    pub fn differing(&self, newer: &Self) -> Vec<TransitionId> {
        self.by_id.differing(&newer.by_id)
    }

    /// Those that begin at `origin`: at most one in a valid container.
    pub fn from<'s>(&'s self, origin: &Origin) -> impl Iterator<Item = &'s Transition> + use<'s> {
        let end = match origin {
            Origin::Income => (None, None),
            Origin::Outcome(state, outcome) => (Some(state.clone()), Some(*outcome)),
        };
        let wanted = end.clone();
        let few = self.few().filter(move |transition| origin_of(transition) == wanted);
        few.chain(self.many(|index| &index.by_origin, end.clone(), end))
    }

    /// Those that lead to this child, or to any outcome of the container if `state` is its id.
    pub fn into_state<'s>(
        &'s self,
        state: &StateId,
    ) -> impl Iterator<Item = &'s Transition> + use<'s> {
        let wanted = state.clone();
        let few =
            self.few().filter(move |transition| transition.to_state.as_ref() == Some(&wanted));
        few.chain(self.many(|index| &index.by_target, lowest(state), highest(state)))
    }

    /// Those that lead to this outcome of the container with the id `container`.
    pub fn into_outcome<'s>(
        &'s self,
        container: &StateId,
        outcome: OutcomeId,
    ) -> impl Iterator<Item = &'s Transition> + use<'s> {
        let end = (Some(container.clone()), Some(outcome));
        let wanted = end.clone();
        let few = self.few().filter(move |transition| target_of(transition) == wanted);
        few.chain(self.many(|index| &index.by_target, end.clone(), end))
    }

    /// Those that begin at any outcome of `state`.
    pub fn out_of_state<'s>(
        &'s self,
        state: &StateId,
    ) -> impl Iterator<Item = &'s Transition> + use<'s> {
        let wanted = state.clone();
        let few =
            self.few().filter(move |transition| transition.from_state.as_ref() == Some(&wanted));
        few.chain(self.many(|index| &index.by_origin, lowest(state), highest(state)))
    }

    /// All, while they are too few for an index.
    fn few(&self) -> impl Iterator<Item = &Transition> {
        let all = self.index.is_none().then(|| self.by_id.values());
        all.into_iter().flatten()
    }

    /// Those between two keys of an index, if there is one.
    fn many<'s>(
        &'s self,
        pick: fn(&'s TransitionIndex) -> &'s OrdSet<(TransitionEnd, TransitionId)>,
        low: TransitionEnd,
        high: TransitionEnd,
    ) -> impl Iterator<Item = &'s Transition> {
        let range = (low, TransitionId(i64::MIN))..=(high, TransitionId(i64::MAX));
        let keys = self.index.as_deref().map(|index| pick(index).range(range));
        keys.into_iter().flatten().filter_map(|(_, id)| self.by_id.get(id))
    }

    /// Inserts a transition, and returns the one that had its id.
    pub fn insert(&mut self, transition: Transition) -> Option<Transition> {
        let id = transition.id;
        let keys = (origin_of(&transition), target_of(&transition));
        let earlier = self.by_id.insert(id, transition);
        if let Some(index) = self.index.as_mut().map(Arc::make_mut) {
            if let Some(earlier) = &earlier {
                index.remove(earlier);
            }
            index.by_origin.insert((keys.0, id));
            index.by_target.insert((keys.1, id));
        } else if self.by_id.len() >= MANY {
            self.index = Some(Arc::new(TransitionIndex::of(self.by_id.values())));
        }
        earlier
    }

    /// Removes the transition with this id.
    pub fn remove(&mut self, id: TransitionId) -> Option<Transition> {
        let transition = self.by_id.remove(&id)?;
        if self.by_id.len() < MANY / 2 {
            self.index = None;
        } else if let Some(index) = self.index.as_mut().map(Arc::make_mut) {
            index.remove(&transition);
        }
        Some(transition)
    }

    /// The next free id: above all used ids, 1 at first.
    pub fn next_id(&self) -> TransitionId {
        self.free_ids().next().unwrap_or(TransitionId(0))
    }

    /// The next free ids.
    pub fn free_ids(&self) -> impl Iterator<Item = TransitionId> {
        let last = self.by_id.last().map(|(id, _)| id.0);
        ids::free_ids(last, |id| self.by_id.contains_key(&TransitionId(id))).map(TransitionId)
    }
}

impl TransitionIndex {
    fn of<'t>(transitions: impl Iterator<Item = &'t Transition> + Clone) -> Self {
        Self {
            by_origin: transitions.clone().map(|t| (origin_of(t), t.id)).collect(),
            by_target: transitions.map(|t| (target_of(t), t.id)).collect(),
        }
    }

    fn remove(&mut self, transition: &Transition) {
        self.by_origin.remove(&(origin_of(transition), transition.id));
        self.by_target.remove(&(target_of(transition), transition.id));
    }
}

fn origin_of(transition: &Transition) -> TransitionEnd {
    (transition.from_state.clone(), transition.from_outcome)
}

fn target_of(transition: &Transition) -> TransitionEnd {
    (transition.to_state.clone(), transition.to_outcome)
}

fn lowest(state: &StateId) -> TransitionEnd {
    (Some(state.clone()), None)
}

fn highest(state: &StateId) -> TransitionEnd {
    (Some(state.clone()), Some(OutcomeId(i64::MAX)))
}

impl FromIterator<Transition> for Transitions {
    fn from_iter<I: IntoIterator<Item = Transition>>(items: I) -> Self {
        let mut transitions = Self::default();
        for transition in items {
            transitions.insert(transition);
        }
        transitions
    }
}

#[cfg(test)]
mod tests {
    use super::Transitions;
    use crate::{Origin, OutcomeId, StateId, Transition, TransitionId};
    use proptest::prelude::*;

    fn state(number: u8) -> Option<StateId> {
        (number > 0).then(|| StateId::new(format!("S{number}")))
    }

    prop_compose! {
        fn a_transition()(id in 1..80i64, from in 0..4u8, outcome in 0..3i64, to in 0..4u8) -> Transition {
            Transition {
                id: TransitionId(id),
                from_state: state(from),
                from_outcome: (outcome > 0).then_some(OutcomeId(outcome)),
                to_state: state(to),
                to_outcome: None,
                extra: None,
            }
        }
    }

    proptest! {
        /// The lists by origin, source and target equal those of a scan of all transitions, with an index and without.
        #[test]
        fn every_list_is_complete(steps in proptest::collection::vec((a_transition(), 0..3u8), 0..160)) {
            let mut transitions = Transitions::default();
            for (transition, step) in steps {
                if step == 0 {
                    transitions.remove(transition.id);
                } else {
                    transitions.insert(transition);
                }
            }
            let ids = |found: Vec<&Transition>| {
                let mut ids: Vec<_> = found.iter().map(|t| t.id).collect();
                ids.sort();
                ids
            };
            let each = |test: &dyn Fn(&Transition) -> bool| ids(transitions.iter().filter(|t| test(t)).collect());
            for number in 1..4 {
                let id = state(number).expect("a state");
                prop_assert_eq!(ids(transitions.into_state(&id).collect()), each(&|t| t.to_state == state(number)));
                prop_assert_eq!(ids(transitions.out_of_state(&id).collect()), each(&|t| t.from_state == state(number)));
                let origin = Origin::Outcome(id, OutcomeId(1));
                prop_assert_eq!(ids(transitions.from(&origin).collect()), each(&|t| t.origin().as_ref() == Some(&origin)));
            }
        }
    }
}
