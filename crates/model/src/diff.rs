//! Finds the differences between two machines. Skips shared parts, which are equal.

use crate::{Machine, State, StatePath, States};
use std::sync::Arc;

/// A state that differs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Difference {
    /// A state was added, with everything inside it.
    Added(StatePath),
    /// A state was removed, with everything inside it.
    Removed(StatePath),
    /// A state itself changed; its children are compared separately.
    Changed(StatePath, Vec<Aspect>),
}

/// The part of a state that differs: one for each of its files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Aspect {
    /// Name, description, kind, outcomes, ports, transitions, data flows, library reference, unknown keys.
    Core,
    /// Text of the script of an execution state or decider.
    Script,
    /// Nested notes of the user, [`State::semantic_data`](crate::State::semantic_data).
    SemanticData,
    /// Positions and sizes on the screen.
    Layout,
}

/// The states that differ between `old` and `new`, parents first. Skips what both machines share, so
/// that the cost depends on the change, not on the machine. The contents of libraries are no part of a machine.
///
/// ```
/// use rafcon_model::{Aspect, Difference, StatePath, diff};
/// use rafcon_testkit::notation;
///
/// let old = notation::parse("hierarchy ROOT\n  execution A\n  execution B")?;
/// let new = notation::parse("hierarchy ROOT\n  execution A\n    script \"\"\n  execution C")?;
/// let a = Difference::Changed(StatePath::parse("ROOT/A"), vec![Aspect::Script]);
/// let b = Difference::Removed(StatePath::parse("ROOT/B"));
/// let c = Difference::Added(StatePath::parse("ROOT/C"));
/// assert_eq!(diff(&old, &new), [a, b, c]);
/// # Ok::<(), notation::NotationError>(())
/// ```
pub fn diff(old: &Machine, new: &Machine) -> Vec<Difference> {
    let (old, new) = (&old.root, &new.root);
    if old.id != new.id {
        let path = |state: &State| StatePath::root(state.id.clone());
        return vec![Difference::Removed(path(old)), Difference::Added(path(new))];
    }
    let mut found = Vec::new();
    let mut open = vec![Pair::Both(StatePath::root(new.id.clone()), old, new)];
    while let Some(pair) = open.pop() {
        pair.look(&mut found, &mut open);
    }
    found
}

/// A place in one machine or in both.
enum Pair<'m> {
    Both(StatePath, &'m Arc<State>, &'m Arc<State>),
    One(Difference),
}

impl Pair<'_> {
    fn look(self, found: &mut Vec<Difference>, open: &mut Vec<Self>) {
        let (path, old, new) = match self {
            Self::One(difference) => return found.push(difference),
            Self::Both(_, old, new) if Arc::ptr_eq(old, new) => return,
            Self::Both(path, old, new) => (path, old, new),
        };
        let first = open.len();
        push_children(&path, old, new, open);
        open[first..].reverse();
        let aspects = aspects(old, new);
        if !aspects.is_empty() {
            found.push(Difference::Changed(path, aspects));
        }
    }
}

/// The children of both states, sorted by id.
fn push_children<'m>(path: &StatePath, old: &'m State, new: &'m State, open: &mut Vec<Pair<'m>>) {
    let states = |state: &'m State| state.container().map(|container| &container.states);
    let (old, new, none) = (states(old), states(new), States::default());
    let get = |states: Option<&'m States>, id: &_| states.and_then(|states| states.get(id));
    for id in old.unwrap_or(&none).differing(new.unwrap_or(&none)) {
        let child = path.child(id.clone());
        open.push(match (get(old, &id), get(new, &id)) {
            (Some(old), Some(new)) => Pair::Both(child, old, new),
            (None, Some(_)) => Pair::One(Difference::Added(child)),
            (_, None) => Pair::One(Difference::Removed(child)),
        });
    }
}

fn aspects(old: &State, new: &State) -> Vec<Aspect> {
    let script = |state: &State| state.script().and_then(|script| script.text.clone());
    [
        (!same_core(old, new), Aspect::Core),
        (script(old) != script(new), Aspect::Script),
        (old.semantic_data != new.semantic_data, Aspect::SemanticData),
        (old.layout != new.layout, Aspect::Layout),
    ]
    .into_iter()
    .filter_map(|(differs, aspect)| differs.then_some(aspect))
    .collect()
}

fn same_core(old: &State, new: &State) -> bool {
    (&old.name, &old.description, &old.extra) == (&new.name, &new.description, &new.extra)
        && (&old.outcomes, &old.inputs, &old.outputs) == (&new.outcomes, &new.inputs, &new.outputs)
        && old.kind.is_same_shell(&new.kind)
}
