//! Edits as clients send them: one JSON object each, told apart by its `edit` (`docs/edits.md`, on the wire).
//! Knows what the model's edits look like on the wire, but not what they do.
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

/// A change of a machine. `path` is that of the state that has the changed part: for transitions, data flows and children
/// that of the container.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[cfg_attr(feature = "schema", schema(no_recursion))]
#[serde(tag = "edit", rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// Gives a state another name.
    SetName {
        /// The state.
        path: String,
        /// Its name from now on.
        name: String,
    },
    /// Gives a state another id; its connections follow.
    SetId {
        /// The state.
        path: String,
        /// Its id from now on.
        id: String,
    },
    /// Sets or removes the description.
    SetDescription {
        /// The state.
        path: String,
        /// Markdown; none removes it.
        #[serde(default)]
        description: Option<String>,
    },
    /// Sets or removes the user's notes.
    SetSemanticData {
        /// The state.
        path: String,
        /// An object; none removes them.
        #[serde(default)]
        semantic_data: Option<serde_json::Value>,
    },
    /// Sets or removes the script of an execution state or decider.
    SetScript {
        /// The state.
        path: String,
        /// Python; none removes it.
        #[serde(default)]
        script: Option<String>,
    },
    /// Makes it a state of another kind.
    SetKind {
        /// The state.
        path: String,
        /// The kind: execution, hierarchy, barrier or preemptive.
        kind: StateKind,
    },
    /// Adds an outcome.
    AddOutcome {
        /// The state.
        path: String,
        /// Its id, which nothing else has.
        outcome: i64,
        /// Its name.
        name: String,
    },
    /// Gives an outcome another name.
    RenameOutcome {
        /// The state.
        path: String,
        /// Its id.
        outcome: i64,
        /// Its name from now on.
        name: String,
    },
    /// Removes an outcome with its transitions.
    RemoveOutcome {
        /// The state.
        path: String,
        /// Its id.
        outcome: i64,
    },
    /// Adds a port or scoped variable.
    AddPort {
        /// The state.
        path: String,
        /// In which list.
        list: PortList,
        /// Its id, which no other port or scoped variable of the state has.
        port: i64,
        /// Its name.
        name: String,
        /// Its type: `int`, `numpy.ndarray`.
        data_type: String,
        /// Its default.
        #[serde(default)]
        default: serde_json::Value,
    },
    /// Gives a port or scoped variable another name.
    RenamePort {
        /// The state.
        path: String,
        /// In which list.
        list: PortList,
        /// Its id.
        port: i64,
        /// Its name from now on.
        name: String,
    },
    /// Gives a port or scoped variable another type.
    SetPortType {
        /// The state.
        path: String,
        /// In which list.
        list: PortList,
        /// Its id.
        port: i64,
        /// Its type from now on.
        data_type: String,
    },
    /// Gives a port or scoped variable another default.
    SetPortDefault {
        /// The state.
        path: String,
        /// In which list.
        list: PortList,
        /// Its id.
        port: i64,
        /// Its default from now on.
        #[serde(default)]
        default: serde_json::Value,
    },
    /// Removes a port or scoped variable with its data flows.
    RemovePort {
        /// The state.
        path: String,
        /// In which list.
        list: PortList,
        /// Its id.
        port: i64,
    },
    /// Adds a transition.
    AddTransition {
        /// The container.
        path: String,
        /// Its id, which no other transition there has.
        transition: i64,
        /// Where it begins; none: at the income of the container.
        #[serde(default)]
        from: Option<OutcomeOf>,
        /// Where it leads.
        to: Goal,
    },
    /// Lets a transition begin elsewhere.
    SetTransitionOrigin {
        /// The container.
        path: String,
        /// Its id.
        transition: i64,
        /// Where it begins; none: at the income of the container.
        #[serde(default)]
        from: Option<OutcomeOf>,
    },
    /// Lets a transition lead elsewhere.
    SetTransitionTarget {
        /// The container.
        path: String,
        /// Its id.
        transition: i64,
        /// Where it leads.
        to: Goal,
    },
    /// Removes a transition.
    RemoveTransition {
        /// The container.
        path: String,
        /// Its id.
        transition: i64,
    },
    /// Adds a data flow.
    AddDataFlow {
        /// The container.
        path: String,
        /// Its id, which no other data flow there has.
        data_flow: i64,
        /// Where it begins.
        from: PortOf,
        /// Where it ends.
        to: PortOf,
    },
    /// Lets a data flow begin elsewhere.
    SetDataFlowSource {
        /// The container.
        path: String,
        /// Its id.
        data_flow: i64,
        /// Where it begins.
        from: PortOf,
    },
    /// Lets a data flow end elsewhere.
    SetDataFlowTarget {
        /// The container.
        path: String,
        /// Its id.
        data_flow: i64,
        /// Where it ends.
        to: PortOf,
    },
    /// Removes a data flow.
    RemoveDataFlow {
        /// The container.
        path: String,
        /// Its id.
        data_flow: i64,
    },
    /// Sets a value for a port of a library state, and uses it.
    SetRuntimeValue {
        /// The library state.
        path: String,
        /// In which list the port is.
        list: PortList,
        /// The port's id.
        port: i64,
        /// The value.
        #[serde(default)]
        value: serde_json::Value,
    },
    /// Uses the value that is set for a port of a library state, or the default of the library.
    UseRuntimeValue {
        /// The library state.
        path: String,
        /// In which list the port is.
        list: PortList,
        /// The port's id.
        port: i64,
        /// Whether the value is used.
        used: bool,
    },
    /// Removes the value for a port of a library state.
    RemoveRuntimeValue {
        /// The library state.
        path: String,
        /// In which list the port is.
        list: PortList,
        /// The port's id.
        port: i64,
    },
    /// Moves something on the screen.
    SetPosition {
        /// The state whose layout it stands in.
        path: String,
        /// What moves.
        element: Element,
        /// x and y (downwards), in the coordinates of the file.
        position: [f64; 2],
    },
    /// Sets the size of a state or its name.
    SetSize {
        /// The state.
        path: String,
        /// What is resized.
        element: Element,
        /// Width and height.
        size: [f64; 2],
    },
    /// Sets the points between the ends of a transition or data flow.
    SetWaypoints {
        /// The container.
        path: String,
        /// The transition or data flow.
        element: Element,
        /// x and y of each.
        waypoints: Vec<[f64; 2]>,
    },
    /// Sets the whole layout of a state.
    SetLayout {
        /// The state.
        path: String,
        /// The layout; none removes it.
        #[serde(default)]
        layout: Option<LayoutDocument>,
    },
    /// Adds a state with everything inside it.
    AddState {
        /// The container.
        path: String,
        /// The state, then what stands inside it; the path of the first is its id.
        states: Vec<StateDocument>,
    },
    /// Removes a state with its connections and everything inside it.
    RemoveState {
        /// The container.
        path: String,
        /// The state's id.
        state: String,
    },
    /// Sets or removes where a hierarchy starts.
    SetStart {
        /// The hierarchy.
        path: String,
        /// Where; none removes the start.
        #[serde(default)]
        to: Option<Goal>,
    },
    /// Puts states and scoped variables into a new hierarchy.
    Group {
        /// The container.
        path: String,
        /// Ids of the states.
        states: Vec<String>,
        /// Ids of scoped variables that go with them.
        #[serde(default)]
        scoped_variables: Vec<i64>,
        /// The id of the new hierarchy.
        id: String,
        /// Its name.
        name: String,
    },
    /// Puts the children of a container in its place.
    Ungroup {
        /// The container around it.
        path: String,
        /// Its id.
        state: String,
        /// Ids for children whose own id is taken, used in turn.
        #[serde(default)]
        fresh: Vec<String>,
    },
    /// Puts a state in the place of another.
    SubstituteState {
        /// The container.
        path: String,
        /// The id of the state that goes.
        state: String,
        /// The state that comes, then what stands inside it; the path of the first is its id.
        states: Vec<StateDocument>,
    },
    /// Moves states to another container, with the connections between them.
    MoveStates {
        /// The container.
        path: String,
        /// Ids of the states.
        states: Vec<String>,
        /// The path of the other container.
        to: String,
        /// New ids, in the order of the states; those without one keep theirs.
        #[serde(default)]
        ids: Vec<String>,
    },
    /// Adds copies of states.
    Paste {
        /// The container.
        path: String,
        /// What was copied.
        selection: Selection,
        /// New ids, in the order of the copied states; those without one keep theirs.
        #[serde(default)]
        ids: Vec<String>,
    },
    /// Sets or removes the user's version of the machine.
    SetVersion {
        /// The version; none removes it.
        #[serde(default)]
        version: Option<String>,
    },
    /// Sets the layout of the machine as a whole.
    SetMachineLayout {
        /// The layout; none removes it.
        #[serde(default)]
        layout: Option<LayoutDocument>,
    },
    /// Sets everything that is said of the machine as a whole.
    SetHeader {
        /// All of it.
        header: HeaderDocument,
    },
    /// Several edits, one after the other; all or none.
    Batch {
        /// The edits.
        edits: Vec<Self>,
    },
}

/// In which list of a state a port stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum PortList {
    /// What the state takes.
    Input,
    /// What the state gives.
    Output,
    /// What the children of a container share.
    ScopedVariable,
}

/// An outcome of a child.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OutcomeOf {
    /// The child's id.
    pub state: String,
    /// The outcome's id.
    pub outcome: i64,
}

/// Where a transition leads: `{"state": id}` of a child, or `{"outcome": id}` of the container.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    /// The income of a child.
    State(String),
    /// An outcome of the container.
    Outcome(i64),
}

/// A port of a child, or of the container itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PortOf {
    /// The state's id.
    pub state: String,
    /// The port's id.
    pub port: i64,
}

/// Something with a place of its own in the layout of a state: `"state"`, `"name"`, `"income"`, or `{"outcome": id}` and the
/// like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Element {
    /// The state itself, in its parent.
    State,
    /// The box with its name, inside the state.
    Name,
    /// Where it is entered, on its border.
    Income,
    /// An outcome, on its border.
    Outcome(i64),
    /// An input, on its border.
    Input(i64),
    /// An output, on its border.
    Output(i64),
    /// A scoped variable, inside it.
    ScopedVariable(i64),
    /// A transition inside it.
    Transition(i64),
    /// A data flow inside it.
    DataFlow(i64),
}
