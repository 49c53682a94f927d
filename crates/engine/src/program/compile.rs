//! Compiles the model to nodes. It walks breadth first with a queue, so that depth needs no stack.

use super::Program;
use super::defaults::{self, ScopedVariables};
use super::flows::{ChildWires, wires};
use super::node::{
    ABORTED, Body, Concurrency, Content, Exit, Fault, Initial, Inside, LossPolicies, Node, PortMap,
};
use super::numbers::Numbers;
use super::tables::{FlowRange, TablesBuilder};
use crate::{Datum, Literals, NodeId};
use rafcon_model::{
    Container, Kind, Library, LibraryContent, Loss, LossPolicy, Machine, Outcome, OutcomeId, Ports,
    RuntimeValues, State, StateId, Target, Transition,
};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

impl<D: Datum> Program<D> {
    /// Compiles a machine. Never fails: an error in the machine becomes a note, or aborts its state when that runs.
    pub fn compile(machine: &Machine, literals: &mut dyn Literals<D>) -> Self {
        compile(machine, literals, Numbers::new(None))
    }

    /// Compiles a changed version of this machine. A state whose predecessor had its id and parent, in the machine
    /// or in the library content, keeps its number. New states get new numbers, and no number is reused for another
    /// state.
    #[must_use]
    pub fn change(&self, machine: &Machine, literals: &mut dyn Literals<D>) -> Self {
        compile(machine, literals, Numbers::new(Some(self)))
    }
}

fn compile<D: Datum>(
    machine: &Machine,
    literals: &mut dyn Literals<D>,
    numbers: Numbers<'_, D>,
) -> Program<D> {
    let mut compiler = Compiler {
        queue: vec![Pending::root(Program::<D>::ROOT, &machine.root)],
        tables: TablesBuilder::default(),
        numbers,
        literals,
    };
    let mut nodes = Vec::new();
    while nodes.len() < compiler.queue.len() {
        let number = compiler.queue[nodes.len()].number;
        nodes.push((number, compiler.node(nodes.len())));
    }
    let circle = "its children run in a circle in which there is no script; break the circle";
    let circle = compiler.literals.error(circle);
    Program { nodes: compiler.numbers.finish(nodes), tables: compiler.tables.finish(), circle }
}

/// Converts a count or position to an index.
pub(crate) fn index(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

struct Compiler<'l, D> {
    /// One entry for each node, compiled or not.
    queue: Vec<Pending>,
    tables: TablesBuilder,
    numbers: Numbers<'l, D>,
    literals: &'l mut dyn Literals<D>,
}

/// A node to be compiled, with its data from the parent.
struct Pending {
    number: NodeId,
    state: Arc<State>,
    parent: Option<NodeId>,
    child_index: u32,
    wires: ChildWires,
    outcomes: Box<[Outcome]>,
    exits: Box<[Exit]>,
}

impl Pending {
    fn root(number: NodeId, state: &Arc<State>) -> Self {
        let outcomes = outcomes(state);
        Self {
            number,
            state: Arc::clone(state),
            parent: None,
            child_index: 0,
            wires: ChildWires::default(),
            exits: vec![Exit::Nowhere; outcomes.len()].into(),
            outcomes,
        }
    }
}

/// Outcomes: preempted, aborted, then the others by rising id. The first two are added if the file lacks them.
fn outcomes(state: &State) -> Box<[Outcome]> {
    let mandatory = [(OutcomeId::PREEMPTED, "preempted"), (OutcomeId::ABORTED, "aborted")];
    let first = mandatory.into_iter().map(|(id, name)| {
        state.outcomes.get(id).cloned().unwrap_or_else(|| Outcome::new(id, name))
    });
    let others = state.outcomes.iter().filter(|outcome| !outcome.id.is_mandatory()).cloned();
    first.chain(others).collect()
}

fn outcome_index(outcomes: &[Outcome], id: OutcomeId) -> Option<u32> {
    outcomes.iter().position(|outcome| outcome.id == id).map(index)
}

impl<D: Datum> Compiler<'_, D> {
    fn node(&mut self, place: usize) -> Node<D> {
        let Pending { number, state, .. } = &self.queue[place];
        let (number, state) = (*number, Arc::clone(state));
        let body = self.body(number, &state);
        let runtime = runtime_values(&state);
        let inputs = defaults::inputs(&state.inputs, runtime.map(|r| r.0), self.literals);
        let outputs = defaults::outputs(&state.outputs, runtime.map(|r| r.1), self.literals);
        let pending = &mut self.queue[place];
        let wires = std::mem::take(&mut pending.wires);
        let outcomes = std::mem::take(&mut pending.outcomes);
        let gather = self.tables.wires(&wires.gather);
        let error_input = state.inputs.iter().position(|port| port.name == "error").map(index);
        Node {
            parent: pending.parent,
            child_index: pending.child_index,
            gone: false,
            exits: self.tables.exits(&std::mem::take(&mut pending.exits)),
            plain_outcomes: (-2..).zip(&outcomes).all(|(id, outcome)| outcome.id.0 == id),
            outcomes,
            body,
            constant_inputs: constant(&inputs, gather),
            inputs,
            outputs: outputs.values,
            bad_outputs: outputs.bad,
            gather,
            scatter: self.tables.wires(&wires.scatter),
            input_checks: self.tables.checks(&state.inputs),
            output_checks: self.tables.checks(&state.outputs),
            error_input,
            loss: loss_policies(&state),
            state,
        }
    }

    fn body(&mut self, node: NodeId, state: &State) -> Body<D> {
        if let Some(reason) = &state.damage {
            return Body::Library(Box::new(self.missing(reason, false)));
        }
        match &state.kind {
            Kind::Execution(_) | Kind::Decider(_) => Body::Script,
            Kind::Hierarchy(container) => {
                Body::Hierarchy(Box::new(self.inside(node, state, container)))
            }
            Kind::Barrier(container) => {
                let mut inside = self.inside(node, state, container);
                let decider = container.states.keys().position(StateId::is_decider).map(index);
                if decider.is_none() && inside.fault.is_none() {
                    inside.fault = Some(self.no_decider());
                }
                Body::Concurrency(Concurrency::Barrier(decider), Box::new(inside))
            }
            Kind::Preemptive(container) => {
                let inside = self.inside(node, state, container);
                Body::Concurrency(Concurrency::Preemptive, Box::new(inside))
            }
            Kind::Library(library) => Body::Library(Box::new(self.content(node, state, library))),
        }
    }

    fn no_decider(&mut self) -> Fault<D> {
        let reason = "the barrier has no decider; make it anew, or restore its decider's folder";
        Fault { port: None, reason: reason.into(), error: self.literals.error(reason) }
    }

    fn inside(&mut self, node: NodeId, state: &State, container: &Container) -> Inside<D> {
        let first = self.queue.len();
        let wires = wires(state, container);
        let numbers = self.numbers.children(node, container);
        let children = container.states.values().zip(wires.children).zip(&numbers);
        self.queue.extend((0..).zip(children).map(|(child_index, ((child, wires), number))| {
            Pending { parent: Some(node), child_index, wires, ..Pending::root(*number, child) }
        }));
        let start = self.connect(first, state, container);
        let ScopedVariables { list, fault } =
            defaults::scoped(&container.scoped_variables, self.literals);
        let exits = &self.queue[first..];
        Inside {
            exits: exits.iter().map(|child| index(child.exits.len())).sum(),
            children: numbers.into(),
            start,
            slots: wires.slots,
            sources: wires.sources.into(),
            scoped: list,
            scatter: self.tables.wires(&wires.scatter),
            gather: self.tables.wires(&wires.gather),
            fault,
        }
    }

    /// Writes the transitions of a container into its children, and returns its start.
    fn connect(&mut self, first: usize, state: &State, container: &Container) -> Exit {
        let own_outcomes = outcomes(state);
        let children: BTreeMap<_, _> = container.states.keys().zip(0_u32..).collect();
        let exit = |transition: &Transition| match transition.target(&state.id) {
            Some(Target::State(id)) => children.get(&id).map_or(Exit::Nowhere, |&c| Exit::Child(c)),
            Some(Target::Outcome(id)) => {
                outcome_index(&own_outcomes, id).map_or(Exit::Nowhere, Exit::Outcome)
            }
            None => Exit::Nowhere,
        };
        let mut start = Exit::Nowhere;
        for transition in container.transitions.iter() {
            let place = match (&transition.from_state, transition.from_outcome) {
                (None, None) => Some(&mut start),
                (Some(from), Some(outcome)) => children.get(from).and_then(|&child| {
                    let child = &mut self.queue[first + child as usize];
                    let outcome = outcome_index(&child.outcomes, outcome)?;
                    child.exits.get_mut(outcome as usize)
                }),
                (None, Some(_)) | (Some(_), None) => None,
            };
            if let Some(place) = place.filter(|place| **place == Exit::Nowhere) {
                *place = exit(transition);
            }
        }
        start
    }

    fn content(&mut self, node: NodeId, state: &State, library: &Library) -> Content<D> {
        let root = match &library.content {
            LibraryContent::Found(root) => root,
            LibraryContent::Missing { reason } => return self.missing(reason, true),
        };
        let (root_node, is_first) = self.numbers.content(node, root);
        if is_first {
            self.queue.push(Pending::root(root_node, root));
        }
        let own = outcomes(state);
        let outcome = |outcome: &Outcome| outcome_index(&own, outcome.id).unwrap_or(ABORTED);
        Content::Found {
            root: root_node,
            ports: port_map(state, root),
            outcomes: outcomes(root).iter().map(outcome).collect(),
        }
    }

    fn missing(&mut self, reason: &SmolStr, is_library: bool) -> Content<D> {
        Content::Missing { reason: reason.clone(), error: self.literals.error(reason), is_library }
    }
}

fn runtime_values(state: &State) -> Option<(&RuntimeValues, &RuntimeValues)> {
    match &state.kind {
        Kind::Library(library) => Some((&library.inputs, &library.outputs)),
        Kind::Execution(_)
        | Kind::Decider(_)
        | Kind::Hierarchy(_)
        | Kind::Barrier(_)
        | Kind::Preemptive(_) => None,
    }
}

fn loss_policies(state: &State) -> Option<Box<LossPolicies>> {
    let [link, command] = Loss::ALL.map(|loss| LossPolicy::of(state, loss));
    let has_any = link.is_some() || command.is_some();
    has_any.then(|| Box::new(LossPolicies { link, command }))
}

/// Maps the ports of a library state and its root; `None` if both have equal port ids.
fn port_map(state: &State, root: &State) -> Option<Box<PortMap>> {
    let alike = |a: &Ports, b: &Ports| a.iter().map(|p| p.id).eq(b.iter().map(|p| p.id));
    if alike(&state.inputs, &root.inputs) && alike(&state.outputs, &root.outputs) {
        return None;
    }
    Some(Box::new(PortMap {
        inputs: mapping(&root.inputs, &state.inputs),
        defaults: mapping(&root.outputs, &state.outputs),
        outputs: mapping(&state.outputs, &root.outputs),
    }))
}

/// For each port of `to`, the index of the port with its id in `from`.
fn mapping(to: &Ports, from: &Ports) -> Box<[Option<u32>]> {
    let position = |id| from.iter().position(|port| port.id == id).map(index);
    to.iter().map(|port| position(port.id)).collect()
}

fn constant<D: Datum>(inputs: &[Initial<D>], gather: FlowRange) -> Option<Arc<[D]>> {
    let value = |initial: &Initial<D>| match initial {
        Initial::Is(value) => Some(value.clone()),
        Initial::Global(_) | Initial::Bad(_) => None,
    };
    if gather.is_empty() { inputs.iter().map(value).collect() } else { None }
}
