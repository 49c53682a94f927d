//! Forwards: states are entered and left, data passes on, branches begin and end.

pub(super) mod again;
pub(super) mod barrier;
pub(super) mod branch;
pub(super) mod data;
pub(super) mod enter;
pub(super) mod hierarchy;
pub(super) mod leave;
pub(super) mod library;
pub(super) mod preempt;
pub(super) mod preemptive;
pub(super) mod start;
