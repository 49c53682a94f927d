//! What was found wrong while reading a machine. The machine is there nevertheless; each problem says what, where and the
//! way out. Knows faults of files, not validity rules: those are the model's.

use rafcon_model::json::ParseError;
use rafcon_model::{PortId, StateId, StatePath};
use smol_str::SmolStr;
use std::fmt;
use std::path::PathBuf;

/// One fault of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoadProblem {
    /// The state that it concerns; empty for the machine as a whole.
    pub state: StatePath,
    /// The file, relative to the machine's folder.
    pub file: PathBuf,
    /// What is wrong.
    pub fault: Fault,
}

impl LoadProblem {
    /// Whether the rules of machines find it too, in the machine that was loaded: whoever asks both leaves it out.
    pub fn is_found_by_rules(&self) -> bool {
        matches!(self.fault, Fault::LibraryVersion { .. } | Fault::ValueWithoutPort { .. })
    }
}

/// What can be wrong with a file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// The file does not parse.
    #[error("is not JSON: {0}")]
    Malformed(ParseError),
    /// The file is not text.
    #[error("is not UTF-8 text")]
    NotUtf8,
    /// The file as a whole, or one of its keys.
    #[error("{0}")]
    Wrong(Wrong),
    /// One of the state's parts is set aside.
    #[error("{element}: {wrong}")]
    Element {
        /// Where it stands in the file, such as `outcomes.3`.
        element: SmolStr,
        /// What is wrong with it.
        wrong: Wrong,
    },
    /// The class name is none that is known.
    #[error("unknown class `{0}`")]
    UnknownClass(SmolStr),
    /// Another state beside or around it has the same id.
    #[error("the id {old} is taken; the state is now {new}")]
    TakenId {
        /// As it stands in the file.
        old: StateId,
        /// As the state is known from now on.
        new: StateId,
    },
    /// The library was not found or not readable.
    #[error("library {library} is missing: {reason}")]
    MissingLibrary {
        /// Path and name of the library.
        library: SmolStr,
        /// Why.
        reason: SmolStr,
    },
    /// The instance was made with another version of the library.
    #[error("made with version {wanted} of library {library}, found version {found}")]
    LibraryVersion {
        /// Path and name of the library.
        library: SmolStr,
        /// The instance's version.
        wanted: SmolStr,
        /// The library's version.
        found: SmolStr,
    },
    /// A runtime value for a port that the library does not have.
    #[error("has a runtime value for {side} port {port}, which library {library} does not have")]
    ValueWithoutPort {
        /// Path and name of the library.
        library: SmolStr,
        /// `input` or `output`.
        side: &'static str,
        /// The port.
        port: PortId,
    },
    /// The library itself has faults.
    #[error("library {library} has problems of its own ({count}), the first: {first}")]
    InLibrary {
        /// Path and name of the library.
        library: SmolStr,
        /// How many.
        count: usize,
        /// The first of them.
        first: Box<str>,
    },
    /// A folder that leads back into itself.
    #[error("the folder {0} leads back to one that contains it")]
    Loop(SmolStr),
    /// Folders beyond the limit are not read.
    #[error("states nest deeper than {0} levels")]
    TooDeep(usize),
    /// The root's folder is not where the header says.
    #[error("the root's folder {0} does not exist")]
    RootElsewhere(SmolStr),
}

/// What can be wrong with a part of a document.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Wrong {
    /// A key that must be there is not.
    #[error("`{0}` is missing")]
    Missing(&'static str),
    /// A value of another type.
    #[error("`{key}` should be {expected}, not {found}")]
    Type {
        /// The key.
        key: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: &'static str,
    },
    /// Not an object.
    #[error("should be an object, not {0}")]
    NotAnObject(&'static str),
    /// The key of an element is not a number.
    #[error("the key is not a whole number")]
    Key,
    /// The key of an element is the same number as another's.
    #[error("the same id stands here twice")]
    Twice,
    /// The id in the element differs from its key, which counts.
    #[error("the id inside is {0}, the key counts")]
    OtherId(i64),
}

impl Fault {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Malformed(_) | Self::NotUtf8 => {
                "correct the file by hand or restore it; it stays as it is until this part of the state is changed"
            }
            Self::Wrong(_) => "correct the key in the file, or change the state and save it",
            Self::Element { wrong: Wrong::OtherId(_), .. } => {
                "save the state to make both the same"
            }
            Self::Element { .. } => "correct it in the file; it is kept there, but has no effect",
            Self::UnknownClass(_) => {
                "correct `__jsonqualname__`; the file stays as it is until the state is changed"
            }
            Self::TakenId { .. } => {
                "save the machine to keep the new id, or give it another in its file"
            }
            Self::MissingLibrary { .. } => {
                "add the library's root to LIBRARY_PATHS, RAFCON_LIBRARY_PATH or --library-path; the reference is kept"
            }
            Self::LibraryVersion { .. } => "check the instance against the library, then save it",
            Self::ValueWithoutPort { .. } => {
                "remove the value; until then it is kept and has no effect"
            }
            Self::InLibrary { .. } => "open the library and correct it there",
            Self::Loop(_) => "remove the link; what lies behind it is not read",
            Self::TooDeep(_) => "move inner states into a library",
            Self::RootElsewhere(_) => "save the machine to bring it into the current layout",
        }
    }

    /// Whether only a note: the machine means what its files say.
    pub fn is_note(&self) -> bool {
        matches!(
            self,
            Self::LibraryVersion { .. } | Self::ValueWithoutPort { .. } | Self::RootElsewhere(_)
        )
    }
}

impl fmt::Display for LoadProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.state.0.is_empty() {
            write!(f, "{}: {}", self.file.display(), self.fault)?;
        } else {
            write!(f, "{} ({}): {}", self.state, self.file.display(), self.fault)?;
        }
        write!(f, "; {}", self.fault.remedy())
    }
}
