//! Data flow: into states, into containers, out of containers.

use crate::engine::state::frames::{Children, Ended, Slot};
use crate::engine::state::step::Step;
use crate::program::{Checks, FlowRange, Initial, Inside, Node, index};
use crate::{Datum, Event, Globals, Level, Note, PathId};
use rafcon_model::{Answer, DataType, Port};
use smol_str::SmolStr;
use std::sync::Arc;

/// Values that leave a state, with their data flows.
struct FlowingValues<'v, D> {
    flows: FlowRange,
    values: &'v [D],
    /// Ports without a value.
    absent: &'v [u32],
}

/// The newest value in these slots that the predicate accepts.
fn newest<'v, D>(
    slots: &'v [Slot<D>],
    among: &[u32],
    wanted: impl Fn(&D) -> bool,
) -> Option<&'v D> {
    let mut best: Option<(u64, &D)> = None;
    for slot in among.iter().filter_map(|&index| slots.get(index as usize)) {
        let Some(value) = slot.value.as_ref().filter(|value| wanted(value)) else { continue };
        if best.is_none_or(|(sequence, _)| sequence < slot.sequence) {
            best = Some((slot.sequence, value));
        }
    }
    best.map(|(_, value)| value)
}

impl<'s, D: Datum> Step<'s, D> {
    /// The inputs of a child. Each port gets the newest value that flows into it and is not `None`, otherwise its
    /// default. A port named `error` gets the error of the previous state.
    pub(in crate::engine) fn child_inputs(
        &mut self,
        parent: u32,
        node: &'s Node<D>,
        path: PathId,
        error: Option<&D>,
    ) -> Arc<[D]> {
        let error = node.error_input.zip(error);
        if let (Some(constant), None) = (&node.constant_inputs, error) {
            return Arc::clone(constant);
        }
        let (slots, tables) = (&self.run.frames.get(parent).slots, &self.program.tables);
        let flowing = |port: usize| match error {
            Some((index, error)) if index as usize == port => Some(error.clone()),
            _ => newest(slots, tables.slots(node.gather, port), |value| !value.is_none()).cloned(),
        };
        inputs(node, path, self.globals, &mut self.out.events, flowing)
    }

    /// The inputs of a state without data flows: the values of `given`, otherwise the defaults.
    pub(in crate::engine) fn default_inputs(
        &mut self,
        node: &'s Node<D>,
        path: PathId,
        given: impl Fn(usize) -> Option<D>,
    ) -> Arc<[D]> {
        inputs(node, path, self.globals, &mut self.out.events, given)
    }

    /// Stores the initial values of a container: its inputs, then its scoped variables, into which inputs may flow.
    pub(in crate::engine) fn fill(&mut self, slot: u32, inside: &'s Inside<D>) {
        let frame = self.run.frames.get_mut(slot);
        frame.slots.resize(inside.slots as usize, Slot { sequence: 0, value: None });
        let inputs = frame.inputs.clone().unwrap_or_default();
        let initial = inside.scoped.iter().map(|scoped| &scoped.initial);
        for (value, place) in inputs.iter().chain(initial).zip(&mut frame.slots) {
            self.run.sequence += 1;
            *place = Slot { sequence: self.run.sequence, value: Some(value.clone()) };
        }
        let path = frame.path;
        let scoped = inside.scoped.iter();
        self.out.events.extend(scoped.map(|scoped| Event::Scoped {
            path,
            port: scoped.port.id,
            value: scoped.initial.clone(),
        }));
        self.store(
            slot,
            inside,
            &FlowingValues { flows: inside.scatter, values: &inputs, absent: &[] },
        );
        self.give_scoped(slot, inside);
    }

    /// Stores the outputs of an ended child where they flow.
    pub(in crate::engine) fn store_outputs(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        child: u32,
        ended: &Ended<D>,
    ) {
        let flows = self.program.node(inside.child(child)).scatter;
        let Ended { outputs: values, absent, .. } = ended;
        self.store(slot, inside, &FlowingValues { flows, values, absent });
    }

    fn store(&mut self, slot: u32, inside: &'s Inside<D>, flowing: &FlowingValues<'_, D>) {
        let &FlowingValues { flows, values, absent } = flowing;
        if flows.is_empty() {
            return;
        }
        // Ports come before scoped variables, so that the variable has the newer of two values from one state.
        let node = self.program.node(self.run.frames.get(slot).node);
        let variables = index(node.inputs.len())..index(node.inputs.len() + inside.scoped.len());
        for to_variables in [false, true] {
            for (port, value) in values.iter().enumerate() {
                if absent.iter().any(|&index| index as usize == port) {
                    continue;
                }
                let targets = self.program.tables.slots(flows, port).iter();
                let targets = targets.filter(|target| variables.contains(target) == to_variables);
                targets.for_each(|&target| self.put(slot, inside, target, value));
            }
        }
    }

    pub(in crate::engine) fn put(
        &mut self,
        slot: u32,
        inside: &'s Inside<D>,
        target: u32,
        value: &D,
    ) {
        let frame = self.run.frames.get_mut(slot);
        let Some(place) = frame.slots.get_mut(target as usize) else { return };
        self.run.sequence += 1;
        let slot = Slot { sequence: self.run.sequence, value: Some(value.clone()) };
        let replaced = std::mem::replace(place, slot);
        if let Children::Hierarchy(children) = &mut frame.children
            && children.undo_log.logs
        {
            children.undo_log.undo.push_back((target, replaced));
        }
        let node = self.program.node(frame.node);
        let variable = (target as usize).checked_sub(node.inputs.len());
        let Some(scoped) = variable.and_then(|index| inside.scoped.get(index)) else { return };
        let path = frame.path;
        if scoped.typed && is_misfit(value, &scoped.port.data_type) {
            self.note(path, Level::Error, mismatch(&scoped.port, value));
        }
        self.out.events.push(Event::Scoped { path, port: scoped.port.id, value: value.clone() });
    }

    /// The outputs of a container. Each port has the newest value that flows into it, including `None`, otherwise its
    /// default.
    pub(in crate::engine) fn container_outputs(
        &mut self,
        slot: u32,
        inside: &Inside<D>,
    ) -> Arc<[D]> {
        let frame = self.run.frames.get_mut(slot);
        let outputs = frame.outputs.take().unwrap_or_default();
        if inside.gather.is_empty() {
            return outputs;
        }
        let tables = &self.program.tables;
        let value = |(port, default): (usize, &D)| {
            newest(&frame.slots, tables.slots(inside.gather, port), |_| true)
                .unwrap_or(default)
                .clone()
        };
        outputs.iter().enumerate().map(value).collect()
    }

    /// Reports every input that does not fit the type of its port.
    pub(in crate::engine) fn check_inputs(
        &mut self,
        path: PathId,
        node: &'s Node<D>,
        values: &[D],
    ) {
        self.check(path, node.input_checks, values, || node.inputs());
    }

    /// Reports every output that does not fit the type of its port.
    pub(in crate::engine) fn check_outputs(
        &mut self,
        path: PathId,
        node: &'s Node<D>,
        values: &[D],
    ) {
        self.check(path, node.output_checks, values, || node.outputs());
    }

    /// Fetches the ports only if a value is a misfit.
    fn check(
        &mut self,
        path: PathId,
        checks: Checks,
        values: &[D],
        ports: impl Fn() -> &'s [Port],
    ) {
        for (index, declared) in self.program.tables.checks(checks) {
            let Some(value) = values.get(index).filter(|value| is_misfit(*value, declared)) else {
                continue;
            };
            if let Some(port) = ports().get(index) {
                self.note(path, Level::Error, mismatch(port, value));
            }
        }
    }
}

fn is_misfit<D: Datum>(value: &D, declared: &DataType) -> bool {
    !value.is_none() && value.fits(declared) == Answer::No
}

fn mismatch<D: Datum>(port: &Port, value: &D) -> Note {
    Note::TypeMismatch {
        port: port.name.clone(),
        expected: port.data_type.clone(),
        found: value.type_name(),
    }
}

/// The inputs of a state: the values of `given`, otherwise the defaults.
fn inputs<D: Datum>(
    node: &Node<D>,
    path: PathId,
    globals: &dyn Globals<D>,
    events: &mut Vec<Event<D>>,
    given: impl Fn(usize) -> Option<D>,
) -> Arc<[D]> {
    let value = |(port, initial): (usize, &Initial<D>)| {
        given(port).unwrap_or_else(|| {
            default(initial, globals).unwrap_or_else(|problem| {
                let note = Box::new(problem.note(node.inputs().get(port)));
                events.push(Event::Note { path, level: Level::Error, note });
                D::none()
            })
        })
    };
    node.inputs.iter().enumerate().map(value).collect()
}

/// A reason why a port has no default.
enum Problem<'p> {
    NoGlobal(&'p SmolStr),
    Bad(&'p SmolStr),
}

impl Problem<'_> {
    fn note(self, port: Option<&Port>) -> Note {
        match self {
            Self::NoGlobal(name) => Note::NoSuchGlobal { name: name.clone() },
            Self::Bad(reason) => {
                let port = port.map(|port| port.name.clone()).unwrap_or_default();
                Note::BadDefault { port, reason: reason.clone() }
            }
        }
    }
}

/// The value of a port without a data flow.
fn default<'p, D: Datum>(
    initial: &'p Initial<D>,
    globals: &dyn Globals<D>,
) -> Result<D, Problem<'p>> {
    match initial {
        Initial::Is(value) => Ok(value.clone()),
        Initial::Global(name) => globals.get(name).ok_or(Problem::NoGlobal(name)),
        Initial::Bad(reason) => Err(Problem::Bad(reason)),
    }
}
