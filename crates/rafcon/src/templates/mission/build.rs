//! Conversion of a draft to a state: names become ids, and parts get positions.
//!
//! Knows the model, but not the mission.

use super::draft::{Draft, FlowDraft, Inside, Parts, Slot, To, TransitionDraft};
use super::layout::{self, Pair};
use anyhow::{Context as _, Result};
use rafcon_model::{
    Container, DECIDER_ID, DataFlow, DataFlowId, DataType, Kind, Origin, Outcome, OutcomeId, Port,
    PortId, Ports, Script, State, StateId, Target, Transition, TransitionId,
};

/// Generates unique state ids: six letters that appear random.
#[derive(Debug, Default)]
pub(super) struct Ids {
    used: u64,
}

/// Number of ids with six letters.
const IDS: u64 = 26u64.pow(6);
/// Coprime to [`IDS`], so that its multiples reach all ids.
const STRIDE: u64 = 190_845_181;

impl Ids {
    fn next(&mut self) -> StateId {
        self.used += 1;
        let mut rest = self.used * STRIDE % IDS;
        let letters = std::iter::repeat_with(|| {
            let letter = u8::try_from(rest % 26).unwrap_or_default();
            rest /= 26;
            char::from(b'A' + letter)
        });
        StateId::new(letters.take(6).collect::<String>())
    }
}

/// The root state that a draft describes.
pub(super) fn root(draft: Draft, ids: &mut Ids) -> Result<State> {
    let mut root = state(draft, ids)?;
    root.place((0.0, 0.0));
    Ok(root.state)
}

/// A state and its size on the screen.
struct Sized {
    state: State,
    size: Pair,
}

impl Sized {
    fn place(&mut self, at: Pair) {
        self.state.layout = layout::entry(at, self.size, self.state.container().is_some());
    }
}

fn state(draft: Draft, ids: &mut Ids) -> Result<Sized> {
    let id = if matches!(draft.inside, Inside::Decider(_)) {
        StateId::new(DECIDER_ID)
    } else {
        ids.next()
    };
    let mut state = State::new(id, &draft.name, Kind::Execution(Script::default()));
    state.description = (!draft.about.is_empty()).then(|| draft.about.into());
    let own = (0..).zip(&draft.outcomes).map(|(id, name)| Outcome::new(OutcomeId(id), name));
    state.outcomes = state.outcomes.iter().cloned().chain(own).collect();
    state.inputs = ports(0, &draft.inputs);
    state.outputs = ports(draft.inputs.len(), &draft.outputs);
    let (kind, size) =
        kind(draft.inside, &state, ids).with_context(|| format!("in {}", draft.name))?;
    state.kind = kind;
    Ok(Sized { state, size })
}

fn kind(inside: Inside, state: &State, ids: &mut Ids) -> Result<(Kind, Pair)> {
    let script = |text: &'static str| Script { text: Some(text.into()) };
    Ok(match inside {
        Inside::Script(text) => (Kind::Execution(script(text)), layout::LEAF),
        Inside::Decider(text) => (Kind::Decider(script(text)), layout::LEAF),
        Inside::Hierarchy(parts) => {
            let (inside, size) = container(parts, state, Order::Sequence, ids)?;
            (Kind::Hierarchy(inside), size)
        }
        Inside::Barrier(parts) => {
            let (inside, size) = container(parts, state, Order::Together, ids)?;
            (Kind::Barrier(inside), size)
        }
        Inside::Preemptive(parts) => {
            let (inside, size) = container(parts, state, Order::Together, ids)?;
            (Kind::Preemptive(inside), size)
        }
    })
}

/// Execution order of the children of a container.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Order {
    /// In sequence, from the first child.
    Sequence,
    /// Concurrently, all children at once.
    Together,
}

fn ports(used: usize, slots: &[Slot]) -> Ports {
    let first = i64::try_from(used).unwrap_or(i64::MAX);
    let port = |(id, (name, default)): (i64, &Slot)| {
        let data_type = DataType::of(default).unwrap_or(DataType::Object);
        Port::new(PortId(id), name, data_type, default.clone())
    };
    (first..).zip(slots).map(port).collect()
}

fn container(
    parts: Parts,
    parent: &State,
    order: Order,
    ids: &mut Ids,
) -> Result<(Container, Pair)> {
    let columns = columns(&parts, order);
    let mut children =
        parts.children.into_iter().map(|child| state(child, ids)).collect::<Result<Vec<_>>>()?;
    let sizes = children.iter().map(|child| child.size).collect::<Vec<_>>();
    let (places, size) = layout::arrange(&columns, &sizes);
    for (child, at) in children.iter_mut().zip(places) {
        child.place(at);
    }
    let used = parent.inputs.len() + parent.outputs.len();
    let variables = ports(used, &parts.variables);
    let named = NamedStates { parent, variables: &variables, children: &children };
    let mut inside = Container::default();
    let start = (order == Order::Sequence).then_some(children.first()).flatten();
    if let Some(first) = start {
        connect(&mut inside, Origin::Income, Target::State(first.state.id.clone()), &parent.id);
    }
    for line in &parts.transitions {
        connect(&mut inside, named.origin(line)?, named.target(&line.to)?, &parent.id);
    }
    for (number, flow) in (1..).zip(&parts.data) {
        let (from, to) = (named.source(flow)?, named.sink(flow)?);
        inside.data_flows.insert(DataFlow::new(DataFlowId(number), from, to));
    }
    inside.scoped_variables = variables;
    inside.states =
        children.into_iter().map(|child| (child.state.id.clone(), child.state.into())).collect();
    Ok((inside, size))
}

fn columns(parts: &Parts, order: Order) -> Vec<Vec<usize>> {
    let index = |name: &str| parts.children.iter().position(|child| child.name == name);
    let children = parts.children.len();
    if order == Order::Together {
        let (first, last) = (0..children)
            .partition(|&child| !matches!(parts.children[child].inside, Inside::Decider(_)));
        return vec![first, last];
    }
    let line = |line: &TransitionDraft| match &line.to {
        To::Child(to) => Some((index(&line.from)?, index(to)?)),
        To::Outcome(_) => None,
    };
    layout::by_steps(children, &parts.transitions.iter().filter_map(line).collect::<Vec<_>>())
}

fn connect(inside: &mut Container, from: Origin, to: Target, parent: &StateId) {
    let id: TransitionId = inside.transitions.next_id();
    inside.transitions.insert(Transition::new(id, from, to, parent));
}

/// The states and variables of a container by name.
struct NamedStates<'a> {
    parent: &'a State,
    variables: &'a Ports,
    children: &'a [Sized],
}

impl NamedStates<'_> {
    fn child(&self, name: &str) -> Result<&State> {
        let mut states = self.children.iter().map(|child| &child.state);
        states
            .find(|child| child.name == name)
            .with_context(|| format!("no child is called `{name}`"))
    }

    fn origin(&self, line: &TransitionDraft) -> Result<Origin> {
        let child = self.child(&line.from)?;
        Ok(Origin::Outcome(child.id.clone(), outcome(child, &line.outcome)?))
    }

    fn target(&self, to: &To) -> Result<Target> {
        Ok(match to {
            To::Child(name) => Target::State(self.child(name)?.id.clone()),
            To::Outcome(name) => Target::Outcome(outcome(self.parent, name)?),
        })
    }

    fn source(&self, flow: &FlowDraft) -> Result<(StateId, PortId)> {
        let (state, kinds) = match &flow.from {
            Some(name) => (self.child(name)?, [None, Some(&self.child(name)?.outputs)]),
            None => (self.parent, [Some(&self.parent.inputs), Some(self.variables)]),
        };
        end(state, kinds, flow)
    }

    fn sink(&self, flow: &FlowDraft) -> Result<(StateId, PortId)> {
        // A variable is available as the output of its name, so the output is used.
        let variables = (flow.from.is_some()).then_some(self.variables);
        let (state, kinds) = match &flow.to {
            Some(name) => (self.child(name)?, [None, Some(&self.child(name)?.inputs)]),
            None => (self.parent, [variables, Some(&self.parent.outputs)]),
        };
        end(state, kinds, flow)
    }
}

fn outcome(state: &State, name: &str) -> Result<OutcomeId> {
    let found = state.outcomes.by_name(name);
    Ok(found.with_context(|| format!("{} has no outcome `{name}`", state.name))?.id)
}

fn end(state: &State, kinds: [Option<&Ports>; 2], flow: &FlowDraft) -> Result<(StateId, PortId)> {
    let found = kinds.into_iter().flatten().find_map(|ports| ports.by_name(flow.port));
    let port = found.with_context(|| format!("{} has no port `{}`", state.name, flow.port))?;
    Ok((state.id.clone(), port.id))
}
