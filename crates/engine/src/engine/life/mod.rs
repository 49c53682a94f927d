//! A run as others see it: exported, inspected, restored after a crash, and what must always be true of it.

pub(super) mod begun;
pub(super) mod export;
pub(super) mod inspect;
pub(super) mod invariants;
pub(super) mod recover;
pub(super) mod restore;
