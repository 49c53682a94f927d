//! Runs an engine in real time: threads, the clock, the record of events, and the connections to viewers.
//!
//! The runner drives an engine and sends its events to viewers. It knows no HTTP, browsers or Python: scripts run
//! behind the port [`Scripts`].

/// The engine with its lock, threads and scripts: its inputs, its effects, and the record of both.
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
    pub(crate) mod notes;
    pub(crate) mod past;
    pub(crate) mod points;
    pub(crate) mod prepare;
    pub(crate) mod pulse;
    pub(crate) mod queries;
    pub(crate) mod questions;
    pub(crate) mod record_events;
    pub(crate) mod roots;
    pub(crate) mod scripts;
    pub(crate) mod snapshot;
    pub(crate) mod worker_pool;
}
/// A run from its launch to its end, and its resumption after a crash.
mod life {
    pub(crate) mod begun;
    pub(crate) mod committer;
    pub(crate) mod end_values;
    pub(crate) mod host;
    pub(crate) mod journal;
    pub(crate) mod restore_values;
    pub(crate) mod resume;
}
/// The place of a state in a run: its signals, mailboxes, time limits and last data. It does not know the driver.
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
/// The events of a run as bytes: in the journal and in memory, and which of them are safe. It knows no viewers.
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
/// The viewers connected to a run: each receives the events that it requests, and may send commands. It does not know
/// how a run begins or ends.
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
