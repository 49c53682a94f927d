//! What is different in a machine now: the smallest parts of a document that say it.

use super::of::walk;
use super::{DataFlowDocument, HeaderDocument, StateDocument, TransitionDocument};
use rafcon_model::{Container, Difference, Machine, State, StatePath, diff};
use serde::{Deserialize, Serialize};

/// One part of a document that is different now. All changes of a revision count together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "change", rename_all = "snake_case")]
pub enum Change {
    /// A state is there now, or is another one. It comes without its connections, which stay as they are.
    State {
        /// The state.
        state: Box<StateDocument>,
    },
    /// A state is gone, with everything inside it.
    StateRemoved {
        /// Its path.
        path: String,
    },
    /// A transition is there now, is another one, or is gone.
    Transition {
        /// The path of the container.
        path: String,
        /// Its id.
        id: i64,
        /// The transition; none if it is gone.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        transition: Option<TransitionDocument>,
    },
    /// A data flow is there now, is another one, or is gone.
    DataFlow {
        /// The path of the container.
        path: String,
        /// Its id.
        id: i64,
        /// The data flow; none if it is gone.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        data_flow: Option<DataFlowDocument>,
    },
    /// The machine as a whole is another one.
    Header {
        /// The header.
        header: HeaderDocument,
    },
}

/// What leads from one machine's document to another's. What both machines share is not looked at.
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
