//! Data types of a document. Empty fields are omitted.

use super::LayoutDocument;
use serde::{Deserialize, Serialize};

/// A machine as a document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Document {
    /// Data of the machine as a whole.
    pub header: HeaderDocument,
    /// All states outside libraries, each after its parent, siblings sorted by id.
    pub states: Vec<StateDocument>,
}

/// Data of a machine as a whole.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct HeaderDocument {
    /// Creation time in UTC, `YYYY-MM-DD hh:mm:ss`.
    #[serde(default)]
    pub creation_time: String,
    /// The user's version of the machine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Version of the program that last wrote the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub used_rafcon_version: Option<String>,
    /// Layout of the machine as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<LayoutDocument>,
    /// Unknown keys of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// One state, without its descendants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct StateDocument {
    /// Key of the state: the ids from the root to the state, joined by `/`.
    pub path: String,
    /// Id of the state, only if it is invalid (empty, or with a `/`) and so cannot be derived from the path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// Name for people, not necessarily unique.
    pub name: String,
    /// Kind of state, which determines the fields that apply.
    pub kind: StateKind,
    /// Description in Markdown, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Python script of an execution state or decider.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub script: Option<String>,
    /// Outcomes sorted by id. For a state that is added to a machine, an empty list means aborted (-1) and preempted (-2).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outcomes: Vec<OutcomeDocument>,
    /// Input ports sorted by id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<PortDocument>,
    /// Output ports sorted by id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outputs: Vec<PortDocument>,
    /// Scoped variables of a container, sorted by id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scoped_variables: Vec<PortDocument>,
    /// Notes of the user.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub semantic_data: Option<serde_json::Value>,
    /// Layout of the state and its parts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<LayoutDocument>,
    /// Library of a library state, and the values set for its ports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub library: Option<LibraryDocument>,
    /// Transitions of a container, sorted by id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub transitions: Vec<TransitionDocument>,
    /// Data flows of a container, sorted by id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub data_flows: Vec<DataFlowDocument>,
    /// Unknown keys of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// Kind of state, which determines what the state runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum StateKind {
    /// Runs a Python script.
    Execution,
    /// Runs a script that determines the outcome of its barrier.
    Decider,
    /// Runs its children one after the other.
    Hierarchy,
    /// Runs its children concurrently, waits for all, then runs the decider.
    Barrier,
    /// Runs its children concurrently until the first one ends.
    Preemptive,
    /// Runs another state machine.
    Library,
}

/// An outcome of a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct OutcomeDocument {
    /// Id, unique in the state. -1 is aborted, -2 is preempted.
    pub id: i64,
    /// Name, unique in the state.
    pub name: String,
    /// Unknown keys of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// An input, output or scoped variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct PortDocument {
    /// Id, unique among inputs, outputs and scoped variables of the state.
    pub id: i64,
    /// Name, unique in its list.
    pub name: String,
    /// Python type, such as `int` or `numpy.ndarray`.
    pub data_type: String,
    /// Default value. `null` is `None`. Text for another type is evaluated when a run starts.
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub default: serde_json::Value,
    /// Unknown keys of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// A transition from an outcome to the next state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TransitionDocument {
    /// Id, unique in the container.
    pub id: i64,
    /// Id of the child it starts at. Empty for the income of the container.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_state: Option<String>,
    /// Outcome of that child.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_outcome: Option<i64>,
    /// Id of the target child, or of the container itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_state: Option<String>,
    /// Target outcome of the container. Empty if the target is a child.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_outcome: Option<i64>,
    /// Unknown keys of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// A data flow from one port to another. Each end belongs to a child or to the container itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct DataFlowDocument {
    /// Id, unique in the container.
    pub id: i64,
    /// Id of the source state.
    pub from_state: String,
    /// Id of the source port.
    pub from_port: i64,
    /// Id of the target state.
    pub to_state: String,
    /// Id of the target port.
    pub to_port: i64,
    /// Unknown keys of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extra: Option<serde_json::Value>,
}

/// Library that a state runs. Its content is requested separately.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LibraryDocument {
    /// Library root and the folders below it, joined by `/`.
    pub path: String,
    /// Name of the library's folder.
    pub name: String,
    /// Version of the library with which the state was created.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Values set for input ports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<RuntimeValueDocument>,
    /// Values set for output ports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outputs: Vec<RuntimeValueDocument>,
    /// Reason why the library was not found. Empty if it was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// Value that a library state sets for a port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct RuntimeValueDocument {
    /// Id of the port.
    pub port: i64,
    /// Value for the port. `null` or a missing value is `None`.
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub value: serde_json::Value,
    /// True to use the value instead of the library's default.
    pub used: bool,
}

/// States of a container and their connections: the result of *copy* and the argument of *paste*.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Selection {
    /// Id of the container.
    pub container: String,
    /// The states and their descendants. Paths begin at the copied states, which are in the order of the selection.
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
