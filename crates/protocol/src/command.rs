//! Commands to a run.

use crate::{Breakpoint, LinkLifetime, OnCrash, wait_for_contact};
use serde::{Deserialize, Serialize};

/// A command with its metadata: id, author, expiry, and the state of the run that the sender knew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Envelope {
    /// Id chosen by the sender, at most 128 bytes. Each id is executed once. A server prepends the user's name.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 193))]
    pub id: String,
    /// Author of the command, for the record.
    #[serde(default)]
    pub author: String,
    /// Sequence number of the last event that the sender had seen, if the decision was based on events.
    #[serde(default)]
    pub decided_on: Option<u64>,
    /// Expiry of the command.
    #[serde(default)]
    pub expiry: Option<Expiry>,
    /// Earliest time of effect: ms since 1970, UTC, by the receiver's clock. Only a robot behind a link stores a command until
    /// then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub not_before: Option<u64>,
    /// Epoch of authority under which the sender decided. The command is refused if control has passed since.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub epoch: Option<u64>,
    /// The command to execute.
    pub command: Command,
}

impl Envelope {
    /// Creates a command with an id and an author, and without optional metadata.
    pub fn new(id: impl Into<String>, author: impl Into<String>, command: Command) -> Self {
        let (id, author) = (id.into(), author.into());
        Self { id, author, decided_on: None, expiry: None, not_before: None, epoch: None, command }
    }

    /// Adds the default expiry of commands from people, if the command has none. `now_ms` is the runner's clock. `link` gives the
    /// lifetime of commands over the link to the run, if there is one.
    #[must_use]
    pub fn dated(self, now_ms: u64, link: Option<LinkLifetime>) -> Self {
        let contact_ms = link.and_then(|link| link.contact_ms);
        let until_contact = contact_ms.map_or(0, |begin_ms| wait_for_contact(now_ms, begin_ms));
        let now_ms = now_ms.saturating_add(until_contact).max(self.not_before.unwrap_or(0));
        let length = || serde_json::to_vec(&self.command).map_or(0, |json| json.len() as u64);
        let until = |lifetime_ms| {
            let link_ms = link.map(|link| link.of_length(length()));
            Expiry(now_ms.saturating_add(link_ms.unwrap_or(lifetime_ms)))
        };
        let expiry = self.expiry.or_else(|| self.command.lifetime_ms().map(until));
        Self { expiry, ..self }
    }
}

/// Time after which a command must not be executed: ms since 1970, UTC, by the runner's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Expiry(pub u64);

impl Command {
    /// Default lifetime of a command from a person, in ms, for the page, `rafcon attach` and `rafcon tell`. `None` for commands
    /// that end the run: they never expire.
    pub fn lifetime_ms(&self) -> Option<u64> {
        match self {
            Self::Stop | Self::Kill => None,
            _ => Some(10_000),
        }
    }

    /// Returns the type of the command, as in its JSON.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Start { .. } => "start",
            Self::Pause => "pause",
            Self::Resume { .. } => "resume",
            Self::Stop => "stop",
            Self::Kill => "kill",
            Self::StepMode => "step_mode",
            Self::StepInto { .. } => "step_into",
            Self::StepOver { .. } => "step_over",
            Self::StepOut { .. } => "step_out",
            Self::StepBack { .. } => "step_back",
            Self::RunTo { .. } => "run_to",
            Self::RunSelected { .. } => "run_selected",
            Self::RunOnlySelected { .. } => "run_only_selected",
            Self::StartFromHistory { .. } => "start_from_history",
            Self::ForceOutcome { .. } => "force_outcome",
            Self::Preempt { .. } => "preempt",
            Self::SetBreakpoint { .. } => "set_breakpoint",
            Self::RemoveBreakpoint { .. } => "remove_breakpoint",
            Self::AnswerQuestion { .. } => "answer_question",
            Self::Recover { .. } => "recover",
            Self::Reload { .. } => "reload",
            Self::EditScript { .. } => "edit_script",
            Self::Control { .. } => "control",
        }
    }

    /// Returns true for commands that need no control of the run, because they bring the robot to rest. The right to command is
    /// enough.
    pub fn is_for_everybody(&self) -> bool {
        matches!(self, Self::Stop | Self::Pause)
    }
}

/// A command. Paths are state ids joined by `/`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Command {
    /// Begin the run. If everything is held or waits, start again, optionally elsewhere or with other data.
    Start {
        /// Path of the state to begin at.
        #[serde(default)]
        from: Option<String>,
        /// Values that replace the current ones, for input ports and scoped variables of the states on the path.
        #[serde(default)]
        data: Vec<Given>,
    },
    /// Hold every hierarchy before its next child.
    Pause,
    /// Continue after a pause, a step or a breakpoint.
    Resume {
        /// Branch to resume; see [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// End the run as if it were preempted.
    Stop,
    /// End the runner at once, whatever its scripts do.
    Kill,
    /// Hold before the next child, and then proceed step by step.
    StepMode,
    /// Step to the next child and enter it.
    StepInto {
        /// Path of the branch (a child of a concurrency state). `None` for all branches.
        #[serde(default)]
        branch: Option<String>,
    },
    /// Step to the next child and run it completely.
    StepOver {
        /// Branch to step; see [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// Step to the end of the container.
    StepOut {
        /// Branch to step; see [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// Undo the last child of each hierarchy that is paused or waits, or of one branch.
    StepBack {
        /// Branch to step; see [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// Run until the state before which to hold.
    RunTo {
        /// Path of the state.
        path: String,
    },
    /// Begin at a state, run it, then hold.
    RunSelected {
        /// Path of the state.
        path: String,
        /// Replaced values; see [`Command::Start`].
        #[serde(default)]
        data: Vec<Given>,
    },
    /// Begin at a state, run it, then stop.
    RunOnlySelected {
        /// Path of the state.
        path: String,
        /// Replaced values; see [`Command::Start`].
        #[serde(default)]
        data: Vec<Given>,
    },
    /// Start again at an `entered` event of the history with the data of that moment, and hold there.
    StartFromHistory {
        /// Sequence number of the event.
        sequence: u64,
    },
    /// End a waiting or held state by an outcome, or skip the state before which its container is held.
    ForceOutcome {
        /// Path of the state.
        path: String,
        /// Id of the outcome.
        outcome: i64,
    },
    /// Preempt one active state and its descendants.
    Preempt {
        /// Path of the state.
        path: String,
    },
    /// Set a breakpoint. It replaces one with an equal id.
    SetBreakpoint {
        /// All settings of the breakpoint, with its id.
        breakpoint: Breakpoint,
    },
    /// Remove a breakpoint by id.
    RemoveBreakpoint {
        /// Id of the breakpoint.
        id: u64,
    },
    /// Answer the question of a state.
    AnswerQuestion {
        /// Id of the question.
        question: u64,
        /// The answer, in the shape that the question's form defines.
        value: serde_json::Value,
    },
    /// Decide about states that a crash interrupted.
    Recover {
        /// Path of one interrupted state. `None` for all.
        #[serde(default)]
        path: Option<String>,
        /// Policy to apply. *ask* is refused here.
        policy: OnCrash,
    },
    /// Reload the machine's folder and use its content from now on.
    Reload {
        /// True to delay a change that touches an active state until that state is left. False to refuse it.
        #[serde(default)]
        wait: bool,
    },
    /// Change the script of a state from its next entry on, in this run only.
    EditScript {
        /// Path of the state.
        path: String,
        /// The whole new script.
        script: String,
    },
    /// Record a change of control. The runner obeys all its viewers as before: the program that admits them decides who may
    /// command.
    Control {
        /// User in control. `None` for nobody.
        #[serde(default)]
        holder: Option<String>,
    },
}

/// A value for an input port or scoped variable of one state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Given {
    /// Path of the state to begin at, or of one of its ancestors.
    pub path: String,
    /// Name of the port or variable.
    pub name: String,
    /// The value as JSON.
    pub value: serde_json::Value,
}

/// Result of a command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer {
    /// The command was executed.
    Applied,
    /// The command was not executed.
    Refused {
        /// Cause, location and remedy.
        reason: String,
    },
    /// The command arrived too late and was not executed.
    Expired,
    /// The command expired without a reply from the robot, which may have executed it.
    Unknown {
        /// Cause, and how to find out.
        reason: String,
    },
}
