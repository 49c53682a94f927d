//! What commands do: hold, resume, breakpoints, forced outcomes.

pub(super) mod checks;
pub(super) mod control;
pub(super) mod force;
pub(super) mod resume;
pub(super) mod suspend;
