//! Runs an engine in real time: threads, the clock, the memory of what happened, the talk with a viewer.
//!
//! Knows how to drive an engine and whom to tell. Must never know HTTP, browsers or Python: scripts run behind the port
//! [`Scripts`].

mod active;
mod archive;
mod begun;
mod blocks;
mod branch;
mod clock;
mod commands;
mod committer;
mod connection;
mod core;
mod dispatch;
mod document;
mod driver;
mod due;
mod error;
mod files;
mod host;
mod inquiry;
mod journal;
mod keep;
mod last;
mod level;
mod limits;
mod listener;
mod mailbox;
mod names;
mod notes;
mod past;
mod place;
mod points;
mod prepare;
mod pulse;
mod questions;
mod record_encoder;
mod record_events;
mod recorder;
mod restore_values;
mod resume;
mod roots;
mod safety;
mod scripts;
pub mod signals;
mod snapshot;
mod stop;
mod tell;
#[cfg(test)]
mod tests;
mod timers;
mod viewer;
mod viewer_reader;
mod viewer_set;
mod worker_pool;

pub use clock::Clock;
pub use connection::{TalkError, descriptors};
pub use document::Edited;
pub use driver::Driver;
pub use error::{
    ChangeError, CommandError, LoadFailure, PrepareError, QuestionError, ResumeError, ValueError,
};
pub use files::StateFiles;
pub use host::{ServeError, serve};
pub use keep::{Keep, KeptValue};
pub use last::Last;
pub use past::PastEvent;
pub use place::{Place, Places};
pub use prepare::{faults, reason};
pub use questions::{Asked, Closed};
pub use scripts::{Built, Host, HostValue, Opening, Scripts};
pub use signals::Signals;
