//! Edits that clients send. Each edit is one JSON object, and its `edit` field names its type (see "on the wire" in
//! `docs/edits.md`).
//! This module knows the encoding of the model's edits, not their effects.
//!
//! ```
//! use rafcon_protocol::edit::Edit;
//!
//! let text = r#"{"edit":"set_name","path":"ROOT/SEARCH","name":"Search the table"}"#;
//! let edit: Edit = serde_json::from_str(text)?;
//! let model = rafcon_model::edit::Edit::try_from(&edit)?;
//! assert_eq!(Edit::of(&model), Some(edit));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod of;
mod read;
#[cfg(test)]
mod tests;

pub use read::EditFault;

use crate::document::{HeaderDocument, LayoutDocument, Selection, StateDocument, StateKind};
use serde::{Deserialize, Serialize};

/// A change of a machine. `path` names the state that owns the changed part: the container for transitions, data flows and
/// children.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[cfg_attr(feature = "schema", schema(no_recursion))]
#[serde(tag = "edit", rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// Changes the name of a state, but not its path.
    SetName {
        /// Path of the state.
        path: String,
        /// New name of the state.
        name: String,
    },
    /// Changes the id of a state. Its connections are updated.
    SetId {
        /// Path of the state.
        path: String,
        /// New id of the state.
        id: String,
    },
    /// Sets or removes the description of a state.
    SetDescription {
        /// Path of the state.
        path: String,
        /// Description in Markdown. Empty to remove it.
        #[serde(default)]
        description: Option<String>,
    },
    /// Sets or removes the user's notes.
    SetSemanticData {
        /// Path of the state.
        path: String,
        /// JSON object with the notes. Empty to remove them.
        #[serde(default)]
        semantic_data: Option<serde_json::Value>,
    },
    /// Sets or removes the script of an execution state or decider.
    SetScript {
        /// Path of the state.
        path: String,
        /// Python source. Empty to remove it.
        #[serde(default)]
        script: Option<String>,
    },
    /// Converts a state to another kind.
    SetKind {
        /// Path of the state.
        path: String,
        /// New kind: execution, hierarchy, barrier or preemptive.
        kind: StateKind,
    },
    /// Adds an outcome to a state.
    AddOutcome {
        /// Path of the state.
        path: String,
        /// Id of the outcome, unused in this state.
        outcome: i64,
        /// Name of the outcome.
        name: String,
    },
    /// Renames an outcome. Its transitions are kept.
    RenameOutcome {
        /// Path of the state.
        path: String,
        /// Id of the outcome.
        outcome: i64,
        /// New name of the outcome.
        name: String,
    },
    /// Removes an outcome and its transitions.
    RemoveOutcome {
        /// Path of the state.
        path: String,
        /// Id of the outcome.
        outcome: i64,
    },
    /// Adds a port or scoped variable.
    AddPort {
        /// Path of the state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id that no other port or scoped variable of the state has.
        port: i64,
        /// Name of the port or scoped variable.
        name: String,
        /// Python type, such as `int` or `numpy.ndarray`.
        data_type: String,
        /// Default value of the port or scoped variable.
        #[serde(default)]
        default: serde_json::Value,
    },
    /// Renames a port or scoped variable.
    RenamePort {
        /// Path of the state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id of the port.
        port: i64,
        /// New name of the port or scoped variable.
        name: String,
    },
    /// Changes the type of a port or scoped variable.
    SetPortType {
        /// Path of the state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id of the port.
        port: i64,
        /// New Python type, such as `int`.
        data_type: String,
    },
    /// Changes the default of a port or scoped variable.
    SetPortDefault {
        /// Path of the state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id of the port.
        port: i64,
        /// New default value of the port or scoped variable.
        #[serde(default)]
        default: serde_json::Value,
    },
    /// Removes a port or scoped variable and its data flows.
    RemovePort {
        /// Path of the state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id of the port.
        port: i64,
    },
    /// Adds a transition to a container.
    AddTransition {
        /// Path of the container.
        path: String,
        /// Id that no other transition of the container has.
        transition: i64,
        /// Outcome at which it starts. Empty for the income of the container.
        #[serde(default)]
        from: Option<OutcomeOf>,
        /// Target of the transition.
        to: Goal,
    },
    /// Moves the start of a transition.
    SetTransitionOrigin {
        /// Path of the container.
        path: String,
        /// Id of the transition.
        transition: i64,
        /// Outcome at which it starts. Empty for the income of the container.
        #[serde(default)]
        from: Option<OutcomeOf>,
    },
    /// Moves the end of a transition.
    SetTransitionTarget {
        /// Path of the container.
        path: String,
        /// Id of the transition.
        transition: i64,
        /// Target of the transition.
        to: Goal,
    },
    /// Removes a transition from a container.
    RemoveTransition {
        /// Path of the container.
        path: String,
        /// Id of the transition.
        transition: i64,
    },
    /// Adds a data flow to a container.
    AddDataFlow {
        /// Path of the container.
        path: String,
        /// Id that no other data flow of the container has.
        data_flow: i64,
        /// Port that it reads.
        from: PortOf,
        /// Port that it writes.
        to: PortOf,
    },
    /// Moves the start of a data flow.
    SetDataFlowSource {
        /// Path of the container.
        path: String,
        /// Id of the data flow.
        data_flow: i64,
        /// Port that it reads.
        from: PortOf,
    },
    /// Moves the end of a data flow.
    SetDataFlowTarget {
        /// Path of the container.
        path: String,
        /// Id of the data flow.
        data_flow: i64,
        /// Port that it writes.
        to: PortOf,
    },
    /// Removes a data flow from a container.
    RemoveDataFlow {
        /// Path of the container.
        path: String,
        /// Id of the data flow.
        data_flow: i64,
    },
    /// Sets a value for a port of a library state and activates it.
    SetRuntimeValue {
        /// Path of the library state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id of the port.
        port: i64,
        /// Value that replaces the library's default.
        #[serde(default)]
        value: serde_json::Value,
    },
    /// Selects the value set for a port of a library state, or the library's default.
    UseRuntimeValue {
        /// Path of the library state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id of the port.
        port: i64,
        /// Use the set value (true) or the library's default (false).
        used: bool,
    },
    /// Removes the value set for a port of a library state.
    RemoveRuntimeValue {
        /// Path of the library state.
        path: String,
        /// List that contains the port.
        list: PortList,
        /// Id of the port.
        port: i64,
    },
    /// Moves an element of the layout.
    SetPosition {
        /// Path of the state whose layout contains the element.
        path: String,
        /// The element to move.
        element: Element,
        /// x and y (downwards), in the coordinates of the file.
        position: [f64; 2],
    },
    /// Resizes a state or its name.
    SetSize {
        /// Path of the state.
        path: String,
        /// The element to resize.
        element: Element,
        /// Width and height, in the coordinates of the file.
        size: [f64; 2],
    },
    /// Sets the waypoints of a transition or data flow.
    SetWaypoints {
        /// Path of the container.
        path: String,
        /// The transition or data flow.
        element: Element,
        /// x and y of each waypoint.
        waypoints: Vec<[f64; 2]>,
    },
    /// Replaces the whole layout of a state.
    SetLayout {
        /// Path of the state.
        path: String,
        /// The new layout. Empty to remove it.
        #[serde(default)]
        layout: Option<LayoutDocument>,
    },
    /// Adds a state and its descendants.
    AddState {
        /// Path of the container.
        path: String,
        /// The state, then its descendants. The path of the first is its id.
        states: Vec<StateDocument>,
    },
    /// Removes a state, its connections and its descendants.
    RemoveState {
        /// Path of the container.
        path: String,
        /// Id of the state.
        state: String,
    },
    /// Sets or removes the start of a hierarchy.
    SetStart {
        /// Path of the hierarchy.
        path: String,
        /// Target of the start transition. Empty to remove it.
        #[serde(default)]
        to: Option<Goal>,
    },
    /// Groups states and scoped variables into a new hierarchy.
    Group {
        /// Path of the container.
        path: String,
        /// Ids of the states to group.
        states: Vec<String>,
        /// Ids of the scoped variables to move with the states.
        #[serde(default)]
        scoped_variables: Vec<i64>,
        /// Id of the new hierarchy.
        id: String,
        /// Name of the new hierarchy.
        name: String,
    },
    /// Replaces a container by its children.
    Ungroup {
        /// Path of the parent of the container.
        path: String,
        /// Id of the container to remove.
        state: String,
        /// Ids, used in order, for children whose own id is taken.
        #[serde(default)]
        fresh: Vec<String>,
    },
    /// Replaces a state by another one.
    SubstituteState {
        /// Path of the container.
        path: String,
        /// Id of the state to replace.
        state: String,
        /// The new state, then its descendants. The path of the first is its id.
        states: Vec<StateDocument>,
    },
    /// Moves states and the connections between them to another container.
    MoveStates {
        /// Path of the container that the states leave.
        path: String,
        /// Ids of the states to move.
        states: Vec<String>,
        /// Path of the target container.
        to: String,
        /// New ids, in the order of `states`. States without a new id keep theirs.
        #[serde(default)]
        ids: Vec<String>,
    },
    /// Adds copies of states to a container.
    Paste {
        /// Path of the container.
        path: String,
        /// The copied states and their connections.
        selection: Selection,
        /// New ids, in the order of the copied states. States without a new id keep theirs.
        #[serde(default)]
        ids: Vec<String>,
    },
    /// Sets or removes the user's version of the machine.
    SetVersion {
        /// The new version. Empty to remove it.
        #[serde(default)]
        version: Option<String>,
    },
    /// Sets or removes the machine's own layout.
    SetMachineLayout {
        /// The new layout. Empty to remove it.
        #[serde(default)]
        layout: Option<LayoutDocument>,
    },
    /// Replaces the machine's header.
    SetHeader {
        /// The whole new header.
        header: HeaderDocument,
    },
    /// Applies several edits in order: all of them or none.
    Batch {
        /// The edits, in order.
        edits: Vec<Self>,
    },
}

/// The list of a state that contains a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum PortList {
    /// Inputs of the state.
    Input,
    /// Outputs of the state.
    Output,
    /// Variables that the children of a container share.
    ScopedVariable,
}

/// An outcome of a child.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OutcomeOf {
    /// Id of the child.
    pub state: String,
    /// Id of the outcome.
    pub outcome: i64,
}

/// Target of a transition: `{"state": id}` for a child, or `{"outcome": id}` of the container.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    /// The income of a child.
    State(String),
    /// An outcome of the container.
    Outcome(i64),
}

/// A port of a child or of the container itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PortOf {
    /// Id of the child or container.
    pub state: String,
    /// Id of the port.
    pub port: i64,
}

/// An element of a state's layout with its own position: `"state"`, `"name"`, `"income"`, `{"outcome": id}` and so on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Element {
    /// The state itself, inside its parent.
    State,
    /// The box with the state's name, inside the state.
    Name,
    /// The income, on the state's border.
    Income,
    /// An outcome, on the state's border.
    Outcome(i64),
    /// An input, on the state's border.
    Input(i64),
    /// An output, on the state's border.
    Output(i64),
    /// A scoped variable, inside the state.
    ScopedVariable(i64),
    /// A transition, inside the state.
    Transition(i64),
    /// A data flow, inside the state.
    DataFlow(i64),
}
