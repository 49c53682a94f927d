//! Runs an engine in real time: threads, the clock, the memory of what happened, the talk with a viewer.
//!
//! Knows how to drive an engine and whom to tell. Knows nothing of HTTP, browsers or Python: scripts run behind the port
//! [`Scripts`].

/// The engine with its lock, threads and scripts: what goes in, what comes out, and what is written down of it.
mod drive {
    pub(crate) mod branch;
    pub(crate) mod carry_out;
    pub(crate) mod core;
    pub(crate) mod dispatch;
    pub(crate) mod document;
    pub(crate) mod driver;
    pub(crate) mod due;
    pub(crate) mod ending;
    pub(crate) mod error;
    pub(crate) mod ground;
    pub(crate) mod inquiry;
    pub(crate) mod notes;
    pub(crate) mod past;
    pub(crate) mod points;
    pub(crate) mod prepare;
    pub(crate) mod pulse;
    pub(crate) mod questions;
    pub(crate) mod record_events;
    pub(crate) mod roots;
    pub(crate) mod scripts;
    pub(crate) mod snapshot;
    pub(crate) mod worker_pool;
}
/// A run from its launch to its end, and again after a crash.
mod life {
    pub(crate) mod begun;
    pub(crate) mod committer;
    pub(crate) mod end_values;
    pub(crate) mod host;
    pub(crate) mod journal;
    pub(crate) mod restore_values;
    pub(crate) mod resume;
}
/// Where a state of a run stands: its signals, mail and time limits, and what it did last. Does not know what drives it.
mod places {
    pub(crate) mod active;
    pub(crate) mod clock;
    pub(crate) mod files;
    pub(crate) mod last;
    pub(crate) mod limits;
    pub(crate) mod mailbox;
    pub(crate) mod place;
    pub mod signals;
    pub(crate) mod timers;
}
/// What happened in a run, as bytes: in the journal, in memory, and what of it is safe. Knows nothing of threads or viewers.
mod record {
    pub(crate) mod blocks;
    pub(crate) mod keep;
    pub(crate) mod names;
    pub(crate) mod record_encoder;
    pub(crate) mod recorder;
    pub(crate) mod run_record;
    pub(crate) mod safety;
    pub(crate) mod tell;
}
#[cfg(test)]
mod tests;
/// Who is connected to a run: each is sent what it wants, and may command. Does not know how a run begins or ends.
mod viewers {
    pub(crate) mod commands;
    pub(crate) mod connection;
    pub(crate) mod listener;
    pub(crate) mod viewer;
    pub(crate) mod viewer_set;
}

pub use drive::document::Edited;
pub use drive::driver::Driver;
pub use drive::error::{
    ChangeError, CommandError, LoadFailure, PrepareError, QuestionError, ResumeError, ValueError,
};
pub use drive::past::PastEvent;
pub use drive::prepare::faults;
pub use drive::questions::{Asked, Closed};
pub use drive::scripts::{Built, Host, HostValue, Opening, Scripts};
pub use life::host::{ServeError, serve};
pub use places::clock::Clock;
pub use places::files::StateFiles;
pub use places::last::Last;
pub use places::place::{Place, Places};
pub use places::signals::{self, Signals};
pub use record::keep::{Keep, KeptValue};
pub use record::tell::reason;
pub use viewers::connection::{TalkError, descriptors};
