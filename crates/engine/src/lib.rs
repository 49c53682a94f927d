//! The next steps of a state machine's run, as a pure function of its history.
//!
//! The engine knows the active configuration, data scopes, preemption and the ends of states. It knows no threads,
//! clocks, Python or I/O: it accepts [`Input`]s and returns [`Effect`]s and [`Event`]s in an [`Outbox`].
#![warn(clippy::wildcard_enum_match_arm)]
pub mod configuration;
pub mod effect;
pub mod engine;
pub mod event;
pub mod ids;
pub mod input;
pub mod program;
mod values;

pub use configuration::{ActiveStateData, ChildEnd, Interrupted, ScopedValue};
pub use effect::{Check, Effect, Finish, Job, Outbox, Verdict, Verdicts};
pub use engine::{
    ActiveState, Activity, ChangeEffect, Command, Engine, Hold, Inspection, Refusal, Status,
};
pub use event::{Event, HeldBy, Level, Note, WaitReason};
pub use ids::{BranchId, FrameId, NodeId, PathId};
pub use input::{
    BegunAt, Breakpoint, Change, Counted, Input, Restore, Returned, Scope, ScriptResult, Silence,
    Start, Stopping, Stride, Then, Unattended, When,
};
pub use program::{Node, Program, UnknownPath};
pub use values::{Datum, Globals, Literals, ModelLiterals, NoGlobals, failed};

#[cfg(test)]
mod tests;
