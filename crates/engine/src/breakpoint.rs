//! Where a run holds by itself. The same words as in the protocol, without how they travel.

use rafcon_model::StatePath;
use smol_str::SmolStr;

/// A breakpoint of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Breakpoint {
    /// Chosen by whoever sets it; the same id replaces the earlier one.
    pub id: u64,
    /// The state. It need not exist (yet).
    pub path: StatePath,
    /// On which side of the state.
    pub when: When,
    /// Text that the driver evaluates ([`crate::Effect::Check`]); without one the breakpoint always holds.
    pub condition: Option<SmolStr>,
    /// Holds from the n-th time on that it is passed and its condition is true; 0 and 1 mean each time.
    pub hit_count: u32,
    /// What is held.
    pub scope: Scope,
    /// What happens while nobody is connected.
    pub unattended: Unattended,
    /// A disabled one does nothing.
    pub enabled: bool,
}

/// On which side of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum When {
    /// Before it is entered.
    Before,
    /// After it was left, before what follows.
    After,
}

/// What a breakpoint holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The branch that came to it.
    Branch,
    /// All branches, as a pause does.
    Run,
}

/// What a breakpoint does while nobody is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unattended {
    /// Holds all the same.
    Hold,
    /// Lets go on, also what it held when the last viewer was lost.
    Continue,
    /// Stops the run.
    Stop,
}
