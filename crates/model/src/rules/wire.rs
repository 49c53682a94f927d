//! Rules about data flows.

use super::{Fault, PortKind, Rule};
use crate::types::may_flow;
use crate::{Answer, Container, DataFlow, DataFlowId, Port, PortId, State, StateId, Types};

pub(super) fn faults(state: &State, id: DataFlowId, types: &dyn Types) -> Vec<Fault> {
    let Some(container) = state.container() else { return Vec::new() };
    let Some(flow) = container.data_flows.get(id) else { return Vec::new() };
    if (&flow.from_state, flow.from_port) == (&flow.to_state, flow.to_port) {
        return vec![Fault::new(Rule::FlowSamePort, "it leads to the port where it begins")];
    }
    let from = source(state, container, flow);
    let to = target(state, container, flow);
    let fault = match (from, to) {
        (Ok(from), Ok(to)) => pair_fault(container, flow, &from, &to, types),
        (from, to) => return from.err().into_iter().chain(to.err()).collect(),
    };
    fault.into_iter().collect()
}

/// A port at one end of a data flow.
struct WiredPort<'s> {
    kind: PortKind,
    is_own: bool,
    port: &'s Port,
}

impl WiredPort<'_> {
    fn what(&self, verb: &str) -> String {
        let whose = if self.is_own { "the container" } else { "a child" };
        format!("it {verb} at the {} `{}` of {whose}", self.kind, self.port.name)
    }
}

fn source<'s>(
    state: &'s State,
    container: &'s Container,
    flow: &DataFlow,
) -> Result<WiredPort<'s>, Fault> {
    let end = end(state, container, &flow.from_state, flow.from_port, "begins")?;
    match (end.is_own, end.kind) {
        (true, PortKind::Input | PortKind::ScopedVariable) | (false, PortKind::Output) => Ok(end),
        _ => Err(Fault::new(Rule::FlowSource, end.what("begins"))),
    }
}

fn target<'s>(
    state: &'s State,
    container: &'s Container,
    flow: &DataFlow,
) -> Result<WiredPort<'s>, Fault> {
    let end = end(state, container, &flow.to_state, flow.to_port, "ends")?;
    match (end.is_own, end.kind) {
        (true, PortKind::Output | PortKind::ScopedVariable) | (false, PortKind::Input) => Ok(end),
        _ => Err(Fault::new(Rule::FlowTarget, end.what("ends"))),
    }
}

fn pair_fault(
    container: &Container,
    flow: &DataFlow,
    from: &WiredPort<'_>,
    to: &WiredPort<'_>,
    types: &dyn Types,
) -> Option<Fault> {
    if from.kind == PortKind::ScopedVariable && to.kind == PortKind::ScopedVariable {
        return Some(Fault::new(Rule::FlowBetweenVariables, "it connects two scoped variables"));
    }
    twice_fault(container, flow).or_else(|| type_fault(from.port, to.port, types))
}

fn end<'s>(
    state: &'s State,
    container: &'s Container,
    id: &StateId,
    port: PortId,
    verb: &str,
) -> Result<WiredPort<'s>, Fault> {
    let is_own = *id == state.id;
    let owner = if is_own { Some(state) } else { container.states.get(id).map(|child| &**child) };
    let Some(owner) = owner else {
        let what = format!("it {verb} at {id}, which does not exist");
        return Err(Fault::new(Rule::FlowState, what));
    };
    let found = |kind: PortKind| {
        // A child exposes its ports but not its scoped variables.
        let ports = kind.of(owner).filter(|_| is_own || kind != PortKind::ScopedVariable);
        ports.and_then(|ports| ports.get(port)).map(|port| WiredPort { kind, is_own, port })
    };
    PortKind::ALL.into_iter().find_map(found).ok_or_else(|| {
        Fault::new(
            Rule::FlowPort,
            format!("it {verb} at the port {port} of {id}, which does not exist"),
        )
    })
}

fn twice_fault(container: &Container, flow: &DataFlow) -> Option<Fault> {
    let from = (flow.from_state.clone(), flow.from_port);
    let to = (flow.to_state.clone(), flow.to_port);
    let twin = container.data_flows.between(from, to).find(|other| other.id != flow.id)?;
    let what = format!("the data flow {} already connects these ports", twin.id);
    Some(Fault::new(Rule::FlowTwice, what))
}

fn type_fault(from: &Port, to: &Port, types: &dyn Types) -> Option<Fault> {
    let pair =
        || format!("from `{}` ({}) to `{}` ({})", from.name, from.data_type, to.name, to.data_type);
    match may_flow(&from.data_type, &to.data_type, types) {
        Answer::Yes => None,
        Answer::No => Some(Fault::new(Rule::FlowType, format!("the types do not fit {}", pair()))),
        Answer::Unknown => {
            let what = format!("it is unknown whether the types fit {}", pair());
            Some(Fault::new(Rule::FlowTypeUnknown, what))
        }
    }
}
