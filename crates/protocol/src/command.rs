//! What a person or program asks of a run.

use crate::{Breakpoint, LinkLifetime, OnCrash, wait_for_contact};
use serde::{Deserialize, Serialize};

/// A command with what law 7 asks for: an id, the moment it was decided on, and an expiry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Envelope {
    /// Chosen by the sender, of 128 bytes at most; the same id is carried out once. A server puts the user's name before it.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 193))]
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
    /// Before which moment it is not carried out: ms since 1970 UTC by the clock of whoever is asked. Only a robot behind a link keeps
    /// a command for later.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub not_before: Option<u64>,
    /// The epoch of authority under which the sender decided: the command is refused if control has passed since.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub epoch: Option<u64>,
    /// What is asked.
    pub command: Command,
}

impl Envelope {
    /// A command with nothing but what each has.
    pub fn new(id: impl Into<String>, author: impl Into<String>, command: Command) -> Self {
        let (id, author) = (id.into(), author.into());
        Self { id, author, decided_on: None, expiry: None, not_before: None, epoch: None, command }
    }

    /// Adds the expiry of a command of a person, unless it has one. `now_ms` is the runner's clock; `link` is the lifetime of
    /// commands over the link to the run, if there is one.
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

/// The moment after which a command must not be carried out, in ms since 1970 UTC by the runner's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Expiry(pub u64);

impl Command {
    /// For how long a person who gives the command wants it, in ms: the one rule of the page, `rafcon attach` and `rafcon tell`.
    /// `None`: it is wanted whenever it arrives, for it only brings the run to its end.
    pub fn lifetime_ms(&self) -> Option<u64> {
        match self {
            Self::Stop | Self::Kill => None,
            _ => Some(10_000),
        }
    }

    /// The type of the command, as in its JSON.
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

    /// Whether everyone who may command can give it, whoever holds control: it brings a robot to rest.
    pub fn is_for_everybody(&self) -> bool {
        matches!(self, Self::Stop | Self::Pause)
    }
}

/// Everything that can be asked of a run. Paths are state ids joined by `/`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Command {
    /// Begin; in a run in which everything is held or waits: begin again, elsewhere or with other data.
    Start {
        /// Begin at this state.
        #[serde(default)]
        from: Option<String>,
        /// Values instead of those that would be there: input ports and scoped variables of the states on the way.
        #[serde(default)]
        data: Vec<Given>,
    },
    /// Hold every hierarchy before its next child.
    Pause,
    /// Go on after a pause, a step or a breakpoint.
    Resume {
        /// See [`Command::StepInto`].
        #[serde(default)]
        branch: Option<String>,
    },
    /// End the run as if it were preempted.
    Stop,
    /// End the runner at once, whatever its scripts do.
    Kill,
    /// Hold before the first child, or wherever the run is, and then go step by step.
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
        /// See [`Command::Start`].
        #[serde(default)]
        data: Vec<Given>,
    },
    /// Begin at this state, run it, then stop.
    RunOnlySelected {
        /// The state.
        path: String,
        /// See [`Command::Start`].
        #[serde(default)]
        data: Vec<Given>,
    },
    /// Begin again at an `entered` of the history with the data it had then, and hold there.
    StartFromHistory {
        /// The event's sequence number.
        sequence: u64,
    },
    /// End a waiting or held state with this outcome, or skip the state before which its container is held.
    ForceOutcome {
        /// The state.
        path: String,
        /// Id of its outcome.
        outcome: i64,
    },
    /// Ask one active state, and all in it, to end.
    Preempt {
        /// The state.
        path: String,
    },
    /// Set a breakpoint; one with the same id is replaced.
    SetBreakpoint {
        /// All of it.
        breakpoint: Breakpoint,
    },
    /// Remove a breakpoint.
    RemoveBreakpoint {
        /// Its id.
        id: u64,
    },
    /// Answer the question of a state.
    AnswerQuestion {
        /// The question's id.
        question: u64,
        /// The answer, of the shape that the question's form says.
        value: serde_json::Value,
    },
    /// Decide about states that a crash has interrupted.
    Recover {
        /// One of them; `None`: all.
        #[serde(default)]
        path: Option<String>,
        /// How: *ask* is refused here.
        policy: OnCrash,
    },
    /// Read the machine's folder again and go by what is there from now on.
    Reload {
        /// Whether a change that touches an active state waits until it is left, instead of being refused.
        #[serde(default)]
        wait: bool,
    },
    /// Change the script of a state from its next entry on, in the run only.
    EditScript {
        /// The state.
        path: String,
        /// The whole new text.
        script: String,
    },
    /// Someone else commands from now on. A runner notes it down and obeys whom it did before: who may command is for
    /// whoever lets people in to decide.
    Control {
        /// The user; `None`: no one.
        #[serde(default)]
        holder: Option<String>,
    },
}

/// A value for an input port or scoped variable of one state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Given {
    /// The state: the one that is begun at, or one around it.
    pub path: String,
    /// The port's name.
    pub name: String,
    /// The value, as JSON.
    pub value: serde_json::Value,
}

/// What became of a command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer {
    /// It was carried out.
    Applied,
    /// It was not carried out, and why.
    Refused {
        /// What, where, and the way out.
        reason: String,
    },
    /// It came too late, and was not carried out.
    Expired,
    /// It expired without an answer of the robot, which may have carried it out.
    Unknown {
        /// Cause, and how to find out.
        reason: String,
    },
}
