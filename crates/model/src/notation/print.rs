//! Prints a machine in the notation. Knows the order of the lines; never fails and never recurses.

use super::shared::{Shared, content};
use super::{extra_text, fits_block, id_text, name_text, quoted, type_text, value_text};
use crate::ids::{id_after, smallest_free};
use crate::{
    Container, DataFlow, Header, Kind, Layout, Library, LibraryContent, Machine, OutcomeId, PortId,
    Ports, RuntimeValues, State, StateId, Transition, Value, json,
};

/// Which parts are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// Layout of states and of the machine.
    pub layout: bool,
    /// The text of scripts.
    pub scripts: bool,
    /// The content of libraries.
    pub contents: bool,
}

impl Shown {
    /// Everything: parsing the text gives an equal machine.
    pub const ALL: Self = Self { layout: true, scripts: true, contents: true };
    /// For people: without layout, scripts and the content of libraries.
    pub const OUTLINE: Self = Self { layout: false, scripts: false, contents: false };
}

/// The whole machine. Reading it gives an equal machine (members of JSON objects come in sorted order), and libraries
/// that are shared stay shared.
pub fn print(machine: &Machine) -> String {
    print_with(machine, Shown::ALL)
}

/// The machine without the hidden parts.
pub fn print_with(machine: &Machine, shown: Shown) -> String {
    let mut printer = Printer::new(&machine.root, shown);
    printer.header(&machine.header);
    printer.definitions();
    printer.states(&machine.root, 0);
    printer.out
}

struct Printer<'m> {
    shared: Shared<'m>,
    shown: Shown,
    out: String,
}

impl<'m> Printer<'m> {
    fn new(root: &'m State, shown: Shown) -> Self {
        Self { shared: Shared::of(root), shown, out: String::new() }
    }

    fn line(&mut self, depth: usize, text: &str) {
        for _ in 0..depth {
            self.out.push_str("  ");
        }
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn header(&mut self, header: &Header) {
        if *header == Header::default() {
            return;
        }
        self.line(0, "machine");
        if let Some(version) = &header.version {
            self.line(1, &format!("version {}", quoted(version)));
        }
        if !header.creation_time.is_empty() {
            self.line(1, &format!("created {}", quoted(&header.creation_time)));
        }
        if let Some(version) = &header.used_rafcon_version {
            self.line(1, &format!("writer {}", quoted(version)));
        }
        self.layout(&header.layout, 1);
        if let Some(extra) = &header.extra {
            self.line(1, &format!("extra {}", json::write_compact(extra)));
        }
    }

    fn definitions(&mut self) {
        if !self.shown.contents {
            return;
        }
        for content in std::mem::take(&mut self.shared.order) {
            let name = self.shared.name(content).unwrap_or_default().to_owned();
            self.line(0, &format!("define {name}"));
            self.states(content, 1);
        }
    }

    fn states(&mut self, root: &'m State, depth: usize) {
        let mut open = vec![(root, depth)];
        while let Some((state, depth)) = open.pop() {
            self.state(state, depth);
            if let Some(container) = state.container() {
                open.extend(container.states.values().rev().map(|child| (&**child, depth + 1)));
            }
            let inside = content(state).filter(|_| self.shown.contents);
            if let Some(content) = inside.filter(|content| self.shared.name(content).is_none()) {
                self.line(depth + 1, "content");
                open.push((content, depth + 2));
            }
        }
    }

    /// The lines of a state without those of its children.
    fn state(&mut self, state: &State, depth: usize) {
        let mut head = format!("{} {}", keyword(&state.kind), id_text(&state.id));
        if state.name != state.id.0 {
            head = format!("{head} {}", quoted(&state.name));
        }
        if let Kind::Library(library) = &state.kind {
            head.push_str(&library_text(library));
        }
        self.line(depth, &head);
        let depth = depth + 1;
        if let Some(text) = &state.description {
            self.text("description", text, depth);
        }
        self.interface(state, depth);
        self.notes(state, depth);
        match &state.kind {
            Kind::Execution(script) | Kind::Decider(script) => {
                if let Some(text) = script.text.as_ref().filter(|_| self.shown.scripts) {
                    self.text("script", text, depth);
                }
            }
            Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_) => {
                self.connections(state, depth);
            }
            Kind::Library(library) => self.library(state, library, depth),
        }
    }

    fn notes(&mut self, state: &State, depth: usize) {
        if let Some(semantic) = &state.semantic_data {
            self.line(depth, &format!("semantic {}", json::write_compact(semantic)));
        }
        self.layout(&state.layout, depth);
        if let Some(extra) = &state.extra {
            self.line(depth, &format!("extra {}", json::write_compact(extra)));
        }
    }

    fn layout(&mut self, layout: &Layout, depth: usize) {
        let Some(text) = layout.text().filter(|_| self.shown.layout) else { return };
        let document = layout.json();
        if Layout::from_json(&document) == *layout {
            self.line(depth, &format!("layout {}", json::write_compact(&document)));
        } else {
            self.line(depth, &format!("layout {}", quoted(text)));
        }
    }

    fn interface(&mut self, state: &State, depth: usize) {
        if let Some(root) = content(state).filter(|_| self.shown.contents) {
            if (&root.outcomes, &root.inputs, &root.outputs)
                == (&state.outcomes, &state.inputs, &state.outputs)
            {
                return;
            }
            self.line(depth, "interface");
        }
        self.outcomes(state, depth);
        let mut used = Vec::new();
        self.ports("in", &state.inputs, &mut used, depth);
        self.ports("out", &state.outputs, &mut used, depth);
        if let Some(container) = state.container() {
            self.ports("var", &container.scoped_variables, &mut used, depth);
        }
    }

    fn outcomes(&mut self, state: &State, depth: usize) {
        let plain = State::new(state.id.clone(), "", Kind::Execution(crate::Script::default()));
        for id in [OutcomeId::PREEMPTED, OutcomeId::ABORTED] {
            if state.outcomes.get(id).is_none() {
                self.line(depth, &format!("without {id}"));
            }
        }
        let mut used = Vec::new();
        for outcome in &state.outcomes {
            if plain.outcomes.get(outcome.id) == Some(outcome) {
                continue;
            }
            let free = smallest_free(|id| used.contains(&id));
            let id = if outcome.id.0 == free { String::new() } else { format!("{} ", outcome.id) };
            let extra = extra_text(outcome.extra.as_deref());
            self.line(depth, &format!("outcome {id}{}{extra}", name_text(&outcome.name)));
            used.push(outcome.id.0);
        }
    }

    fn ports(&mut self, word: &str, ports: &Ports, used: &mut Vec<PortId>, depth: usize) {
        for port in ports {
            let free = smallest_free(|id| used.contains(&PortId(id)));
            let id = if port.id.0 == free { String::new() } else { format!("{} ", port.id) };
            let name = name_text(&port.name);
            let data_type = type_text(&port.data_type);
            let default = match &port.default {
                Value::None => String::new(),
                value => format!(" = {}", value_text(value)),
            };
            let extra = extra_text(port.extra.as_deref());
            self.line(depth, &format!("{word} {id}{name}: {data_type}{default}{extra}"));
            used.push(port.id);
        }
    }

    fn connections(&mut self, state: &State, depth: usize) {
        let Some(container) = state.container() else { return };
        let mut last = None;
        for transition in container.transitions.iter() {
            let line = transition_text(state, transition);
            let id = id_suffix(transition.id.0, last);
            let extra = extra_text(transition.extra.as_deref());
            self.line(depth, &format!("{line}{id}{extra}"));
            last = Some(transition.id.0);
        }
        let mut last = None;
        for flow in container.data_flows.iter() {
            let line = flow_text(state, flow);
            let id = id_suffix(flow.id.0, last);
            let extra = extra_text(flow.extra.as_deref());
            self.line(depth, &format!("{line}{id}{extra}"));
            last = Some(flow.id.0);
        }
    }

    fn library(&mut self, state: &State, library: &Library, depth: usize) {
        self.settings("in", &state.inputs, &library.inputs, depth);
        self.settings("out", &state.outputs, &library.outputs, depth);
        match &library.content {
            LibraryContent::Missing { reason } if !reason.is_empty() => {
                self.line(depth, &format!("missing {}", quoted(reason)));
            }
            LibraryContent::Missing { .. } => {}
            LibraryContent::Found(root) => {
                if let Some(name) = self.shared.name(root).filter(|_| self.shown.contents) {
                    let line = format!("content {name}");
                    self.line(depth, &line);
                }
            }
        }
    }

    fn settings(&mut self, word: &str, ports: &Ports, values: &RuntimeValues, depth: usize) {
        for (id, setting) in values {
            let by_name = ports
                .get(*id)
                .filter(|port| ports.by_name(&port.name).is_some_and(|first| first.id == *id));
            let port = by_name.map_or_else(|| id.to_string(), |port| name_text(&port.name));
            let unused = if setting.used { "" } else { " unused" };
            self.line(
                depth,
                &format!("set {word} {port} = {}{unused}", value_text(&setting.value)),
            );
        }
    }

    fn text(&mut self, word: &str, text: &str, depth: usize) {
        if !text.contains('\n') || !fits_block(text) {
            return self.line(depth, &format!("{word} {}", quoted(text)));
        }
        self.line(depth, &format!("{word} {}", if text.ends_with('\n') { "|" } else { "|-" }));
        for line in text.strip_suffix('\n').unwrap_or(text).split('\n') {
            self.line(if line.is_empty() { 0 } else { depth + 1 }, line);
        }
    }
}

fn keyword(kind: &Kind) -> &'static str {
    match kind {
        Kind::Execution(_) => "execution",
        Kind::Decider(_) => "decider",
        Kind::Hierarchy(_) => "hierarchy",
        Kind::Barrier(_) => "barrier",
        Kind::Preemptive(_) => "preemptive",
        Kind::Library(_) => "library",
    }
}

fn library_text(library: &Library) -> String {
    let mut text = match (library.path.as_str(), library.name.as_str()) {
        ("", "") => String::new(),
        ("", name) if !name.contains('/') => format!(" from {}", quoted(name)),
        (path, name) if !name.contains('/') && !path.is_empty() => {
            format!(" from {}", quoted(&format!("{path}/{name}")))
        }
        (path, name) => format!(" from {} {}", quoted(path), quoted(name)),
    };
    if let Some(version) = &library.version {
        text = format!("{text} version {}", quoted(version));
    }
    text
}

fn transition_text(state: &State, transition: &Transition) -> String {
    let outcome = |id: Option<&StateId>, outcome: Option<OutcomeId>| {
        let outcome = outcome?;
        let owner = id.and_then(|id| owner(state, id));
        let named = owner.and_then(|owner| owner.outcomes.get(outcome).map(|found| (owner, found)));
        let named = named.filter(|(owner, o)| {
            owner.outcomes.by_name(&o.name).is_some_and(|first| first.id == outcome)
        });
        Some(named.map_or_else(|| outcome.to_string(), |(_, outcome)| name_text(&outcome.name)))
    };
    let end = |id: &Option<StateId>, part: Option<OutcomeId>, none: &str| {
        end_text(&state.id, id.as_ref(), outcome(id.as_ref(), part), none)
    };
    let from = end(&transition.from_state, transition.from_outcome, "start");
    let to = end(&transition.to_state, transition.to_outcome, "nowhere");
    format!("{from} -> {to}")
}

fn flow_text(state: &State, flow: &DataFlow) -> String {
    let end = |id: &StateId, port: PortId, side: Side| {
        let named =
            owner(state, id).and_then(|owner| port_name(owner, owner.id == state.id, side, port));
        let port = named.unwrap_or_else(|| port.to_string());
        end_text(&state.id, Some(id), Some(port), "nowhere")
    };
    let from = end(&flow.from_state, flow.from_port, Side::Source);
    let to = end(&flow.to_state, flow.to_port, Side::Target);
    format!("flow {from} -> {to}")
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

/// The name of a port, if the name identifies it.
fn port_name(owner: &State, own: bool, side: Side, id: PortId) -> Option<String> {
    let variables = owner.container().map(|container| &container.scoped_variables);
    [Some(&owner.inputs), Some(&owner.outputs), variables]
        .into_iter()
        .flatten()
        .filter_map(|ports| ports.get(id))
        .find(|port| port_by_name(owner, own, side, &port.name) == Some(id))
        .map(|port| name_text(&port.name))
}

/// The id of a connection, if it does not follow from that of the `last` one.
fn id_suffix(id: i64, last: Option<i64>) -> String {
    if id_after(last) == Some(id) { String::new() } else { format!(" as {id}") }
}

fn end_text(container: &StateId, id: Option<&StateId>, part: Option<String>, none: &str) -> String {
    let part = part.map(|part| format!(".{part}"));
    match (id, part) {
        (None, part) => format!("{none}{}", part.unwrap_or_default()),
        (Some(id), Some(part)) if id == container => part,
        (Some(id), part) => format!("{}{}", id_text(id), part.unwrap_or_default()),
    }
}
