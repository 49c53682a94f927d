//! Rules about outcomes and ports.

use super::{Fault, PortKind, Rule};
use crate::{
    Conversion, DataType, Kind, Origin, Outcome, OutcomeId, Port, PortId, Ports, State, convert,
};

pub(super) fn outcome_faults(parent: Option<&State>, state: &State, id: OutcomeId) -> Vec<Fault> {
    let Some(outcome) = state.outcomes.get(id) else { return Vec::new() };
    let name = &outcome.name;
    let mut faults = Vec::new();
    if name.is_empty() {
        faults.push(Fault::new(Rule::OutcomeName, "the name is empty"));
    }
    let twin = |other: &&Outcome| other.name == *name && other.id != id;
    if let Some(other) = state.outcomes.iter().find(twin) {
        let what = format!("the outcome {} has the name `{name}`, too", other.id);
        faults.push(Fault::new(Rule::OutcomeNameTwice, what));
    }
    faults.extend(unconnected_fault(parent, state, outcome));
    faults
}

/// A custom outcome without a transition, where the run would wait for one.
fn unconnected_fault(parent: Option<&State>, state: &State, outcome: &Outcome) -> Option<Fault> {
    let container = match &parent?.kind {
        Kind::Hierarchy(container) | Kind::Preemptive(container) => container,
        Kind::Barrier(container) if state.id.is_decider() => container,
        Kind::Barrier(_) | Kind::Execution(_) | Kind::Decider(_) | Kind::Library(_) => return None,
    };
    let origin = Origin::Outcome(state.id.clone(), outcome.id);
    if outcome.id.is_mandatory() || container.transitions.from(&origin).next().is_some() {
        return None;
    }
    let what = format!("no transition begins at the outcome `{}`", outcome.name);
    Some(Fault::new(Rule::OutcomeUnconnected, what))
}

pub(super) fn port_faults(state: &State, kind: PortKind, id: PortId) -> Vec<Fault> {
    let Some(ports) = kind.of(state) else { return Vec::new() };
    let Some(port) = ports.get(id) else { return Vec::new() };
    let mut faults = Vec::new();
    faults.extend(name_fault(ports, port, kind));
    let other_kind = |other: &PortKind| {
        *other != kind && other.of(state).is_some_and(|ports| ports.get(id).is_some())
    };
    if let Some(other) = PortKind::ALL.into_iter().find(other_kind) {
        let what = format!("there is an {other} with the id {id}, too");
        faults.push(Fault::new(Rule::PortIdTwice, what));
    }
    if let DataType::Named(name) = &port.data_type
        && !is_dotted_name(name)
    {
        faults.push(Fault::new(Rule::DataTypeName, format!("`{name}` is not the name of a type")));
    }
    if let Conversion::Fails(reason) = convert(&port.default, &port.data_type) {
        faults.push(Fault::new(Rule::DefaultType, format!("the default: {reason}")));
    }
    faults
}

fn name_fault(ports: &Ports, port: &Port, kind: PortKind) -> Option<Fault> {
    let name = &port.name;
    if name.is_empty() {
        return Some(Fault::new(Rule::PortName, "the name is empty"));
    }
    if let Some(other) = ports.iter().find(|other| other.name == *name && other.id != port.id) {
        let what = format!("the {kind} {} has the name `{name}`, too", other.id);
        return Some(Fault::new(Rule::PortNameTwice, what));
    }
    let what = "the name `error` is where errors of scripts arrive";
    (name == "error").then(|| Fault::new(Rule::PortNamedError, what))
}

fn is_dotted_name(name: &str) -> bool {
    let is_word = |word: &str| {
        word.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && word.chars().all(|c| c.is_alphanumeric() || c == '_')
    };
    name.split('.').all(is_word)
}
