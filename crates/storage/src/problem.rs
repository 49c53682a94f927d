//! Problems found while reading a machine, and errors that prevent it. Reading continues after a problem, which names the fault,
//! the location and the remedy. Faults of files only: the model checks the validity rules.

use rafcon_model::json::ParseError;
use rafcon_model::{CONFLICT_REMEDY, PortId, StateId, StatePath};
use smol_str::SmolStr;
use std::path::PathBuf;
use std::{fmt, io};

/// Key that contains the class of a state.
const CLASS: &str = "__jsonqualname__";

/// One fault of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoadProblem {
    /// Path of the state. Empty for the machine as a whole.
    pub state: StatePath,
    /// Path of the file, relative to the machine's folder.
    pub file: PathBuf,
    /// Fault of the file.
    pub fault: Fault,
}

impl LoadProblem {
    /// Returns true if the validity rules also find the fault in the loaded machine. A caller that checks both omits it here.
    pub fn is_found_by_rules(&self) -> bool {
        matches!(self.fault, Fault::LibraryVersion { .. } | Fault::ValueWithoutPort { .. })
    }
}

/// A fault of a file in a machine's folder.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// The file does not parse.
    #[error("is not JSON: {0}")]
    Malformed(ParseError),
    /// The file does not parse, because a merge left conflict markers in it. The first is in this line.
    #[error("has conflict markers of a merge, the first in line {0}")]
    Conflict(u64),
    /// The file is not text.
    #[error("is not UTF-8 text")]
    NotUtf8,
    /// The file as a whole, or one of its keys.
    #[error("{0}")]
    Wrong(Wrong),
    /// A part of the state is set aside.
    #[error("{element}: {wrong}")]
    Element {
        /// Position in the file, such as `outcomes.3`.
        element: SmolStr,
        /// Fault of the part.
        wrong: Wrong,
    },
    /// The class name is unknown.
    #[error("unknown class `{0}`")]
    UnknownClass(SmolStr),
    /// A sibling or ancestor of the state has an equal id.
    #[error("the id {old} is taken; the state is now {new}")]
    TakenId {
        /// Id in the file.
        old: StateId,
        /// New id of the state.
        new: StateId,
    },
    /// The library was not found or cannot be read.
    #[error("library {library} is missing: {reason}")]
    MissingLibrary {
        /// Path and name of the library.
        library: SmolStr,
        /// Reason why it is missing.
        reason: SmolStr,
    },
    /// The instance was created with another version of the library.
    #[error("made with version {wanted} of library {library}, found version {found}")]
    LibraryVersion {
        /// Path and name of the library.
        library: SmolStr,
        /// Version in the instance.
        wanted: SmolStr,
        /// Version of the library.
        found: SmolStr,
    },
    /// A runtime value for a port that the library does not have.
    #[error("has a runtime value for {side} port {port}, which library {library} does not have")]
    ValueWithoutPort {
        /// Path and name of the library.
        library: SmolStr,
        /// Kind of the port: `input` or `output`.
        side: &'static str,
        /// Id of the port.
        port: PortId,
    },
    /// The library itself has faults.
    #[error("library {library} has problems of its own ({count}), the first: {first}")]
    InLibrary {
        /// Path and name of the library.
        library: SmolStr,
        /// Number of faults in the library's files.
        count: usize,
        /// Text of the first fault.
        first: Box<str>,
    },
    /// A folder contains a link to one of its ancestors.
    #[error("the folder {0} leads back to one that contains it")]
    Loop(SmolStr),
    /// The folders exceed the maximum depth, and deeper ones are not read.
    #[error("states nest deeper than {0} levels")]
    TooDeep(usize),
    /// The folder of the root differs from the one in the header.
    #[error("the root's folder {0} does not exist")]
    RootElsewhere(SmolStr),
}

/// A fault of a part of a document.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Wrong {
    /// A required key is missing.
    #[error("`{0}` is missing")]
    Missing(&'static str),
    /// A value has a wrong type.
    #[error("`{key}` should be {expected}, not {found}")]
    Type {
        /// Name of the key.
        key: &'static str,
        /// Name of the expected type.
        expected: &'static str,
        /// Name of the actual type.
        found: &'static str,
    },
    /// The value is not an object.
    #[error("should be an object, not {0}")]
    NotAnObject(&'static str),
    /// The key of an element is not a number.
    #[error("the key is not a whole number")]
    Key,
    /// Two keys of elements denote one number.
    #[error("the id occurs twice")]
    Twice,
    /// The element contains another id than its key. The key counts.
    #[error("the id inside is {0}, the key counts")]
    OtherId(i64),
}

impl Fault {
    /// Returns the remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Malformed(_) | Self::NotUtf8 => {
                "correct the file by hand or restore it; it stays as it is until this part of the state is changed"
            }
            Self::Conflict(_) => CONFLICT_REMEDY,
            Self::Wrong(_) => "correct the key in the file, or change the state and save it",
            Self::Element { wrong: Wrong::OtherId(_), .. } => "save the state to make both equal",
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

    /// Returns true if the state has lost a part of its behaviour. Such a state aborts before it does anything.
    pub(crate) fn is_damage(&self) -> bool {
        const HARMLESS: [&str; 4] = ["name", "state_id", "description", "income"];
        match self {
            Self::Malformed(_)
            | Self::Conflict(_)
            | Self::NotUtf8
            | Self::UnknownClass(_)
            | Self::Wrong(Wrong::NotAnObject(_) | Wrong::Missing(CLASS)) => true,
            Self::Wrong(Wrong::Type { key, .. }) => !HARMLESS.contains(key),
            Self::Element { wrong, .. } => !matches!(wrong, Wrong::OtherId(_) | Wrong::Twice),
            _ => false,
        }
    }

    /// Returns true if the fault is only a note: the machine was loaded as its files describe it.
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

/// Reason why a machine cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The path does not exist.
    #[error("{} does not exist; give the folder of a state machine or a file in it", path.display())]
    NotFound {
        /// Path as given by the caller.
        path: PathBuf,
    },
    /// The folder contains no header.
    #[error("{} is not a state machine: it has no statemachine.json", path.display())]
    NotAMachine {
        /// Path of the folder.
        path: PathBuf,
    },
    /// The machine has a layout that is too old to read.
    #[error(
        "{} has only a statemachine.yaml; save it with a RAFCON before 1.0, which writes statemachine.json",
        path.display()
    )]
    Yaml {
        /// Path of the folder.
        path: PathBuf,
    },
    /// The folder contains a header but no state.
    #[error("{} has no root state: a folder with core_data.json is missing", path.display())]
    NoRoot {
        /// Path of the folder.
        path: PathBuf,
    },
    /// Reading from the disk failed.
    #[error("cannot read {}", path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error reported by the system.
        source: io::Error,
    },
    /// A link leads out of the folders from which machines may be loaded.
    #[error(
        "{} leads out of the folders that may be read; put its target there, or add the folder of its target",
        link.display()
    )]
    Outside {
        /// Path of the link.
        link: PathBuf,
    },
    /// The file is too large or not a regular file.
    #[error("{} is not a regular file of at most 64 MiB; put one there", file.display())]
    Unfit {
        /// Path of the file.
        file: PathBuf,
    },
    /// A save was interrupted and cannot be finished.
    #[error("cannot finish the interrupted save in {}", path.display())]
    Recovery {
        /// Folder of the machine.
        path: PathBuf,
        /// Error reported by the system.
        source: io::Error,
    },
}
