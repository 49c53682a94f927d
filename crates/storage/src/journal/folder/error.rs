//! The errors of a journal, with texts for people that say how to mend them.

use super::LOCK_FILE;
use std::io;
use std::path::{Path, PathBuf};

/// The operation that failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doing {
    /// Making a folder.
    Make,
    /// Opening or reading a file.
    Read,
    /// Writing a file.
    Write,
    /// Making a file or folder safe from a power cut.
    Sync,
    /// Locking the run.
    Lock,
    /// Deleting a file or folder.
    Remove,
}

impl std::fmt::Display for Doing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Make => "make",
            Self::Read => "read",
            Self::Write => "write",
            Self::Sync => "sync",
            Self::Lock => "lock",
            Self::Remove => "delete",
        })
    }
}

/// Why a journal cannot be opened, read or written. Nothing that was safe before is lost.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// Another process writes it.
    #[error("the run in {} is still going on (process {process}): join it with `rafcon attach`, or end it first", folder.display())]
    Going {
        /// The run's folder.
        folder: PathBuf,
        /// The process that has it.
        process: u32,
    },
    /// There is a journal already.
    #[error("there is a run in {} already: resume it with `rafcon resume`, or use another folder", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds no run.
    #[error("there is no run in {}: it has no {file}; `rafcon runs` lists all runs", folder.display())]
    NoRun {
        /// The folder.
        folder: PathBuf,
        /// The missing file.
        file: &'static str,
    },
    /// A newer version wrote it.
    #[error("{} is of version {found}, this rafcon reads up to {known}: use the rafcon that wrote it, or a newer one", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// The newest known version.
        known: u32,
    },
    /// No space left.
    #[error("the disk with {} is full: make room (for example with `rafcon runs --prune`)", path.display())]
    DiskFull {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The folder or its disk may not be written to.
    #[error("{} cannot be written: it or its disk is read-only; make it writable, or choose another folder with --runs", path.display())]
    ReadOnly {
        /// The file or folder.
        path: PathBuf,
        /// The error of the system.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The disk refused something else.
    #[error("cannot {doing} {}: check the disk and the permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The operation.
        doing: Doing,
        /// The error of the system.
        source: io::Error,
    },
    /// The database refused something else.
    #[error("the database {} fails: check that its disk has room and is well, and that no other program holds it", path.display())]
    Database {
        /// The file.
        path: PathBuf,
        /// The error of `SQLite`.
        source: rusqlite::Error,
    },
    /// The journal has dropped the requested events to stay within its size.
    #[error("{} has dropped its oldest events to stay within its size: ask for a later one, or give runs more room with --keep-max", path.display())]
    GivenUp {
        /// The file.
        path: PathBuf,
    },
    /// The run has no such machine.
    #[error("{} has no machine {hash}: the events `root` of the run say which it has", path.display())]
    NoMachine {
        /// The file.
        path: PathBuf,
        /// The machine's hash.
        hash: String,
    },
    /// The file is damaged.
    #[error("{} is damaged: {what}; `rafcon history` shows what can still be read", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The damage.
        what: String,
    },
}

impl JournalError {
    /// From an error of the system about a file.
    pub(in crate::journal) fn io(path: &Path, doing: Doing, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            io::ErrorKind::StorageFull
            | io::ErrorKind::QuotaExceeded
            | io::ErrorKind::FileTooLarge => Self::DiskFull { path, source: source.into() },
            io::ErrorKind::ReadOnlyFilesystem | io::ErrorKind::PermissionDenied
                if doing != Doing::Read =>
            {
                Self::ReadOnly { path, source: source.into() }
            }
            _ => Self::Io { path, doing, source },
        }
    }

    /// From an error of `SQLite`.
    pub(in crate::journal) fn database(path: &Path, source: rusqlite::Error) -> Self {
        use rusqlite::ErrorCode;
        let path = path.to_owned();
        match source.sqlite_error_code() {
            Some(ErrorCode::DiskFull) => Self::DiskFull { path, source: source.into() },
            Some(ErrorCode::ReadOnly | ErrorCode::PermissionDenied) => {
                Self::ReadOnly { path, source: source.into() }
            }
            Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt) => {
                Self::Damaged { path, what: source.to_string() }
            }
            // A table or column is missing or holds an impossible value.
            Some(ErrorCode::Unknown) | None => Self::Damaged { path, what: source.to_string() },
            _ => Self::Database { path, source },
        }
    }

    pub(in crate::journal) fn lock(folder: &Path, source: io::Error) -> Self {
        Self::io(&folder.join(LOCK_FILE), Doing::Lock, source)
    }
}

/// Why a batch was not appended. The caller still has it; nothing of it was stored.
#[derive(Debug, thiserror::Error)]
pub enum Full {
    /// The recorder has no room before the next commit.
    #[error("the recorder is full until the next commit")]
    Recorder,
    /// The batch is too large for the recorder, and writing it to a separate file failed. A commit does not help.
    #[error("a large group of events cannot be written")]
    Disk(#[source] JournalError),
}
