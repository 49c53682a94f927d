//! Backwards: the undo log is followed step by step.

pub(super) mod reverse;
pub(super) mod reverse_enter;
pub(super) mod reverse_leave;
