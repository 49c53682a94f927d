//! Everything that is said after the hello.

use crate::{Answer, Envelope, Event, Launch, Snapshot};
use serde::{Deserialize, Serialize};

/// From a viewer (command line, server) to the runner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "snake_case")]
pub enum ToRunner {
    /// What to run; the first message after the hello.
    Launch(Launch),
    /// A command.
    Command(Envelope),
}

/// From the runner to a viewer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "snake_case")]
pub enum ToViewer {
    /// The machine could not be loaded; the runner ends.
    LoadFailed {
        /// What, where, and the way out.
        reason: String,
    },
    /// The machine was loaded and the run begins.
    Loaded {
        /// The root state's name.
        name: String,
        /// States of the machine.
        states: u64,
        /// Faults of the machine, one line each, that did not keep it from loading.
        problems: Vec<String>,
    },
    /// Something happened.
    Event {
        /// Counts from 1, without gaps.
        sequence: u64,
        /// Time since the start of the run by a monotonic clock, in ns.
        t_ns: u64,
        /// What.
        event: Event,
    },
    /// How things stand.
    Snapshot(Snapshot),
    /// What became of a command.
    Answer {
        /// The command's id.
        id: String,
        /// The answer.
        #[serde(flatten)]
        answer: Answer,
    },
}
