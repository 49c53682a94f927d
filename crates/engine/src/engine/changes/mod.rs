//! The program changes while it runs.

pub(super) mod change;
pub(super) mod fitting;
pub(super) mod migrate;
pub(super) mod undo_log_change;
