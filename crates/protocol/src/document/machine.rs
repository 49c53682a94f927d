//! The shapes of a document. What is empty is left out.

use super::LayoutDocument;
use serde::{Deserialize, Serialize};

/// A machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Document {
    /// The machine as a whole.
    pub header: HeaderDocument,
    /// All states but those inside libraries, a state before its children, children by rising id.
    pub states: Vec<StateDocument>,
}

/// What is said of a machine as a whole.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct HeaderDocument {
    /// UTC, `YYYY-MM-DD hh:mm:ss`.
    #[serde(default)]
    pub creation_time: String,
    /// The user's version of the machine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// The program that wrote it last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub used_rafcon_version: Option<String>,
    /// Layout of the machine as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<LayoutDocument>,
    /// Keys of the file that no one knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// One state, without what stands inside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StateDocument {
    /// Its key: the ids from the root to this state, joined by `/`.
    pub path: String,
    /// Its id, only where a faulty one (empty, or with a `/`) cannot be told from the path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// For people.
    pub name: String,
    /// What kind of state it is.
    pub kind: StateKind,
    /// For people; Markdown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The Python text of an execution state or decider.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub script: Option<String>,
    /// By rising id. In what is added to a machine none means aborted (-1) and preempted (-2).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outcomes: Vec<OutcomeDocument>,
    /// By rising id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<PortDocument>,
    /// By rising id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outputs: Vec<PortDocument>,
    /// Of a container, by rising id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scoped_variables: Vec<PortDocument>,
    /// Notes of the user.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub semantic_data: Option<serde_json::Value>,
    /// Where it and its parts stand on the screen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<LayoutDocument>,
    /// Of a library state: which library, and what is set for its ports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub library: Option<LibraryDocument>,
    /// Of a container, by rising id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub transitions: Vec<TransitionDocument>,
    /// Of a container, by rising id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub data_flows: Vec<DataFlowDocument>,
    /// Keys of the file that no one knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// What kind of state it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum StateKind {
    /// Runs a script.
    Execution,
    /// Runs a script that decides how its barrier ends.
    Decider,
    /// Runs its children one after the other.
    Hierarchy,
    /// Runs its children at the same time, waits for all, then runs the decider.
    Barrier,
    /// Runs its children at the same time until the first ends.
    Preemptive,
    /// Runs another state machine.
    Library,
}

/// One way in which a state can end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OutcomeDocument {
    /// Unique in the state; -1 is aborted, -2 preempted.
    pub id: i64,
    /// Unique in the state.
    pub name: String,
    /// Keys of the file that no one knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// An input, output or scoped variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PortDocument {
    /// Unique over inputs, outputs and scoped variables of the state.
    pub id: i64,
    /// Unique in its own list.
    pub name: String,
    /// A Python type: `int`, `numpy.ndarray`.
    pub data_type: String,
    /// `null` is `None`; a text for another type is read when a run starts.
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub default: serde_json::Value,
    /// Keys of the file that no one knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// What runs next after an outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TransitionDocument {
    /// Unique in the container.
    pub id: i64,
    /// Id of a child; none: from the income of the container.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_state: Option<String>,
    /// Its outcome.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_outcome: Option<i64>,
    /// Id of a child, or of the container itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_state: Option<String>,
    /// An outcome of the container; none if it leads to a child.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_outcome: Option<i64>,
    /// Keys of the file that no one knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// A value's way from one port to another. An end is a child, or the container itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct DataFlowDocument {
    /// Unique in the container.
    pub id: i64,
    /// Id of the state of the source.
    pub from_state: String,
    /// The port there.
    pub from_port: i64,
    /// Id of the state of the target.
    pub to_state: String,
    /// The port there.
    pub to_port: i64,
    /// Keys of the file that no one knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// Which library a state runs. Its content is asked for on its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryDocument {
    /// A library root and the folders below it, joined by `/`.
    pub path: String,
    /// The folder of the library.
    pub name: String,
    /// The version that the state was made with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// What is set for input ports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<RuntimeValueDocument>,
    /// What is set for output ports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outputs: Vec<RuntimeValueDocument>,
    /// Why the library was not found; none if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// What a library state sets for a port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RuntimeValueDocument {
    /// The port's id.
    pub port: i64,
    /// The value.
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub value: serde_json::Value,
    /// Whether it is used instead of the library's default.
    pub used: bool,
}

/// States taken from a container, with what connects them: what *copy* gives and *paste* takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Selection {
    /// The id of the container.
    pub container: String,
    /// The states with everything inside them; paths begin at the copied states, which stand in the order of the selection.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub states: Vec<StateDocument>,
    /// Scoped variables of the container.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scoped_variables: Vec<PortDocument>,
    /// Transitions between the states.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub transitions: Vec<TransitionDocument>,
    /// Data flows between the states and variables.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub data_flows: Vec<DataFlowDocument>,
}
