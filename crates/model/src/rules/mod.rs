//! The rules of a valid machine, each with its name and the remedy when it is broken. Knows how to check one
//! part of one state; [`problems`](crate::problems()) checks all parts, edits those that they touch.

mod interface;
mod library;
mod lost_link;
mod part;
mod state;
mod transition;
mod wire;

pub(crate) use lost_link::{PoliciesAround, traps};
pub use part::{Part, PortKind};
pub(crate) use part::{errors_of, faults_of, parts};
pub use state::MAX_NESTING;

use std::fmt;

/// Severity of a broken rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Severity {
    /// The machine does not work as it is drawn.
    Error,
    /// A note. It refuses no edit.
    Note,
}

/// A rule that a part of a state breaks, and the details.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fault {
    pub(crate) rule: Rule,
    pub(crate) what: String,
}

impl Fault {
    pub(crate) fn new(rule: Rule, what: impl Into<String>) -> Self {
        Self { rule, what: what.into() }
    }
}

macro_rules! rules {
    ($($(#[$doc:meta])* $name:ident: $severity:ident, $way_out:literal;)*) => {
        /// A rule about machines and edits (`docs/semantics.md`, rules of a machine).
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Rule {
            $($(#[$doc])* $name,)*
        }

        impl Rule {
            /// All rules, in the order of their definition.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// The severity of breaking this rule.
            pub fn severity(self) -> Severity {
                match self {
                    $(Self::$name => Severity::$severity,)*
                }
            }

            /// The remedy for the user.
            pub fn way_out(self) -> &'static str {
                match self {
                    $(Self::$name => $way_out,)*
                }
            }

            /// The name for programs.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => stringify!($name),)*
                }
            }
        }
    };
}

rules! {
    /// A state's name has at least one character.
    StateName: Error, "give the state a name";
    /// A state's name has no `/`.
    StateNameSlash: Error, "take the `/` out of the name";
    /// A state's id has at least one character and no `/`.
    StateId: Error, "give the state another id";
    /// A state's id differs from its parent's.
    StateIdOfParent: Error, "give the state another id";
    /// States are nested at most [`MAX_NESTING`] levels deep.
    Nesting: Error, "put the inner part into a library or remove levels";
    /// Semantic data is a dictionary.
    SemanticData: Error, "put the data under a key";
    /// A lost-link policy contains actions with their delays in seconds.
    LostLink: Note, "write the text continue, or seconds under finish_s, hold_s or recover_s; it is ignored until then";
    /// A state that a lost-link policy preempts has a transition from *preempted*.
    LostLinkRecovery: Note, "lead the outcome preempted to the state that recovers";
    /// A state whose policy pauses behind it ends by itself.
    LostLinkFinish: Note, "set hold_s or recover_s on the state, or finish_s on the states in it";
    /// A state that a policy may pause behind still recovers.
    LostLinkFinishFirst: Note, "put the state into one that recovers, too, or remove finish_s";
    /// No policy pauses a recovery.
    LostLinkWayHome: Note, "write continue under this key on the state to which preempted leads";
    /// An execution state has a script; without one it aborts.
    ScriptMissing: Note, "write a script";
    /// A barrier has a decider.
    DeciderMissing: Error, "add the decider, or make the state another kind";
    /// A decider is in a barrier, under its fixed id.
    DeciderMisplaced: Error, "make it an execution state with an id of its own";
    /// Every state has the outcomes aborted (-1) and preempted (-2).
    OutcomeMissing: Error, "add the outcome";
    /// An outcome's name has at least one character.
    OutcomeName: Error, "give the outcome a name";
    /// An outcome's name is unique in its state.
    OutcomeNameTwice: Error, "rename one of the outcomes";
    /// An outcome of a child leads somewhere, in a barrier only that of the decider; otherwise the run waits there for ever.
    OutcomeUnconnected: Note, "connect the outcome if it can happen";
    /// The name of a port or scoped variable has at least one character.
    PortName: Error, "give the port a name";
    /// The name of a port is unique in its kind.
    PortNameTwice: Error, "rename one of the ports";
    /// The id of a port is unique over inputs, outputs and scoped variables of a state.
    PortIdTwice: Error, "remove one of the ports and add it again";
    /// The name `error` is reserved for errors of scripts.
    PortNamedError: Note, "choose another name unless the port takes the error";
    /// A type is a dotted Python name.
    DataTypeName: Error, "write the type as in Python, such as int or numpy.ndarray";
    /// A default fits the type.
    DefaultType: Error, "change the default or the type";
    /// A hierarchy with children has a start; without one the run waits there for ever.
    StartMissing: Error, "connect the income with a child";
    /// A hierarchy or preemptive concurrency state has children; without one the run waits there for ever.
    ChildrenMissing: Error, "add a state; in a hierarchy, also connect the income with it";
    /// The transitions of a hierarchy lead from its start to each of its children.
    Unreachable: Note, "lead a transition to the state, or remove it";
    /// A container has at most one start transition.
    StartTwice: Error, "remove one of the start transitions";
    /// A concurrency state has no start transition: all its children start.
    StartInConcurrency: Error, "remove the start transition";
    /// A transition begins at the income, or at an outcome of a state.
    OriginIncomplete: Error, "connect the beginning with an outcome of a child";
    /// A transition does not begin at its own container.
    OriginContainer: Error, "connect the beginning with an outcome of a child";
    /// The state where a transition begins exists.
    OriginState: Error, "connect the beginning with an outcome of a child, or remove the transition";
    /// The outcome where a transition begins exists.
    OriginOutcome: Error, "connect the beginning with an outcome that exists, or remove the transition";
    /// At most one transition begins at an outcome.
    OriginTwice: Error, "remove one of the transitions";
    /// A transition leads somewhere.
    TargetMissing: Error, "connect the end with a child or an outcome of the container";
    /// A transition to the container names one of its outcomes.
    TargetIncomplete: Error, "connect the end with an outcome of the container";
    /// The state where a transition leads exists.
    TargetState: Error, "connect the end with a child or an outcome of the container, or remove the transition";
    /// The outcome where a transition leads exists.
    TargetOutcome: Error, "connect the end with an outcome that exists, or remove the transition";
    /// A transition to a child leads to its income, not to one of its outcomes.
    TargetOutcomeOfChild: Error, "connect the end with the child's income";
    /// In a preemptive concurrency state all transitions lead to the container.
    PreemptiveTarget: Error, "connect the end with an outcome of the container";
    /// The transitions of a decider lead to the container.
    DeciderTarget: Error, "connect the end with an outcome of the container";
    /// In a barrier the children lead to the decider, only aborted and preempted also to those of the container.
    BarrierTarget: Error, "connect the end with the decider";
    /// The states of a data flow exist.
    FlowState: Error, "connect the data flow with a child or the container, or remove it";
    /// The ports of a data flow exist.
    FlowPort: Error, "connect the data flow with a port that exists, or remove it";
    /// A data flow does not lead to its own beginning.
    FlowSamePort: Error, "connect the two ends with different ports";
    /// A data flow begins at an output of a child, or an input or scoped variable of the container.
    FlowSource: Error, "begin at an output of a child, or at an input or scoped variable of the container";
    /// A data flow ends at an input of a child, or an output or scoped variable of the container.
    FlowTarget: Error, "end at an input of a child, or at an output or scoped variable of the container";
    /// A data flow does not connect two scoped variables.
    FlowBetweenVariables: Error, "let a state pass the value on";
    /// Two ports are connected once.
    FlowTwice: Error, "remove one of the data flows";
    /// The type at the beginning of a data flow is the one at its end, inherits from it, or one of both is `object`.
    FlowType: Error, "change one of the types, or use object";
    /// Only Python knows whether one type inherits from another.
    FlowTypeUnknown: Note, "it is checked when the machine runs";
    /// A library was found.
    LibraryMissing: Error, "check the library paths, or substitute the state";
    /// A library state names its library.
    LibraryName: Error, "substitute the state by a library that exists";
    /// A library state has the outcomes and ports of its library.
    LibraryInterface: Error, "load the machine again, so that the state takes over the ports of its library";
    /// A runtime value belongs to a port.
    RuntimeValuePort: Error, "remove the runtime value";
    /// A runtime value that is used fits its port.
    RuntimeValueType: Error, "change the runtime value or do not use it";

    /// The state of an edit exists.
    NoSuchState: Error, "check the machine again: it may have changed";
    /// The element of an edit exists.
    NoSuchElement: Error, "check the machine again: it may have changed";
    /// A new element has a unique id.
    IdTaken: Error, "take another id";
    /// The outcomes aborted and preempted cannot be removed.
    OutcomeMandatory: Error, "rename the outcome, or leave it unconnected";
    /// A barrier keeps its decider.
    DeciderFixed: Error, "remove or change the barrier as a whole";
    /// The inside and the interface of a library are changed in the library.
    LibraryFixed: Error, "open the library and change it there, or replace the state by a copy of its content";
    /// The edit is for states of another kind.
    WrongKind: Error, "change the kind of the state first";
    /// A group is entered at only one state.
    GroupEntries: Error, "group states that are entered at one state only, or remove transitions first";
    /// A state does not move into itself.
    MoveIntoItself: Error, "choose a container outside the state";
}

impl Rule {
    /// True if an edit that breaks this rule is refused. A machine may have no start while it is drawn, and a library may be
    /// missing temporarily. A container is empty before its first state is added.
    pub fn refuses_edits(self) -> bool {
        let is_allowed =
            matches!(self, Self::LibraryMissing | Self::StartMissing | Self::ChildrenMissing);
        self.severity() == Severity::Error && !is_allowed
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
