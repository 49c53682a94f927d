//! What a person or program asks of a run.

use serde::{Deserialize, Serialize};

/// A command with what law 7 asks for: an id, the moment it was decided on, and an expiry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Envelope {
    /// Chosen by the sender; the same id is carried out once.
    pub id: String,
    /// Who asks, for the record.
    #[serde(default)]
    pub author: String,
    /// The sequence number of the last event that the sender had seen, if it decided on events.
    #[serde(default)]
    pub decided_on: Option<u64>,
    /// When the command is no longer wanted.
    #[serde(default)]
    pub expiry: Option<Expiry>,
    /// What is asked.
    pub command: Command,
}

/// The moment after which a command must not be carried out, in ms since 1970 UTC by the runner's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Expiry(pub u64);

/// Everything that can be asked of a run. Paths are state ids joined by `/`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Command {
    /// Begin, or begin again after the end.
    Start {
        /// Begin at this state.
        #[serde(default)]
        from: Option<String>,
    },
    /// Hold every hierarchy before its next child.
    Pause,
    /// Go on after a pause or a step.
    Resume,
    /// End the run as if it were preempted.
    Stop,
    /// End the runner at once, whatever its scripts do.
    Kill,
    /// Hold before the first child and then go step by step.
    StepMode,
    /// One child further, entering it.
    StepInto {
        /// The branch (path of a child of a concurrency state); `None`: all branches.
        #[serde(default)]
        branch: Option<String>,
    },
    /// One child further, running all that is in it.
    StepOver {
        /// See [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// To the end of the container.
    StepOut {
        /// See [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// One step back.
    StepBack {
        /// See [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// Run until before this state.
    RunTo {
        /// The state.
        path: String,
    },
    /// Begin at this state, run it, then hold.
    RunSelected {
        /// The state.
        path: String,
    },
    /// Begin at this state, run it, then stop.
    RunOnlySelected {
        /// The state.
        path: String,
    },
    /// Begin again at an entry of the history with the data it had then.
    StartFromHistory {
        /// The entry's sequence number.
        sequence: u64,
    },
    /// End a waiting or held state with this outcome.
    ForceOutcome {
        /// The state.
        path: String,
        /// Id of its outcome.
        outcome: i64,
    },
    /// Answer the question of a state.
    AnswerQuestion {
        /// The state.
        path: String,
        /// The answer.
        value: serde_json::Value,
    },
}

/// What became of a command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer {
    /// It was carried out.
    Applied,
    /// It was not carried out, and why.
    Refused {
        /// What, where, and the way out.
        reason: String,
    },
    /// It came too late.
    Expired,
}
