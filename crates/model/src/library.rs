//! A state whose content is another state machine.

use crate::{PortId, State, Value};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The reference to a library and what this instance sets for it. Outcomes and ports of the library state are those of the
/// library's root; they stand in the surrounding [`State`].
#[derive(Debug, Clone, PartialEq)]
pub struct Library {
    /// Root name and folders below it, joined by `/`: `generic/dialog`.
    pub path: SmolStr,
    /// The folder of the library.
    pub name: SmolStr,
    /// The version that the instance was made with; `None` for "no version".
    pub version: Option<SmolStr>,
    /// Values of input ports.
    pub inputs: RuntimeValues,
    /// Values of output ports.
    pub outputs: RuntimeValues,
    /// What was found under `path` and `name`.
    pub content: LibraryContent,
}

/// Runtime values by port.
pub type RuntimeValues = BTreeMap<PortId, RuntimeValue>;

/// What a library instance sets for one port.
#[derive(Debug, Clone, PartialEq)]
pub struct RuntimeValue {
    /// As it stands in the file (like a port's default).
    pub value: Value,
    /// Whether it is used instead of the port's default.
    pub used: bool,
}

/// What stands behind a library state.
#[derive(Debug, Clone, PartialEq)]
pub enum LibraryContent {
    /// The library's root state, shared by all its instances.
    Found(Arc<State>),
    /// It was not found. The instance keeps its reference, runtime values, and the ports that its connections ask for.
    Missing {
        /// Why, in words for the user.
        reason: SmolStr,
    },
}
