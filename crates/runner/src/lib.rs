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
mod company;
mod connection;
mod core;
mod crew;
mod document;
mod driver;
mod due;
mod files;
mod hearing;
mod host;
mod inquiry;
mod join;
mod journal;
mod keep;
mod last;
mod level;
mod limits;
mod mailbox;
mod names;
mod notes;
mod obey;
mod past;
mod pen;
mod place;
mod points;
mod prepare;
mod pulse;
mod questions;
mod recorder;
mod resume;
mod revive;
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
mod words;
mod written;

pub use clock::Clock;
pub use connection::{TalkError, descriptors};
pub use document::Edited;
pub use driver::Driver;
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
