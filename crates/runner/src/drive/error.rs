//! Why a run does not begin, a command is refused, or a value cannot be made. Callers match on the variants, people read the
//! sentences.

use crate::record::tell::reason;
use rafcon_engine::{Refusal, UnknownPath};
use rafcon_model::edit::EditError;
use rafcon_storage::LoadError;
use rafcon_storage::config::ConfigError;
use rafcon_storage::journal::JournalError;
use std::io;
use thiserror::Error;

/// A value that a host cannot make, restore or set; the sentence is the host's.
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
    /// There is nothing to read it again from.
    #[error("the machine of this run was not read from a folder")]
    NotFromFolder,
    /// The host did not leave the interpreter.
    #[error("the machine cannot be had now")]
    Unavailable,
    /// The host lent nothing that makes values of literals.
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
    /// The change would take an active state away.
    #[error(transparent)]
    Engine(#[from] Refusal),
}

/// A question or an answer that does not fit its form; the sentences of `Form` say how.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum QuestionError {
    /// The form cannot be answered.
    #[error("{0}")]
    Form(String),
    /// The default does not fit the form.
    #[error("the default is no answer: {0}")]
    Default(String),
    /// The answer does not fit the form.
    #[error("{0}")]
    Answer(String),
    /// Someone answered it before, or its time is over.
    #[error("question {0} is closed already")]
    Closed(u64),
    /// Nothing has asked it.
    #[error("there is no question {0}; a snapshot lists those that are open")]
    Unknown(u64),
}

/// A command that was not carried out.
#[derive(Debug, Error)]
pub enum CommandError {
    /// It came after its expiry.
    #[error("it came too late")]
    Late,
    /// It came before its time.
    #[error(
        "it is for later, and only a robot behind a link keeps commands for later: give it when its time has come"
    )]
    Early,
    /// The host did not leave the interpreter.
    #[error("the run cannot be reached")]
    Unreachable,
    /// The engine takes no such input.
    #[error("this command is no input")]
    NotAnInput,
    /// To recover means to decide.
    #[error("to ask decides nothing; choose to abort the states or to restart them")]
    Undecided,
    /// A given value cannot be made.
    #[error("the value for \"{name}\" of {path} cannot be used: {why}")]
    Value {
        /// The port.
        name: String,
        /// Its state.
        path: String,
        /// What the host says.
        why: ValueError,
    },
    /// A global variable of the launch cannot be set.
    #[error("the global variable \"{name}\" cannot be set: {why}")]
    Global {
        /// The variable.
        name: String,
        /// What the host says.
        why: ValueError,
    },
    /// There is no history to begin from.
    #[error("this run keeps no journal, so it has no history to begin from; run it with one")]
    NoJournal,
    /// The run cannot begin again there.
    #[error(transparent)]
    History(#[from] ResumeError),
    /// The engine refuses it.
    #[error(transparent)]
    Engine(#[from] Refusal),
    /// The machine cannot be changed so.
    #[error(transparent)]
    Change(#[from] ChangeError),
    /// The answer does not fit.
    #[error(transparent)]
    Question(#[from] QuestionError),
}

/// A machine that cannot be made ready.
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
    /// An input of the root cannot be made.
    #[error("the value for input \"{name}\" cannot be used: {why}")]
    Input {
        /// The input.
        name: String,
        /// What the host says.
        why: ValueError,
    },
    /// The root has no input of this name.
    #[error("the machine has no input `{name}`: {}", listed(inputs))]
    NoSuchInput {
        /// The name.
        name: String,
        /// The inputs that it has.
        inputs: Vec<String>,
    },
    /// `afterwards` without `start_from`.
    #[error(
        "the start says what happens after its first state, but not which that is: name it in `start_from`, or leave `afterwards` out"
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

/// A run that cannot be resumed, or an entry that no run can begin again at.
#[derive(Debug, Error)]
pub enum ResumeError {
    /// The launch names no folder.
    #[error("a run is resumed by its folder: name it in `run_folder`")]
    NoFolder,
    /// The run happens elsewhere.
    #[error(
        "this is the replica of a run of robot `{robot}`: resume it there, or name the server of this station with `--server`"
    )]
    Replica {
        /// The robot.
        robot: String,
    },
    /// The journal cannot be read.
    #[error("{}", reason(.0))]
    Journal(Box<JournalError>),
    /// A value that the run needs is damaged.
    #[error("{}: go on from an entry of its history where it was not needed", reason(.0))]
    DamagedValue(Box<JournalError>),
    /// The run has ended.
    #[error(
        "the run has come to its end; begin a new one, or choose an entry of its history to begin from"
    )]
    Ended,
    /// The event is none that a run can begin again at.
    #[error("event {0} is no entry of a state that is safe on disk; the history says which are")]
    NotAnEntry(u64),
    /// The journal names a machine by something else than a hash.
    #[error("{0} is no hash of a machine")]
    NotAHash(String),
}

impl From<JournalError> for ResumeError {
    fn from(error: JournalError) -> Self {
        Self::Journal(Box::new(error))
    }
}

/// A run that did not begin; the viewer was told.
#[derive(Debug, Error)]
pub enum LoadFailure {
    /// Its machine cannot be made ready.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// It cannot be resumed.
    #[error(transparent)]
    Resume(#[from] ResumeError),
    /// The machine has no state at which it should begin.
    #[error(transparent)]
    UnknownStart(#[from] UnknownPath),
    /// Its journal cannot be begun.
    #[error("{}", reason(.0))]
    Journal(Box<JournalError>),
    /// Its beginning was refused.
    #[error(transparent)]
    Refused(#[from] CommandError),
    /// Its beginning was refused, and the journal cannot be removed.
    #[error("{why}; its journal stays: {}", reason(.journal))]
    JournalStays {
        /// Why it was refused.
        why: CommandError,
        /// Why the journal stays.
        journal: Box<JournalError>,
    },
}

/// A group of records that did not become safe.
#[derive(Debug, Error)]
pub(crate) enum CommitError {
    #[error("{}", reason(.0))]
    Journal(Box<JournalError>),
    #[error("a defect of RAFCON, please report it")]
    Defect,
}
