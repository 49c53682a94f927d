//! What is active in a run at one moment, with all its data, by names that outlive the run: what a run is resumed from after a
//! crash, or started again from at an entry of its history.

use rafcon_model::{OutcomeId, PortId, StateId};

/// One active state and what is in it. Orders are numbers that rise with time: of two values for one target, the one with
/// the higher order is the newer.
#[derive(Debug, Clone, PartialEq)]
pub struct ActiveStateData<D> {
    /// Which child of the state around it; the root's own id at the top.
    pub state: StateId,
    /// Its inputs. Ports that are missing here get their defaults.
    pub inputs: Vec<(PortId, D)>,
    /// When it was entered.
    pub order: u64,
    /// The error that it was given, if it has not handed it on.
    pub error: Option<D>,
    /// Whether it was asked to end. `None` if that is not recorded: then it follows from the orders of entries, of the end
    /// that decided a race, and of the request to stop.
    pub preempted: Option<bool>,
    /// The scoped variables of a container.
    pub scoped: Vec<ScopedValue<D>>,
    /// How children of a container ended, by rising order. Of several ends of one child the last counts; earlier ones are
    /// there only for outputs that later ones left out.
    pub ended: Vec<ChildEnd<D>>,
    /// The child of a container that ended last: it says what is next, unless a child is active.
    pub last: Option<StateId>,
    /// The children that are active.
    pub children: Vec<Self>,
}

/// A scoped variable.
#[derive(Debug, Clone, PartialEq)]
pub struct ScopedValue<D> {
    /// Which.
    pub port: PortId,
    /// Its value.
    pub value: D,
    /// When it got it.
    pub order: u64,
}

/// How a child ended.
#[derive(Debug, Clone, PartialEq)]
pub struct ChildEnd<D> {
    /// The child.
    pub state: StateId,
    /// Its outcome.
    pub outcome: OutcomeId,
    /// Its outputs, without those that its script left out.
    pub outputs: Vec<(PortId, D)>,
    /// Its error, if it left one.
    pub error: Option<D>,
    /// When it ended.
    pub order: u64,
}

/// What becomes of the scripts that were running.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interrupted {
    /// They wait ([`crate::WaitReason::Interrupted`]) until [`crate::Input::Recover`] or a forced outcome decides.
    Wait,
    /// They end with *aborted*, and this run's crash as error.
    Abort,
    /// They run again, with the inputs that they had.
    Again,
}
