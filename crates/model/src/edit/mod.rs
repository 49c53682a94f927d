//! Edits: changes of a machine as values. Knows the effects of an edit on everything connected; never
//! who asks for it, nor when.
//!
//! [`apply`] changes a machine in place and returns the edit that undoes the change. A refused edit changes nothing.
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

/// A change of a machine. The path is that of the state with the changed part: for transitions, data flows and children
/// it is the container.
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
    /// Changes a runtime value of a library state.
    RuntimeValue(StatePath, PortKind, PortId, RuntimeValueEdit),
    /// Changes the position of a state or one of its parts on the screen.
    Layout(StatePath, LayoutEdit),
    /// Changes the states in a container.
    Children(StatePath, ChildrenEdit),
    /// Changes the machine itself.
    Header(HeaderEdit),
    /// Several edits in sequence; all or none.
    Batch(Vec<Self>),
    /// Undoes an edit; made by [`apply`].
    Restore(Box<Restore>),
}

/// A change of a state itself.
#[derive(Debug, Clone, PartialEq)]
pub enum StateEdit {
    /// Sets the name, which needs at least one character and no `/`.
    SetName(SmolStr),
    /// Changes its id; its connections follow.
    SetId(StateId),
    /// Sets or removes the description; an empty one is removed.
    SetDescription(Option<Arc<str>>),
    /// Sets or removes the semantic data.
    SetSemanticData(Option<Arc<Json>>),
    /// Sets or removes the script of an execution state or decider.
    SetScript(Option<Arc<str>>),
    /// Changes its kind to execution, hierarchy, barrier or preemptive. Id, name, description, semantic data,
    /// outcomes and ports stay. From container to container the children (without a decider), data flows and scoped
    /// variables stay, the transitions are removed; otherwise the inside is removed. A barrier gets a decider.
    SetKind(KindName),
}

/// A change of an outcome.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OutcomeEdit {
    /// Adds it with this name.
    Add(SmolStr),
    /// Sets the name, unique among the outcomes of the state.
    Rename(SmolStr),
    /// Removes it with its transitions.
    Remove,
}

/// A change of a port or scoped variable.
#[derive(Debug, Clone, PartialEq)]
pub enum PortEdit {
    /// Adds a port or scoped variable with the id of the edit.
    Add {
        /// Name, unique among the ports of its kind.
        name: SmolStr,
        /// Declared type of its values.
        data_type: DataType,
        /// Its default; a text is converted to the type when a run starts.
        default: Value,
    },
    /// Sets the name, unique among the ports of its kind.
    Rename(SmolStr),
    /// Changes its type; a default that does not fit is refused, unless one batch sets both, default first.
    SetType(DataType),
    /// Sets the default, which must fit the type.
    SetDefault(Value),
    /// Removes it with its data flows.
    Remove,
}

/// A change of a transition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TransitionEdit {
    /// Adds a transition with the id of the edit.
    Add {
        /// The income of the container, or an outcome of a child.
        from: Origin,
        /// The income of a child, or an outcome of the container.
        to: Target,
    },
    /// Moves the beginning to another origin.
    SetOrigin(Origin),
    /// Moves the end to another target.
    SetTarget(Target),
    /// Removes the transition from the container.
    Remove,
}

/// A change of a data flow. An end is a state (a child or the container) and one of its ports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DataFlowEdit {
    /// Adds a data flow with the id of the edit.
    Add {
        /// Source: state and port.
        from: (StateId, PortId),
        /// Target: state and port.
        to: (StateId, PortId),
    },
    /// Moves the beginning to another port.
    SetSource((StateId, PortId)),
    /// Moves the end to another port.
    SetTarget((StateId, PortId)),
    /// Removes the data flow from the container.
    Remove,
}

/// A change of a runtime value of a library state.
#[derive(Debug, Clone, PartialEq)]
pub enum RuntimeValueEdit {
    /// Sets the value and uses it.
    Set(Value),
    /// Uses the value, or the default of the library.
    SetUsed(bool),
    /// Removes the value, so that the library's default applies.
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
    /// Sets or removes the start of a hierarchy.
    SetStart(Option<Target>),
    /// Moves states and scoped variables into a new hierarchy; connections across its border get outcomes and ports.
    Group {
        /// The states that move into the group.
        states: Vec<StateId>,
        /// The scoped variables that move with them.
        scoped_variables: Vec<PortId>,
        /// The id of the new hierarchy.
        id: StateId,
        /// Name of the new hierarchy.
        name: SmolStr,
    },
    /// Replaces a container by its children.
    Ungroup {
        /// The container to dissolve.
        state: StateId,
        /// Ids for children whose own id is taken, used in turn.
        fresh: Vec<StateId>,
    },
    /// Replaces a state by another. A connection is kept if the other state has an outcome with an equal name, or a port with an
    /// equal name and type. Such ports also keep defaults and runtime values.
    Substitute {
        /// The state to replace.
        state: StateId,
        /// The replacement. Its id is free, or that of the replaced state.
        by: Arc<State>,
    },
    /// Moves states to another container, with the connections between them.
    Move {
        /// The states that move.
        states: Vec<StateId>,
        /// Path of the container that receives the states.
        to: StatePath,
        /// New ids, in the order of `states`; those without one keep theirs.
        ids: Vec<StateId>,
    },
    /// Adds copies of states, see [`copy`].
    Paste {
        /// The copied states and their connections.
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
    /// Replaces the whole header.
    Set(Header),
}
