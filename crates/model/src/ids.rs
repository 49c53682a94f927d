//! Names of things inside a machine: state ids, element ids, paths.

use smol_str::SmolStr;
use std::fmt;

/// The id of a barrier's decider, fixed by the file format.
pub const DECIDER_ID: &str = "unique_decider_state_id";

/// The id of a state: unique among its siblings and different from its parent's. Six upper-case letters when made here.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StateId(pub SmolStr);

impl StateId {
    /// An id with this text.
    pub fn new(text: impl AsRef<str>) -> Self {
        Self(SmolStr::new(text))
    }

    /// The text of the id.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Whether this is the decider of a barrier.
    pub fn is_decider(&self) -> bool {
        self.0 == DECIDER_ID
    }
}

impl From<&str> for StateId {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

impl fmt::Display for StateId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

macro_rules! number_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub i64);

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

number_id! {
    /// The id of an outcome of a state; 0 and up for the user's, -1 aborted, -2 preempted.
    OutcomeId
}
number_id! {
    /// The id of a data port or scoped variable: unique over inputs, outputs and scoped variables of its state.
    PortId
}
number_id! {
    /// The id of a transition in its container.
    TransitionId
}
number_id! {
    /// The id of a data flow in its container.
    DataFlowId
}

impl OutcomeId {
    /// Every state has this outcome: an error ended it.
    pub const ABORTED: Self = Self(-1);
    /// Every state has this outcome: it was asked to end.
    pub const PREEMPTED: Self = Self(-2);

    /// Whether this is one of the two outcomes that every state has.
    pub fn is_mandatory(self) -> bool {
        self == Self::ABORTED || self == Self::PREEMPTED
    }
}

/// Where a state stands: ids from the root down. Inside a library the library state's id is followed by the id of the
/// library's root state.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct StatePath(pub Vec<StateId>);

impl StatePath {
    /// The path of a root state.
    pub fn root(id: StateId) -> Self {
        Self(vec![id])
    }

    /// This path and one id more.
    #[must_use]
    pub fn child(&self, id: StateId) -> Self {
        let mut ids = Vec::with_capacity(self.0.len() + 1);
        ids.extend_from_slice(&self.0);
        ids.push(id);
        Self(ids)
    }

    /// The path without its last id; `None` for a root (or empty) path.
    pub fn parent(&self) -> Option<Self> {
        match self.0.len() {
            0 | 1 => None,
            n => Some(Self(self.0[..n - 1].to_vec())),
        }
    }

    /// The id of the state itself.
    pub fn last(&self) -> Option<&StateId> {
        self.0.last()
    }

    /// Reads `A/B/C`. Empty parts are dropped.
    pub fn parse(text: &str) -> Self {
        Self(text.split('/').filter(|part| !part.is_empty()).map(StateId::new).collect())
    }
}

impl fmt::Display for StatePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, id) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str("/")?;
            }
            f.write_str(id.as_str())?;
        }
        Ok(())
    }
}
