//! A run from its launch to its end, and again after a crash.

pub(crate) mod begun;
pub(crate) mod committer;
pub(crate) mod host;
pub(crate) mod journal;
pub(crate) mod restore_values;
pub(crate) mod resume;
pub(crate) mod stop;
