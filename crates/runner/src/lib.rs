//! Runs an engine in real time: threads, the clock, the memory of what happened, the talk with a viewer.
//!
//! Knows how to drive an engine and whom to tell. Must never know HTTP, browsers or Python: scripts run behind the port
//! [`Scripts`].

mod drive;
mod life;
mod places;
mod record;
#[cfg(test)]
mod tests;
mod viewers;

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
