//! A state while its lines are parsed.

use super::NotationError;
use super::connect::{Connection, ConnectionPart, part};
use super::scan::Line;
use rafcon_model::{
    Container, Kind, Layout, Library, LibraryContent, Outcome, OutcomeId, Port, PortId,
    RuntimeValue, RuntimeValues, Script, State, StateId, Value,
};
use smol_str::SmolStr;
use std::sync::Arc;

/// Result of the lines until now.
#[derive(Debug)]
pub(super) struct Draft<'t> {
    pub(super) state: State,
    connections: Vec<Connection<'t>>,
    settings: Vec<Setting<'t>>,
    /// True if a library state lists its outcomes and ports itself.
    own_interface: bool,
}

/// `set in x = 5`
#[derive(Debug)]
struct Setting<'t> {
    line: Line<'t>,
    is_input: bool,
    port: ConnectionPart,
    value: RuntimeValue,
}

impl<'t> Draft<'t> {
    /// Reads `kind ID "Name"` after the kind.
    pub(super) fn new(kind: &str, line: &mut Line<'t>) -> Result<Self, NotationError> {
        let id = StateId(line.name()?);
        let name = line.quoted()?.map_or_else(|| id.0.clone(), SmolStr::new);
        let kind = match kind {
            "execution" => Kind::Execution(Script::default()),
            "decider" => Kind::Decider(Script::default()),
            "hierarchy" => Kind::Hierarchy(Container::default()),
            "barrier" => Kind::Barrier(Container::default()),
            "preemptive" => Kind::Preemptive(Container::default()),
            _ => Kind::Library(library(line)?),
        };
        line.end()?;
        Ok(Self {
            state: State::new(id, name, kind),
            connections: Vec::new(),
            settings: Vec::new(),
            own_interface: false,
        })
    }

    /// Parses a line about the state itself; false if its keyword is unknown here.
    pub(super) fn line(&mut self, line: &mut Line<'t>) -> Result<bool, NotationError> {
        let word = line.peek_word();
        let begin = *line;
        line.eat_word(word);
        match word {
            "outcome" => self.outcome(line)?,
            "without" => self.without(line)?,
            "in" => self.port(line, DraftPortKind::Input)?,
            "out" => self.port(line, DraftPortKind::Output)?,
            "var" => self.port(line, DraftPortKind::Variable)?,
            "interface" => self.own_interface = true,
            "set" => self.setting(line)?,
            "missing" => self.missing(line)?,
            "semantic" => self.state.semantic_data = Some(Arc::new(line.json()?)),
            "layout" => self.state.layout = read_layout(line)?,
            "extra" => self.state.extra = Some(Box::new(line.json()?)),
            "flow" => self.connections.extend(super::connect::read(line, true)?),
            _ => {
                *line = begin;
                return Ok(false);
            }
        }
        line.end().map(|()| true)
    }

    pub(super) fn transitions(&mut self, line: &mut Line<'t>) -> Result<(), NotationError> {
        self.connections.extend(super::connect::read(line, false)?);
        Ok(())
    }

    /// Sets the script or description, whose text may span several lines.
    pub(super) fn text(
        &mut self,
        line: &Line<'t>,
        word: &str,
        text: &str,
    ) -> Result<(), NotationError> {
        if word == "description" {
            self.state.description = Some(text.into());
            return Ok(());
        }
        match &mut self.state.kind {
            Kind::Execution(script) | Kind::Decider(script) => script.text = Some(text.into()),
            Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_) | Kind::Library(_) => {
                return Err(line.error("only execution states and deciders have a script"));
            }
        }
        Ok(())
    }

    pub(super) fn child(
        &mut self,
        line: &Line<'t>,
        child: Arc<State>,
    ) -> Result<(), NotationError> {
        let Some(container) = self.state.container_mut() else {
            return Err(line.error("only hierarchies and concurrency states have children"));
        };
        let id = child.id.clone();
        match container.states.insert(id.clone(), child) {
            Some(_) => Err(line.error(format!("the state {id} occurs twice"))),
            None => Ok(()),
        }
    }

    pub(super) fn content(
        &mut self,
        line: &Line<'t>,
        root: Arc<State>,
    ) -> Result<(), NotationError> {
        let Kind::Library(library) = &mut self.state.kind else {
            return Err(line.error("only libraries have a content"));
        };
        if matches!(library.content, LibraryContent::Found(_)) {
            return Err(line.error("here is place for one state only"));
        }
        library.content = LibraryContent::Found(root);
        Ok(())
    }

    /// Returns the finished state with all names resolved.
    pub(super) fn finish(mut self) -> Result<Arc<State>, NotationError> {
        if !self.own_interface {
            take_interface_of_content(&mut self.state);
        }
        for setting in self.settings {
            setting.add_to(&mut self.state)?;
        }
        for connection in self.connections {
            connection.add_to(&mut self.state)?;
        }
        Ok(Arc::new(self.state))
    }

    fn outcome(&mut self, line: &mut Line<'t>) -> Result<(), NotationError> {
        self.own_interface = true;
        let id = line.number().map_or_else(|| self.state.free_outcome_id(), OutcomeId);
        let outcome = Outcome { extra: None, ..Outcome::new(id, line.name()?) };
        let outcome = Outcome { extra: line.extra()?, ..outcome };
        let earlier = self.state.outcomes.insert(outcome);
        if earlier.is_some() && !id.is_mandatory() {
            return Err(line.error(format!("the outcome {id} occurs twice")));
        }
        Ok(())
    }

    fn without(&mut self, line: &mut Line<'t>) -> Result<(), NotationError> {
        self.own_interface = true;
        let id = line.number().ok_or_else(|| line.error("expected the id of an outcome"))?;
        self.state.outcomes.remove(OutcomeId(id));
        Ok(())
    }

    fn port(&mut self, line: &mut Line<'t>, kind: DraftPortKind) -> Result<(), NotationError> {
        self.own_interface = true;
        let id = line.number().map_or_else(|| self.state.free_port_id(), PortId);
        let name = line.name()?;
        line.expect(":")?;
        let data_type = line.data_type()?;
        let default = if line.eat("=") { line.value()? } else { Value::None };
        let port = Port { extra: line.extra()?, ..Port::new(id, name, data_type, default) };
        let ports = match kind {
            DraftPortKind::Input => &mut self.state.inputs,
            DraftPortKind::Output => &mut self.state.outputs,
            DraftPortKind::Variable => match self.state.container_mut() {
                Some(container) => &mut container.scoped_variables,
                None => return Err(line.error("only containers have scoped variables")),
            },
        };
        match ports.insert(port) {
            Some(_) => Err(line.error(format!("the port {id} occurs twice"))),
            None => Ok(()),
        }
    }

    fn setting(&mut self, line: &mut Line<'t>) -> Result<(), NotationError> {
        let begin = *line;
        let is_input = line.eat_word("in");
        if !is_input && !line.eat_word("out") {
            return Err(line.error("expected `in` or `out`"));
        }
        let port = part(line)?;
        line.expect("=")?;
        let value = line.value()?;
        let used = !line.eat_word("unused");
        let value = RuntimeValue { value, used };
        self.settings.push(Setting { line: begin, is_input, port, value });
        Ok(())
    }

    fn missing(&mut self, line: &mut Line<'t>) -> Result<(), NotationError> {
        let reason = line.name()?;
        let Kind::Library(library) = &mut self.state.kind else {
            return Err(line.error("only libraries can be missing"));
        };
        library.content = LibraryContent::Missing { reason };
        Ok(())
    }
}

#[derive(Clone, Copy)]
enum DraftPortKind {
    Input,
    Output,
    Variable,
}

impl Setting<'_> {
    fn add_to(self, state: &mut State) -> Result<(), NotationError> {
        let ports = if self.is_input { &state.inputs } else { &state.outputs };
        let id = match &self.port {
            ConnectionPart::Id(id) => PortId(*id),
            ConnectionPart::Name(name) => match ports.by_name(name) {
                Some(port) => port.id,
                None => return Err(self.line.error(format!("there is no port {}", self.port))),
            },
        };
        let Kind::Library(library) = &mut state.kind else {
            return Err(self.line.error("only libraries have runtime values"));
        };
        let values: &mut RuntimeValues =
            if self.is_input { &mut library.inputs } else { &mut library.outputs };
        values.insert(id, self.value);
        Ok(())
    }
}

/// Reads `from "path/name" version "1"`.
fn library(line: &mut Line<'_>) -> Result<Library, NotationError> {
    let (mut path, mut name) = (SmolStr::default(), SmolStr::default());
    if line.eat_word("from") {
        let first = line.name()?;
        (path, name) = match (line.quoted()?, first.rsplit_once('/')) {
            (Some(name), _) => (first, name.into()),
            (None, Some((path, name))) => (path.into(), name.into()),
            (None, None) => (path, first),
        };
    }
    let version = if line.eat_word("version") { Some(line.name()?) } else { None };
    let (inputs, outputs) = (RuntimeValues::new(), RuntimeValues::new());
    let content = LibraryContent::Missing { reason: SmolStr::default() };
    Ok(Library { path, name, version, inputs, outputs, content })
}

/// Reads a layout: a document, or a text that is not a valid one.
pub(super) fn read_layout(line: &mut Line<'_>) -> Result<Layout, NotationError> {
    match line.quoted()? {
        Some(text) => Ok(Layout::from_text(&text)),
        None => line.json().map(|json| Layout::from_json(&json)),
    }
}

fn take_interface_of_content(state: &mut State) {
    let Kind::Library(Library { content: LibraryContent::Found(root), .. }) = &state.kind else {
        return;
    };
    let root = Arc::clone(root);
    state.outcomes = root.outcomes.clone();
    state.inputs = root.inputs.clone();
    state.outputs = root.outputs.clone();
}
