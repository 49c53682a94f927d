//! Why an input was not taken.

use crate::FrameId;
use crate::program::UnknownPath;
use std::fmt;
use thiserror::Error;

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Not started.
    Idle,
    /// Running.
    Running,
    /// Hierarchies are held before their next child.
    Paused,
    /// Asked to stop; what is active unwinds.
    Stopping,
    /// Over.
    Finished,
}

/// A command without what it carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// [`crate::Input::Start`]
    Start,
    /// [`crate::Input::Pause`]
    Pause,
    /// [`crate::Input::Resume`]
    Resume,
    /// [`crate::Input::Stop`]
    Stop,
}

/// An input that changed nothing.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The command means nothing in this status.
    #[error("cannot {command}: the run {status}; {}", way_out(*status))]
    NotNow {
        /// What was asked for.
        command: Command,
        /// Where the run stands.
        status: Status,
    },
    /// This engine cannot do that yet.
    #[error("this engine does not know the command yet; it knows start, pause, resume and stop")]
    NotYet,
    /// The state to start from does not exist.
    #[error(transparent)]
    StartFrom(#[from] UnknownPath),
    /// The result of a script belongs to no script that runs.
    #[error("frame {}.{} runs no script; a result is given once, with the frame of its job", frame.slot, frame.generation)]
    NoSuchFrame {
        /// The frame that was named.
        frame: FrameId,
    },
}

fn way_out(status: Status) -> &'static str {
    match status {
        Status::Idle => "start it first",
        Status::Running => "it can be paused or stopped",
        Status::Paused => "it can be resumed or stopped",
        Status::Stopping => "it ends when its scripts do; stop again to run no more handlers",
        Status::Finished => "begin a new run",
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Idle => "has not started",
            Self::Running => "is running",
            Self::Paused => "is paused",
            Self::Stopping => "is stopping",
            Self::Finished => "has finished",
        })
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Pause => "pause",
            Self::Resume => "resume",
            Self::Stop => "stop",
        })
    }
}
