//! The active states of a run at one moment, with all their data, under names that outlive the run. A run is resumed
//! from it after a crash, or started again from an entry of its history.

use rafcon_model::{OutcomeId, PortId, StateId};

/// One active state and everything in it. Orders are numbers that rise with time: of two values for one target, the one
/// with the higher order is newer.
#[derive(Debug, Clone, PartialEq)]
pub struct ActiveStateData<D> {
    /// Id of the state among the children of its parent; the root's own id at the top.
    pub state: StateId,
    /// Input values. Ports that are missing here get their defaults.
    pub inputs: Vec<(PortId, D)>,
    /// Order of the entry.
    pub order: u64,
    /// The error that the state received, unless it has passed it on.
    pub error: Option<D>,
    /// True if the state was asked to end. `None` if that is not recorded: it then follows from the orders of entries,
    /// of the end that decided a race, and of the request to stop.
    pub preempted: Option<bool>,
    /// The scoped variables of a container.
    pub scoped: Vec<ScopedValue<D>>,
    /// Ends of the children of a container, by rising order. If a child ended several times, its last end counts;
    /// earlier ones only supply outputs that later ones left out.
    pub ended: Vec<ChildEnd<D>>,
    /// The child of a container that ended last. It determines the next step, unless a child is active.
    pub last: Option<StateId>,
    /// Children that are active.
    pub children: Vec<Self>,
}

/// Value of a scoped variable of a container.
#[derive(Debug, Clone, PartialEq)]
pub struct ScopedValue<D> {
    /// Id of the scoped variable.
    pub port: PortId,
    /// The variable's last value.
    pub value: D,
    /// Order of the assignment.
    pub order: u64,
}

/// One end of a child of a container.
#[derive(Debug, Clone, PartialEq)]
pub struct ChildEnd<D> {
    /// Id of the child.
    pub state: StateId,
    /// Outcome by which it ended.
    pub outcome: OutcomeId,
    /// Output values, without those that the script left out.
    pub outputs: Vec<(PortId, D)>,
    /// Error with which the child ended, if any.
    pub error: Option<D>,
    /// Order of the end.
    pub order: u64,
}

/// Policy for scripts that a crash interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interrupted {
    /// Scripts wait ([`crate::WaitReason::Interrupted`]) until [`crate::Input::Recover`] or a forced outcome decides.
    Wait,
    /// Scripts end with *aborted*, and with the crash of the run as error.
    Abort,
    /// Scripts run again with their earlier inputs.
    Again,
}
