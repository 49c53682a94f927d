//! One state and what it consists of.

use crate::ids::smallest_free;
use crate::port::Extra;
use crate::sorted::Sorted;
use crate::{
    DataFlows, Json, Origin, Outcome, OutcomeId, Outcomes, PortId, Ports, StateId, Target,
    Transitions, Value, json,
};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// A node of the tree.
#[derive(Debug, Clone)]
pub struct State {
    /// Unique among its siblings and different from its parent's.
    pub id: StateId,
    /// For people; at least one character, no `/`.
    pub name: SmolStr,
    /// Markdown, for people; `None` if there is no description.
    pub description: Option<Arc<str>>,
    /// The ways to end; always with aborted (-1) and preempted (-2).
    pub outcomes: Outcomes,
    /// Ports for the values that it receives when it is entered.
    pub inputs: Ports,
    /// Ports for the values that it returns when it ends.
    pub outputs: Ports,
    /// Nested notes of the user, keys are strings; `None` when there are none.
    pub semantic_data: Option<Arc<Json>>,
    /// The positions of its parts on the screen.
    pub layout: Layout,
    /// The kind of the state, with everything that only this kind has.
    pub kind: Kind,
    /// Unknown keys of the file.
    pub extra: Extra,
    /// Damage of the state's own file, with the remedy. A damaged state aborts before it does anything.
    pub damage: Option<SmolStr>,
}

/// The five kinds of states of the reference, and the decider of a barrier.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// Runs a script, which returns the outcome.
    Execution(Script),
    /// Runs a script that decides how its barrier ends.
    Decider(Script),
    /// Runs its children in sequence.
    Hierarchy(Container),
    /// Runs its children concurrently, waits for all, then runs the decider.
    Barrier(Container),
    /// Runs its children concurrently until the first ends.
    Preemptive(Container),
    /// Runs another state machine.
    Library(Library),
}

/// A kind without content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum KindName {
    /// See [`Kind::Execution`]: a script.
    Execution,
    /// See [`Kind::Decider`]: the script of a barrier.
    Decider,
    /// See [`Kind::Hierarchy`]: children in sequence.
    Hierarchy,
    /// See [`Kind::Barrier`]: concurrent children; waits for all.
    Barrier,
    /// See [`Kind::Preemptive`]: concurrent children; the first ends all.
    Preemptive,
    /// See [`Kind::Library`]: another state machine.
    Library,
}

impl fmt::Display for KindName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Execution => "execution",
            Self::Decider => "decider",
            Self::Hierarchy => "hierarchy",
            Self::Barrier => "barrier concurrency",
            Self::Preemptive => "preemptive concurrency",
            Self::Library => "library",
        })
    }
}

/// Deep equality that skips shared parts. Never recurses, so that depth cannot overflow the stack.
impl PartialEq for State {
    fn eq(&self, other: &Self) -> bool {
        let mut open = vec![(self, other)];
        while let Some((a, b)) = open.pop() {
            if std::ptr::eq(a, b) {
                continue;
            }
            if !a.is_same_alone(b) || !push_inside(a, b, &mut open) {
                return false;
            }
        }
        true
    }
}

/// Pairs of the children of `a` and `b`; false if they differ in number or id.
fn push_inside<'s>(a: &'s State, b: &'s State, open: &mut Vec<(&'s State, &'s State)>) -> bool {
    if let (Some(a), Some(b)) = (a.container(), b.container()) {
        let (a, b) = (&a.states, &b.states);
        if a.len() != b.len() || !a.keys().eq(b.keys()) {
            return false;
        }
        open.extend(a.values().zip(b.values()).map(|(a, b)| (&**a, &**b)));
    }
    if let (Kind::Library(a), Kind::Library(b)) = (&a.kind, &b.kind) {
        match (&a.content, &b.content) {
            (LibraryContent::Found(a), LibraryContent::Found(b)) => open.push((a, b)),
            (a, b) => return a == b,
        }
    }
    true
}

impl Kind {
    /// True if both are equal except for children, scripts and the content of a library.
    pub(crate) fn is_same_shell(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Execution(_), Self::Execution(_)) | (Self::Decider(_), Self::Decider(_)) => true,
            (Self::Hierarchy(a), Self::Hierarchy(b))
            | (Self::Barrier(a), Self::Barrier(b))
            | (Self::Preemptive(a), Self::Preemptive(b)) => {
                a.scoped_variables == b.scoped_variables
                    && a.transitions == b.transitions
                    && a.data_flows == b.data_flows
            }
            (Self::Library(a), Self::Library(b)) => {
                (&a.path, &a.name, &a.version) == (&b.path, &b.name, &b.version)
                    && (&a.inputs, &a.outputs) == (&b.inputs, &b.outputs)
            }
            _ => false,
        }
    }

    /// The kind without content.
    pub fn name(&self) -> KindName {
        match self {
            Self::Execution(_) => KindName::Execution,
            Self::Decider(_) => KindName::Decider,
            Self::Hierarchy(_) => KindName::Hierarchy,
            Self::Barrier(_) => KindName::Barrier,
            Self::Preemptive(_) => KindName::Preemptive,
            Self::Library(_) => KindName::Library,
        }
    }
}

/// The Python text of an execution state.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Script {
    /// `None` when the machine has no `script.py` for the state.
    pub text: Option<Arc<str>>,
}

impl State {
    /// A state with the two mandatory outcomes and nothing else.
    pub fn new(id: StateId, name: impl AsRef<str>, kind: Kind) -> Self {
        let outcomes = [
            Outcome::new(OutcomeId::ABORTED, "aborted"),
            Outcome::new(OutcomeId::PREEMPTED, "preempted"),
        ];
        Self {
            id,
            name: SmolStr::new(name),
            description: None,
            outcomes: outcomes.into_iter().collect(),
            inputs: Ports::default(),
            outputs: Ports::default(),
            semantic_data: None,
            layout: Layout::default(),
            kind,
            extra: None,
            damage: None,
        }
    }

    /// True if both are equal except for their content.
    fn is_same_alone(&self, other: &Self) -> bool {
        (&self.id, &self.name, &self.description) == (&other.id, &other.name, &other.description)
            && (&self.outcomes, &self.inputs, &self.outputs)
                == (&other.outcomes, &other.inputs, &other.outputs)
            && (&self.semantic_data, &self.layout, &self.extra)
                == (&other.semantic_data, &other.layout, &other.extra)
            && self.damage == other.damage
            && self.script() == other.script()
            && self.kind.is_same_shell(&other.kind)
    }

    /// The inside of a hierarchy or concurrency state.
    pub fn container(&self) -> Option<&Container> {
        match &self.kind {
            Kind::Hierarchy(c) | Kind::Barrier(c) | Kind::Preemptive(c) => Some(c),
            Kind::Execution(_) | Kind::Decider(_) | Kind::Library(_) => None,
        }
    }

    /// The inside of a hierarchy or concurrency state, mutable.
    pub fn container_mut(&mut self) -> Option<&mut Container> {
        match &mut self.kind {
            Kind::Hierarchy(c) | Kind::Barrier(c) | Kind::Preemptive(c) => Some(c),
            Kind::Execution(_) | Kind::Decider(_) | Kind::Library(_) => None,
        }
    }

    /// The smallest id from 0 on that no port or scoped variable has.
    pub fn free_port_id(&self) -> PortId {
        let variables = self.container().map(|container| &container.scoped_variables);
        let lists = [Some(&self.inputs), Some(&self.outputs), variables];
        let has = |id| lists.iter().flatten().any(|ports| ports.get(PortId(id)).is_some());
        PortId(smallest_free(has))
    }

    /// The smallest id from 0 on that no outcome has.
    pub fn free_outcome_id(&self) -> OutcomeId {
        OutcomeId(smallest_free(|id| self.outcomes.get(OutcomeId(id)).is_some()))
    }

    /// The script of an execution state or decider.
    pub fn script(&self) -> Option<&Script> {
        match &self.kind {
            Kind::Execution(script) | Kind::Decider(script) => Some(script),
            Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_) | Kind::Library(_) => None,
        }
    }
}

/// Layout of a state and its parts, kept as compact JSON text (no white space between its parts), so that nothing of it
/// is lost and ten thousand of them fit in memory; read and changed through [`Layout::json`] and [`Layout::from_json`]
/// (`docs/format.md`, layout).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Layout(Option<Arc<str>>);

impl Layout {
    /// The text of a `meta_data.json`; to be equal to one from [`Layout::from_json`], it must be compact.
    pub fn from_text(text: &str) -> Self {
        Self(Some(text.into()))
    }

    /// A layout from a document. An empty object makes a layout without text.
    pub fn from_json(document: &Json) -> Self {
        match document {
            Json::Object(members) if members.is_empty() => Self(None),
            _ => Self(Some(json::write_compact(document).into())),
        }
    }

    /// The text, if there is any.
    pub fn text(&self) -> Option<&str> {
        self.0.as_deref()
    }

    /// The parsed document; an empty object if there is none or it is not JSON.
    pub fn json(&self) -> Json {
        self.text().and_then(|text| json::parse(text).ok()).unwrap_or_else(Json::object)
    }
}

/// Child states by id; the order of the map is the order of children everywhere.
pub type States = Sorted<StateId, Arc<State>>;

/// Children and the lines between them. Cloning shares everything.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Container {
    /// The child states, sorted by id.
    pub states: States,
    /// The transitions between the children.
    pub transitions: Transitions,
    /// The data flows between ports of the children and the container.
    pub data_flows: DataFlows,
    /// Variables that the children share through data flows.
    pub scoped_variables: Ports,
}

impl Container {
    /// The start: the target of the start transition in the container with the id `id`.
    pub fn start(&self, id: &StateId) -> Option<Target> {
        self.transitions.from(&Origin::Income).next()?.target(id)
    }
}

/// The reference to a library and the values of this instance. Outcomes and ports of the library state are those of the
/// library's root; the surrounding [`State`] has them.
#[derive(Debug, Clone, PartialEq)]
pub struct Library {
    /// Root name and folders below it, joined by `/`: `generic/dialog`.
    pub path: SmolStr,
    /// The folder of the library.
    pub name: SmolStr,
    /// The version that the instance was made with; `None` for no version.
    pub version: Option<SmolStr>,
    /// Values of input ports.
    pub inputs: RuntimeValues,
    /// Values of output ports.
    pub outputs: RuntimeValues,
    /// The content under `path` and `name`.
    pub content: LibraryContent,
}

/// Runtime values by port.
pub type RuntimeValues = BTreeMap<PortId, RuntimeValue>;

/// The value of a library instance for one port.
#[derive(Debug, Clone, PartialEq)]
pub struct RuntimeValue {
    /// The value in the file (like a port's default).
    pub value: Value,
    /// True if it replaces the port's default.
    pub used: bool,
}

/// The content of a library state.
#[derive(Debug, Clone, PartialEq)]
pub enum LibraryContent {
    /// The library's root state, shared by all its instances.
    Found(Arc<State>),
    /// It was not found. The instance keeps its reference, runtime values, and the ports that its connections use.
    Missing {
        /// The reason, for the user.
        reason: SmolStr,
    },
}
