//! Edits: changes of a machine as values. Knows what people change and what that means for everything connected; never
//! who asks for it, nor when.
//!
//! [`apply`] changes a machine in place and gives the edit that takes the change back. A refused edit changes nothing.
//!
//! ```
//! use rafcon_model::edit::{Edit, StateEdit, apply};
//! use rafcon_model::{BuiltinTypes, StatePath};
//! use rafcon_testkit::notation;
//!
//! let mut machine = notation::parse("execution ROOT \"Old\"")?;
//! let before = machine.clone();
//! let rename = Edit::State(StatePath::parse("ROOT"), StateEdit::SetName("New".into()));
//! let back = apply(&mut machine, rename, &BuiltinTypes)?;
//! assert_eq!(machine.root.name, "New");
//! apply(&mut machine, back, &BuiltinTypes)?;
//! assert_eq!(machine, before);
//!
//! let refused = Edit::State(StatePath::parse("ROOT"), StateEdit::SetName("".into()));
//! let error = apply(&mut machine, refused, &BuiltinTypes).unwrap_err();
//! assert_eq!(error.to_string(), "ROOT, state: the name is empty; give the state a name");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod apply;
mod children;
mod connections;
mod error;
mod forget;
mod group;
mod interface;
mod kind;
mod own;
mod place;
mod plan;
mod scope;
mod selection;
mod step;
mod substitute;
mod ungroup;
mod walk;

pub use apply::{Restore, apply};
pub use error::EditError;
pub use place::{LayoutEdit, LayoutElement};
pub use selection::{Selection, copy};
pub use step::{Field, Set, Step, with_id};

use crate::{
    DataFlowId, DataType, Header, Json, KindName, Layout, Origin, OutcomeId, PortId, PortKind,
    State, StateId, StatePath, Target, TransitionId, Value,
};
use smol_str::SmolStr;
use std::sync::Arc;

/// A change of a machine. The path is that of the state that has the changed part: for transitions, data flows and children
/// that of the container.
#[derive(Debug, Clone, PartialEq)]
pub enum Edit {
    /// Changes a state itself.
    State(StatePath, StateEdit),
    /// Changes an outcome of a state.
    Outcome(StatePath, OutcomeId, OutcomeEdit),
    /// Changes a port or scoped variable of a state.
    Port(StatePath, PortKind, PortId, PortEdit),
    /// Changes a transition in a container.
    Transition(StatePath, TransitionId, TransitionEdit),
    /// Changes a data flow in a container.
    DataFlow(StatePath, DataFlowId, DataFlowEdit),
    /// Changes what a library state sets for one of its ports.
    RuntimeValue(StatePath, PortKind, PortId, RuntimeValueEdit),
    /// Changes where a state or one of its parts stands on the screen.
    Layout(StatePath, LayoutEdit),
    /// Changes which states stand in a container.
    Children(StatePath, ChildrenEdit),
    /// Changes the machine itself.
    Header(HeaderEdit),
    /// Several edits, one after the other; all or none.
    Batch(Vec<Self>),
    /// Takes an edit back; made by [`apply`].
    Restore(Box<Restore>),
}

/// A change of a state itself.
#[derive(Debug, Clone, PartialEq)]
pub enum StateEdit {
    /// Gives it another name.
    SetName(SmolStr),
    /// Gives it another id; its connections follow.
    SetId(StateId),
    /// Sets or removes the description; an empty one is none.
    SetDescription(Option<Arc<str>>),
    /// Sets or removes the semantic data.
    SetSemanticData(Option<Arc<Json>>),
    /// Sets or removes the script of an execution state or decider.
    SetScript(Option<Arc<str>>),
    /// Makes it a state of another kind: execution, hierarchy, barrier or preemptive. Id, name, description, semantic data,
    /// outcomes and ports stay. From container to container the children (without a decider), data flows and scoped
    /// variables stay, the transitions go; otherwise the inside goes. A barrier gets a decider.
    SetKind(KindName),
}

/// A change of an outcome.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OutcomeEdit {
    /// Adds it with this name.
    Add(SmolStr),
    /// Gives it another name.
    Rename(SmolStr),
    /// Removes it with its transitions.
    Remove,
}

/// A change of a port or scoped variable.
#[derive(Debug, Clone, PartialEq)]
pub enum PortEdit {
    /// Adds it.
    Add {
        /// Its name.
        name: SmolStr,
        /// Its type.
        data_type: DataType,
        /// Its default; a text is converted to the type when a run starts.
        default: Value,
    },
    /// Gives it another name.
    Rename(SmolStr),
    /// Gives it another type; a default that does not fit is refused, unless both are set in one batch, default first.
    SetType(DataType),
    /// Gives it another default.
    SetDefault(Value),
    /// Removes it with its data flows.
    Remove,
}

/// A change of a transition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TransitionEdit {
    /// Adds it.
    Add {
        /// Where it begins.
        from: Origin,
        /// Where it leads.
        to: Target,
    },
    /// Lets it begin elsewhere.
    SetOrigin(Origin),
    /// Lets it lead elsewhere.
    SetTarget(Target),
    /// Removes it.
    Remove,
}

/// A change of a data flow. An end is a state (a child or the container) and one of its ports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DataFlowEdit {
    /// Adds it.
    Add {
        /// Where it begins.
        from: (StateId, PortId),
        /// Where it ends.
        to: (StateId, PortId),
    },
    /// Lets it begin elsewhere.
    SetSource((StateId, PortId)),
    /// Lets it end elsewhere.
    SetTarget((StateId, PortId)),
    /// Removes it.
    Remove,
}

/// A change of what a library state sets for a port.
#[derive(Debug, Clone, PartialEq)]
pub enum RuntimeValueEdit {
    /// Sets the value and uses it.
    Set(Value),
    /// Uses the value, or the default of the library.
    SetUsed(bool),
    /// Removes the value.
    Remove,
}

/// A change of the states in a container.
#[derive(Debug, Clone, PartialEq)]
pub enum ChildrenEdit {
    /// Adds a state with everything inside it. In a barrier each outcome from 0 on gets a transition to the decider; a new
    /// barrier without a decider gets one.
    Add(Arc<State>),
    /// Removes a state with its connections and everything inside it.
    Remove(StateId),
    /// Sets or removes where a hierarchy starts.
    SetStart(Option<Target>),
    /// Puts states and scoped variables into a new hierarchy; what crosses its border gets outcomes and ports.
    Group {
        /// What goes into the group.
        states: Vec<StateId>,
        /// Scoped variables that go with them.
        scoped_variables: Vec<PortId>,
        /// The id of the new hierarchy.
        id: StateId,
        /// Its name.
        name: SmolStr,
    },
    /// Puts the children of a container in its place.
    Ungroup {
        /// The container to dissolve.
        state: StateId,
        /// Ids for children whose own id is taken, used in turn.
        fresh: Vec<StateId>,
    },
    /// Puts a state in the place of another. Connections follow where outcomes have the same name, and ports the same name
    /// and type; defaults follow, too.
    Substitute {
        /// The state to replace.
        state: StateId,
        /// The new state.
        by: Arc<State>,
    },
    /// Moves states to another container, with the connections between them.
    Move {
        /// What moves.
        states: Vec<StateId>,
        /// The other container.
        to: StatePath,
        /// New ids, in the order of `states`; those without one keep theirs.
        ids: Vec<StateId>,
    },
    /// Adds copies of states, see [`copy`].
    Paste {
        /// What was copied.
        selection: Selection,
        /// New ids, in the order of the selection; those without one keep theirs.
        ids: Vec<StateId>,
    },
}

/// A change of the machine itself.
#[derive(Debug, Clone, PartialEq)]
pub enum HeaderEdit {
    /// Sets or removes the user's version.
    SetVersion(Option<SmolStr>),
    /// Sets the layout of the machine as a whole.
    SetLayout(Layout),
    /// Sets everything.
    Set(Header),
}
