//! Runs an engine in real time: threads, the clock, the memory of what happened, the talk with a viewer.
//!
//! Knows how to drive an engine and whom to tell. Must never know HTTP, browsers or Python: scripts run behind the port
//! [`Scripts`].

mod active;
mod branch;
mod clock;
mod commands;
mod connection;
mod core;
mod crew;
mod document;
mod driver;
mod files;
mod host;
mod inquiry;
mod keep;
mod mailbox;
mod place;
mod prepare;
mod recorder;
mod scripts;
pub mod signals;
mod snapshot;
mod stop;
mod tell;
#[cfg(test)]
mod tests;
mod viewer;

pub use clock::Clock;
pub use connection::TalkError;
pub use driver::Driver;
pub use files::StateFiles;
pub use host::{ServeError, serve};
pub use keep::{Keep, KeptValue};
pub use place::{Place, Places};
pub use scripts::{Host, HostValue, Opening, Scripts};
pub use signals::Signals;
