//! The runner as a process: which Python, which extension, how it is started, spoken with and ended.
//!
//! Must never know what a run means; that is the supervisor's part.

pub(crate) mod extension;
pub(crate) mod interpreter;
pub(crate) mod process;
pub(crate) mod socket;
pub(crate) mod wires;

pub(crate) use process::{Process, Start};
pub(crate) use wires::{Cause, Exit};
