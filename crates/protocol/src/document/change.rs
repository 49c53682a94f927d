//! Differences between two machines, as the smallest parts of a document that express them.

use super::of::walk;
use super::{DataFlowDocument, HeaderDocument, StateDocument, TransitionDocument};
use rafcon_model::{Container, Difference, Machine, State, StatePath, diff};
use serde::{Deserialize, Serialize};

/// A changed part of a document. All changes of a revision apply together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "change", rename_all = "snake_case")]
pub enum Change {
    /// A state was added or changed. Its connections are not included and stay unchanged.
    State {
        /// The state with its new data.
        state: Box<StateDocument>,
    },
    /// A state was removed with its descendants.
    StateRemoved {
        /// Path of the state.
        path: String,
    },
    /// A transition was added, changed or removed.
    Transition {
        /// Path of the container.
        path: String,
        /// Id of the transition.
        id: i64,
        /// The new transition. Empty if it was removed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        transition: Option<TransitionDocument>,
    },
    /// A data flow was added, changed or removed.
    DataFlow {
        /// Path of the container.
        path: String,
        /// Id of the data flow.
        id: i64,
        /// The new data flow. Empty if it was removed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        data_flow: Option<DataFlowDocument>,
    },
    /// The machine's header was changed.
    Header {
        /// The whole new header.
        header: HeaderDocument,
    },
}

/// Returns the changes from one machine's document to another's. Parts that both machines share are skipped.
pub fn changes(old: &Machine, new: &Machine) -> Vec<Change> {
    let mut found = Vec::new();
    if old.header != new.header {
        found.push(Change::Header { header: HeaderDocument::of(&new.header) });
    }
    for difference in diff(old, new) {
        match difference {
            Difference::Removed(path) => {
                found.push(Change::StateRemoved { path: path.to_string() });
            }
            Difference::Added(path) => {
                if let Some(state) = new.state(&path) {
                    added(&path, state, &mut found);
                }
            }
            Difference::Changed(path, _) => {
                if let (Some(old), Some(new)) = (old.state(&path), new.state(&path)) {
                    changed(&path.to_string(), old, new, &mut found);
                }
            }
        }
    }
    found
}

fn added(path: &StatePath, state: &State, found: &mut Vec<Change>) {
    let parent = path.parent().map(|parent| parent.to_string());
    walk(state, parent.as_deref(), |path, state| {
        found.push(Change::State { state: Box::new(StateDocument::alone(&path, state)) });
        connections(&path, None, state.container(), found);
    });
}

fn changed(path: &str, old: &State, new: &State, found: &mut Vec<Change>) {
    let state = StateDocument::alone(path, new);
    if StateDocument::alone(path, old) != state {
        found.push(Change::State { state: Box::new(state) });
    }
    connections(path, old.container(), new.container(), found);
}

fn connections(
    path: &str,
    old: Option<&Container>,
    new: Option<&Container>,
    found: &mut Vec<Change>,
) {
    let none = Container::default();
    let (old, new) = (old.unwrap_or(&none), new.unwrap_or(&none));
    for id in old.transitions.differing(&new.transitions) {
        let transition = new.transitions.get(id).map(TransitionDocument::of);
        found.push(Change::Transition { path: path.to_owned(), id: id.0, transition });
    }
    for id in old.data_flows.differing(&new.data_flows) {
        let data_flow = new.data_flows.get(id).map(DataFlowDocument::of);
        found.push(Change::DataFlow { path: path.to_owned(), id: id.0, data_flow });
    }
}
