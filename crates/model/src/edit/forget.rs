//! Removes the positions of removed elements from layouts. A later element with an equal id does not inherit them.

use super::place::LayoutElement;
use super::step::{Field, Set, Step};
use crate::{Container, Kind, Layout, Machine, State, StatePath};
use std::collections::{BTreeMap, BTreeSet};

/// The steps, and those that remove the positions of removed elements from the layouts.
pub(super) fn forget_places(machine: &Machine, mut steps: Vec<Step>) -> Vec<Step> {
    let mut gone: BTreeMap<&StatePath, BTreeSet<LayoutElement>> = BTreeMap::new();
    for step in &steps {
        if let Set::Kind(kind) = &step.set {
            let lost = machine.state(&step.at).map_or_else(Vec::new, |state| lost(state, kind));
            gone.entry(&step.at).or_default().extend(lost);
        } else if let Some((element, stays)) = element(&step.set) {
            if !stays {
                gone.entry(&step.at).or_default().insert(element);
            } else if let Some(gone) = gone.get_mut(&step.at) {
                gone.remove(&element);
            }
        }
    }
    let layouts: Vec<_> =
        gone.into_iter().filter_map(|(at, elements)| without(machine, at, &elements)).collect();
    steps.extend(layouts);
    steps
}

/// The element that a step sets, and whether it exists afterwards.
fn element(set: &Set) -> Option<(LayoutElement, bool)> {
    match set {
        Set::Outcome(id, set) => Some((LayoutElement::Outcome(*id), set.is_some())),
        Set::Port(kind, id, set) => Some((LayoutElement::Port(*kind, *id), set.is_some())),
        Set::Transition(id, set) => Some((LayoutElement::Transition(*id), set.is_some())),
        Set::DataFlow(id, set) => Some((LayoutElement::DataFlow(*id), set.is_some())),
        Set::Child(..)
        | Set::Id(_)
        | Set::Field(_)
        | Set::Kind(_)
        | Set::RuntimeValue(..)
        | Set::Header(_) => None,
    }
}

/// The elements that a change of kind removes from a container.
fn lost(state: &State, kind: &Kind) -> Vec<LayoutElement> {
    let Some(old) = state.container() else { return Vec::new() };
    let (Kind::Hierarchy(new) | Kind::Barrier(new) | Kind::Preemptive(new)) = kind else {
        return lines(old, |_| true);
    };
    lines(old, |element| match element {
        LayoutElement::Transition(id) => new.transitions.get(id).is_none(),
        LayoutElement::DataFlow(id) => new.data_flows.get(id).is_none(),
        LayoutElement::Port(_, id) => new.scoped_variables.get(id).is_none(),
        LayoutElement::State
        | LayoutElement::Name
        | LayoutElement::Income
        | LayoutElement::Outcome(_) => false,
    })
}

fn lines(inside: &Container, wanted: impl Fn(LayoutElement) -> bool) -> Vec<LayoutElement> {
    let transitions = inside.transitions.iter().map(|t| LayoutElement::Transition(t.id));
    let flows = inside.data_flows.iter().map(|f| LayoutElement::DataFlow(f.id));
    let variable = crate::PortKind::ScopedVariable;
    let variables = inside.scoped_variables.iter().map(|v| LayoutElement::Port(variable, v.id));
    transitions.chain(flows).chain(variables).filter(|element| wanted(*element)).collect()
}

/// The step that removes elements from a layout; `None` if none of them has a position there.
fn without(machine: &Machine, at: &StatePath, elements: &BTreeSet<LayoutElement>) -> Option<Step> {
    let layout = &machine.state(at)?.layout;
    let text = layout.text()?;
    let keys = elements.iter().filter_map(|element| element.key());
    let keys: Vec<_> = keys.filter(|key| text.contains(&format!("\"{key}\""))).collect();
    if keys.is_empty() {
        return None;
    }
    let mut document = layout.json();
    for key in keys {
        document.remove(&key);
    }
    Some(Step::new(at, Set::Field(Field::Layout(Layout::from_json(&document)))))
}
