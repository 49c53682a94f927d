//! Parsing of the ends of transitions and data flows in the notation, `AAAAAA.success -> .n`, and resolution of their names
//! to ids.

use super::NotationError;
use super::scan::Line;
use rafcon_model::port::Extra;
use rafcon_model::{
    Container, DataFlow, DataFlowId, OutcomeId, PortId, State, StateId, Transition, TransitionId,
};
use smol_str::SmolStr;
use std::fmt;

/// A line between two ends, as written.
#[derive(Debug)]
pub(super) struct Connection<'t> {
    line: Line<'t>,
    is_flow: bool,
    from: ConnectionEnd,
    to: ConnectionEnd,
    id: Option<i64>,
    extra: Extra,
}

#[derive(Debug)]
struct ConnectionEnd {
    place: ConnectionPlace,
    part: Option<ConnectionPart>,
}

#[derive(Debug)]
enum ConnectionPlace {
    /// No state: `start` or `nowhere`.
    None,
    /// The container itself: `.part` without a state.
    Own,
    State(StateId),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum ConnectionPart {
    Id(i64),
    Name(SmolStr),
}

impl fmt::Display for ConnectionPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Id(id) => write!(f, "{id}"),
            Self::Name(name) => write!(f, "`{name}`"),
        }
    }
}

/// Reads `A.x -> B.y as 3 ; …`.
pub(super) fn read<'t>(
    line: &mut Line<'t>,
    is_flow: bool,
) -> Result<Vec<Connection<'t>>, NotationError> {
    let mut found = Vec::new();
    loop {
        let start = *line;
        let from = end(line)?;
        line.expect("->")?;
        let to = end(line)?;
        let id = if line.eat_word("as") {
            Some(line.number().ok_or_else(|| line.error("expected an id"))?)
        } else {
            None
        };
        let extra = line.extra()?;
        found.push(Connection { line: start, is_flow, from, to, id, extra });
        if !line.eat(";") {
            return line.end().map(|()| found);
        }
    }
}

fn end(line: &mut Line<'_>) -> Result<ConnectionEnd, NotationError> {
    if line.eat(".") {
        return Ok(ConnectionEnd { place: ConnectionPlace::Own, part: Some(part(line)?) });
    }
    let place = if line.eat_word("start") || line.eat_word("nowhere") {
        ConnectionPlace::None
    } else {
        ConnectionPlace::State(StateId(line.name()?))
    };
    let part = if line.eat_joined(".") { Some(part(line)?) } else { None };
    Ok(ConnectionEnd { place, part })
}

/// The part after the point: a number or a name.
pub(super) fn part(line: &mut Line<'_>) -> Result<ConnectionPart, NotationError> {
    match line.number() {
        Some(id) => Ok(ConnectionPart::Id(id)),
        None => line.name().map(ConnectionPart::Name),
    }
}

impl Connection<'_> {
    /// Error for a line outside a container.
    pub(super) fn misplaced(&self) -> NotationError {
        self.line.error("only hierarchies and concurrency states have transitions and data flows")
    }

    /// Adds this connection to the container of `state`.
    pub(super) fn add_to(self, state: &mut State) -> Result<(), NotationError> {
        if self.is_flow { self.add_flow(state) } else { self.add_transition(state) }
    }

    fn add_transition(self, state: &mut State) -> Result<(), NotationError> {
        let from_outcome = self.outcome(state, &self.from)?;
        let to_outcome = self.outcome(state, &self.to)?;
        let (from_state, to_state) = (self.from.state(state), self.to.state(state));
        let Some(container) = state.container_mut() else { return Err(self.misplaced()) };
        let id = self.id.map_or_else(|| container.transitions.next_id(), TransitionId);
        let transition =
            Transition { id, from_state, from_outcome, to_state, to_outcome, extra: self.extra };
        match container.transitions.insert(transition) {
            Some(_) => Err(self.line.error(format!("the transition {id} occurs twice"))),
            None => Ok(()),
        }
    }

    fn add_flow(self, state: &mut State) -> Result<(), NotationError> {
        let from = self.port(state, &self.from, Side::Source)?;
        let to = self.port(state, &self.to, Side::Target)?;
        let Some(container) = state.container_mut() else { return Err(self.misplaced()) };
        let id = self.id.map_or_else(|| container.data_flows.next_id(), DataFlowId);
        let flow = DataFlow { extra: self.extra, ..DataFlow::new(id, from, to) };
        match container.data_flows.insert(flow) {
            Some(_) => Err(self.line.error(format!("the data flow {id} occurs twice"))),
            None => Ok(()),
        }
    }

    fn outcome(
        &self,
        state: &State,
        end: &ConnectionEnd,
    ) -> Result<Option<OutcomeId>, NotationError> {
        let name = match &end.part {
            None => return Ok(None),
            Some(ConnectionPart::Id(id)) => return Ok(Some(OutcomeId(*id))),
            Some(ConnectionPart::Name(name)) => name,
        };
        let owner = end.owner(state);
        let found = owner.and_then(|owner| owner.outcomes.by_name(name));
        found.map(|outcome| Some(outcome.id)).ok_or_else(|| self.unknown("outcome", name, owner))
    }

    fn port(
        &self,
        state: &State,
        end: &ConnectionEnd,
        side: Side,
    ) -> Result<(StateId, PortId), NotationError> {
        let Some(id) = end.state(state) else {
            return Err(self.line.error("a data flow has a port at both ends"));
        };
        let name = match &end.part {
            None => return Err(self.line.error("a data flow has a port at both ends")),
            Some(ConnectionPart::Id(port)) => return Ok((id, PortId(*port))),
            Some(ConnectionPart::Name(name)) => name,
        };
        let owner = end.owner(state);
        let found = owner.and_then(|owner| port_by_name(owner, owner.id == state.id, side, name));
        found.map(|port| (id, port)).ok_or_else(|| self.unknown("port", name, owner))
    }

    fn unknown(&self, what: &str, name: &str, owner: Option<&State>) -> NotationError {
        self.line.error(match owner {
            Some(owner) => format!("the state {} has no {what} `{name}` for this end", owner.id),
            None => format!("there is no such state; give the {what} by its number"),
        })
    }
}

impl ConnectionEnd {
    fn state(&self, container: &State) -> Option<StateId> {
        match &self.place {
            ConnectionPlace::None => None,
            ConnectionPlace::Own => Some(container.id.clone()),
            ConnectionPlace::State(id) => Some(id.clone()),
        }
    }

    fn owner<'s>(&self, container: &'s State) -> Option<&'s State> {
        owner(container, &self.state(container)?)
    }
}

/// The end of a data flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Source,
    Target,
}

/// The state that the id `id` means inside `container`: itself or a child.
fn owner<'s>(container: &'s State, id: &StateId) -> Option<&'s State> {
    if *id == container.id {
        return Some(container);
    }
    container.container()?.states.get(id).map(|child| &**child)
}

/// The port with this name at one end of a data flow; `own` if the state is the container itself.
fn port_by_name(owner: &State, own: bool, side: Side, name: &str) -> Option<PortId> {
    let ports = if own == (side == Side::Source) { &owner.inputs } else { &owner.outputs };
    let variable = |container: &Container| container.scoped_variables.by_name(name).map(|p| p.id);
    let own_variable = || owner.container().filter(|_| own).and_then(variable);
    ports.by_name(name).map(|port| port.id).or_else(own_variable)
}
