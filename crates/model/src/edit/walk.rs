//! Finding many states of one machine one after the other: the way to the last one is kept, and only what differs is walked.

use crate::{Machine, State, StateId};

/// The way to a state, from the root down.
pub(super) struct Walk<'m> {
    machine: &'m Machine,
    way: Vec<&'m State>,
}

impl<'m> Walk<'m> {
    pub(super) fn new(machine: &'m Machine) -> Self {
        Self { machine, way: Vec::new() }
    }

    /// The state at the path `ids` and its parent. Does not look into libraries.
    pub(super) fn find(&mut self, ids: &[StateId]) -> Option<(Option<&'m State>, &'m State)> {
        let known = self.way.iter().zip(ids).take_while(|(state, id)| state.id == **id).count();
        self.way.truncate(known);
        for id in ids.get(known..)? {
            let next: &State = match self.way.last() {
                Some(state) => state.container()?.states.get(id)?,
                None => Some(&*self.machine.root).filter(|root| root.id == *id)?,
            };
            self.way.push(next);
        }
        let (state, above) = self.way.split_last()?;
        Some((above.last().copied(), state))
    }
}

#[cfg(test)]
mod tests {
    use super::Walk;
    use crate::{Container, Header, Kind, Machine, State, StateId, StatePath};
    use std::sync::Arc;

    fn state(id: &str, children: Vec<State>) -> State {
        let states = children.into_iter().map(|child| (child.id.clone(), Arc::new(child)));
        let inside = Container { states: states.collect(), ..Container::default() };
        State::new(StateId::new(id), id, Kind::Hierarchy(inside))
    }

    #[test]
    fn it_finds_what_is_there_in_any_order() {
        let inner = state("B", vec![state("C", vec![])]);
        let root = Arc::new(state("A", vec![inner, state("D", vec![])]));
        let machine = Machine { header: Header::default(), root };
        let mut walk = Walk::new(&machine);
        for path in ["A/B/C", "A/B", "A/D", "A/X", "A/B/C", "X", "A", "A/D/X", "", "A/B/C"] {
            let ids = StatePath::parse(path);
            let found = walk.find(&ids.0).map(|(_, state)| &state.id);
            assert_eq!(found, machine.state(&ids).map(|state| &state.id), "{path}");
            let parent = walk.find(&ids.0).and_then(|(parent, _)| parent);
            let above = ids.parent().and_then(|path| machine.state(&path));
            assert_eq!(parent.map(|p| &p.id), above.filter(|_| found.is_some()).map(|s| &s.id));
        }
    }
}
