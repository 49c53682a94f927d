//! What happens next in a run of a state machine, as a pure function of what happened so far.
//!
//! Knows the active configuration, data scopes, preemption and the ends of states. Must never know threads, clocks,
//! Python or I/O: it takes [`Input`]s and returns [`Effect`]s and [`Event`]s in an [`Outbox`].

pub mod datum;
pub mod effect;
pub mod event;
pub mod ids;
pub mod input;

pub use datum::{Datum, Globals, Literals, NoGlobals};
pub use effect::{Effect, Finish, Job, Outbox, Verdict, Verdicts};
pub use event::{Event, Level, Note, WaitReason};
pub use ids::{BranchId, FrameId, NodeId, PathId};
pub use input::{Input, Returned, ScriptResult, Start};
