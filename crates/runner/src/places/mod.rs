//! Where a state of a run stands: its signals, mail and time limits, and what it did last. Must never know what drives it.

pub(crate) mod active;
pub(crate) mod clock;
pub(crate) mod files;
pub(crate) mod last;
pub(crate) mod level;
pub(crate) mod limits;
pub(crate) mod mailbox;
pub(crate) mod place;
pub mod signals;
pub(crate) mod timers;
