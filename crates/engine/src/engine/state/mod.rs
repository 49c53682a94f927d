//! What a run is at a moment: active states, suspended branches, and the undo log of the way here.

pub(super) mod branches;
pub(super) mod breakpoints;
pub(super) mod frames;
pub(super) mod phase;
pub(super) mod places;
pub(super) mod refusal;
pub(super) mod snapshot;
pub(super) mod step;
pub(super) mod suspended;
pub(super) mod undo_log;
