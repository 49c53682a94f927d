//! Errors of starts, commands, values and changes. Callers match on the variants; people read the sentences.

use crate::record::tell::reason;
use rafcon_engine::{Refusal, UnknownPath};
use rafcon_model::edit::EditError;
use rafcon_storage::LoadError;
use rafcon_storage::config::ConfigError;
use rafcon_storage::journal::JournalError;
use std::io;
use thiserror::Error;

/// A value that a host cannot create, restore or set. The host supplies the sentence.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct ValueError(pub String);

impl From<String> for ValueError {
    fn from(why: String) -> Self {
        Self(why)
    }
}

impl From<&str> for ValueError {
    fn from(why: &str) -> Self {
        Self(why.to_owned())
    }
}

/// A change of the running machine that was refused.
#[derive(Debug, Error)]
pub enum ChangeError {
    /// The machine has no folder from which it could be loaded again.
    #[error("the machine of this run was not read from a folder")]
    NotFromFolder,
    /// The host did not leave the interpreter.
    #[error("the machine cannot be had now")]
    Unavailable,
    /// The host supplied no converter for literals.
    #[error("the host made no values for the changed machine")]
    NoLiterals,
    /// An edit breaks a rule of the model.
    #[error("{0}")]
    Edit(Box<EditError>),
    /// The folder cannot be read.
    #[error("{}", reason(.0))]
    Load(Box<LoadError>),
    /// The root state's own file is damaged.
    #[error("the root state cannot be read, so the run keeps its machine: {0}")]
    Damaged(String),
    /// The change would break an active state.
    #[error(transparent)]
    Engine(#[from] Refusal),
}

/// A question or an answer that does not fit its form. `Form` supplies the sentences.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum QuestionError {
    /// The form has an error, so that no answer would fit.
    #[error("{0}")]
    Form(String),
    /// The default does not fit the form.
    #[error("the default is no answer: {0}")]
    Default(String),
    /// The answer does not fit the form.
    #[error("{0}")]
    Answer(String),
    /// The question was already answered, or its time is over.
    #[error("question {0} is closed already")]
    Closed(u64),
    /// No script has asked this question.
    #[error("there is no question {0}; a snapshot lists those that are open")]
    Unknown(u64),
}

/// A command that was not carried out.
#[derive(Debug, Error)]
pub enum CommandError {
    /// The command had expired.
    #[error("it came too late")]
    Late,
    /// The command is for a later time.
    #[error(
        "it is for later, and only a robot behind a link keeps commands for later: give it when its time has come"
    )]
    Early,
    /// The host did not leave the interpreter.
    #[error("the run cannot be reached")]
    Unreachable,
    /// The command is not an input of the engine.
    #[error("this command is no input")]
    NotAnInput,
    /// Recovery requires a decision.
    #[error("to ask decides nothing; choose to abort the states or to restart them")]
    Undecided,
    /// A value in the command cannot be created.
    #[error("the value for \"{name}\" of {path} cannot be used: {why}")]
    Value {
        /// Name of the port.
        name: String,
        /// Path of the state.
        path: String,
        /// Error of the host.
        why: ValueError,
    },
    /// A global variable of the launch cannot be set.
    #[error("the global variable \"{name}\" cannot be set: {why}")]
    Global {
        /// Name of the variable.
        name: String,
        /// Error of the host.
        why: ValueError,
    },
    /// The run has no history to start from.
    #[error("this run keeps no journal, so it has no history to begin from; run it with one")]
    NoJournal,
    /// The run cannot restart at this entry.
    #[error(transparent)]
    History(#[from] ResumeError),
    /// The engine refused the input.
    #[error(transparent)]
    Engine(#[from] Refusal),
    /// The machine cannot be changed in this way.
    #[error(transparent)]
    Change(#[from] ChangeError),
    /// The answer does not fit the question.
    #[error(transparent)]
    Question(#[from] QuestionError),
}

/// A machine that cannot be prepared.
#[derive(Debug, Error)]
pub enum PrepareError {
    /// The configuration cannot be read.
    #[error("{}", reason(.0))]
    Config(Box<ConfigError>),
    /// The machine cannot be read.
    #[error("{}", reason(.0))]
    Load(Box<LoadError>),
    /// The machine's folder has no absolute path.
    #[error("{}", reason(.0))]
    Folder(io::Error),
    /// The root state's own file is damaged.
    #[error("the root state cannot be read, so the machine does not run: {0}")]
    Damaged(String),
    /// The value for an input of the root cannot be created.
    #[error("the value for input \"{name}\" cannot be used: {why}")]
    Input {
        /// Name of the input.
        name: String,
        /// Error of the host.
        why: ValueError,
    },
    /// The root has no input of this name.
    #[error("the machine has no input `{name}`: {}", listed(inputs))]
    NoSuchInput {
        /// Name in the launch.
        name: String,
        /// Names of the root's inputs.
        inputs: Vec<String>,
    },
    /// The launch has `afterwards`, but no `start_from`.
    #[error(
        "the start has `afterwards`, but no first state: name it in `start_from`, or omit `afterwards`"
    )]
    NoFirstState,
}

fn listed(inputs: &[String]) -> String {
    if inputs.is_empty() {
        "it has none".to_owned()
    } else {
        format!("it has `{}`", inputs.join("`, `"))
    }
}

/// A run that cannot be resumed, or an entry at which no run can restart.
#[derive(Debug, Error)]
pub enum ResumeError {
    /// The launch names no run folder.
    #[error("a run is resumed by its folder: name it in `run_folder`")]
    NoFolder,
    /// The folder is a replica of a run of a robot.
    #[error(
        "this is the replica of a run of robot `{robot}`: resume it there, or name the server of this station with `--server`"
    )]
    Replica {
        /// Name of the robot.
        robot: String,
    },
    /// The journal cannot be read.
    #[error("{}", reason(.0))]
    Journal(Box<JournalError>),
    /// A value that the run needs is damaged.
    #[error("{}: restart from an entry of its history that does not need the value", reason(.0))]
    DamagedValue(Box<JournalError>),
    /// The run has ended.
    #[error(
        "the run has come to its end; begin a new one, or choose an entry of its history to begin from"
    )]
    Ended,
    /// The event is not an entry at which a run can restart.
    #[error("event {0} is no entry of a state that is safe on disk: choose one from the history")]
    NotAnEntry(u64),
    /// The journal names a machine by an invalid hash.
    #[error("{0} is no hash of a machine")]
    NotAHash(String),
}

impl From<JournalError> for ResumeError {
    fn from(error: JournalError) -> Self {
        Self::Journal(Box::new(error))
    }
}

/// A run that did not begin. The viewer has received the reason.
#[derive(Debug, Error)]
pub enum LoadFailure {
    /// The machine cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The run cannot be resumed.
    #[error(transparent)]
    Resume(#[from] ResumeError),
    /// The machine has no state at which it should begin.
    #[error(transparent)]
    UnknownStart(#[from] UnknownPath),
    /// The journal cannot be created.
    #[error("{}", reason(.0))]
    Journal(Box<JournalError>),
    /// The start was refused.
    #[error(transparent)]
    Refused(#[from] CommandError),
    /// The start was refused, and the journal cannot be removed.
    #[error("{why}; its journal stays: {}", reason(.journal))]
    JournalStays {
        /// Reason of the refusal.
        why: CommandError,
        /// Reason why the journal remains.
        journal: Box<JournalError>,
    },
}

/// A group of records that could not be committed.
#[derive(Debug, Error)]
pub(crate) enum CommitError {
    #[error("{}", reason(.0))]
    Journal(Box<JournalError>),
    #[error("a defect of RAFCON, please report it")]
    Defect,
}
