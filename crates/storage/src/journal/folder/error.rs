//! Errors of a journal. Their texts contain the remedy.

use super::LOCK_FILE;
use std::io;
use std::path::{Path, PathBuf};

/// Operation that failed on a file or folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doing {
    /// Creation of a folder.
    Make,
    /// Opening or reading of a file.
    Read,
    /// Writing of a file.
    Write,
    /// Sync of a file or folder to disk.
    Sync,
    /// Locking of the run.
    Lock,
    /// Deletion of a file or folder.
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

/// Reason why a journal cannot be opened, read or written. Events that were safe before remain safe.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// Another process is writing the journal.
    #[error("the run in {} is still active (process {process}): join it with `rafcon attach`, or end it first", folder.display())]
    Going {
        /// Folder of the run.
        folder: PathBuf,
        /// Id of that process.
        process: u32,
    },
    /// The folder already contains a journal.
    #[error("there is a run in {} already: resume it with `rafcon resume`, or use another folder", folder.display())]
    Exists {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// The folder contains no run.
    #[error("there is no run in {}: it has no {file}; `rafcon runs` lists all runs", folder.display())]
    NoRun {
        /// Path of the folder.
        folder: PathBuf,
        /// Name of the missing file.
        file: &'static str,
    },
    /// The file was written by a newer version.
    #[error("{} is of version {found}, this rafcon reads up to {known}: use the rafcon that wrote it, or a newer one", path.display())]
    Newer {
        /// Path of the file.
        path: PathBuf,
        /// Version of the file.
        found: u32,
        /// Newest supported version of the file.
        known: u32,
    },
    /// The disk is full.
    #[error("the disk with {} is full: make room (for example with `rafcon runs --prune`)", path.display())]
    DiskFull {
        /// Path of the file.
        path: PathBuf,
        /// Error reported by the system.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The folder or its disk is read-only.
    #[error("{} cannot be written: it or its disk is read-only; make it writable, or choose another folder with --runs", path.display())]
    ReadOnly {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error reported by the system.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// Another disk operation failed.
    #[error("cannot {doing} {}: check the disk and the permissions", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Operation that failed on this file.
        doing: Doing,
        /// Error reported by the system.
        source: io::Error,
    },
    /// Another database operation failed.
    #[error("the database {} fails: check that its disk has room and is well, and that no other program holds it", path.display())]
    Database {
        /// Path of the file.
        path: PathBuf,
        /// Error reported by `SQLite`.
        source: rusqlite::Error,
    },
    /// The requested events were deleted to limit the size of the journal.
    #[error("{} has dropped its oldest events to stay within its size: ask for a later one, or give runs more room with --keep-max", path.display())]
    GivenUp {
        /// Path of the file.
        path: PathBuf,
    },
    /// The run has no machine with this hash.
    #[error("{} has no machine {hash}: the `root` events of the run list its machines", path.display())]
    NoMachine {
        /// Path of the file.
        path: PathBuf,
        /// Hash of the machine.
        hash: String,
    },
    /// The file is damaged.
    #[error("{} is damaged: {what}; `rafcon history` shows what can still be read", path.display())]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// Description of the damage.
        what: String,
    },
}

impl JournalError {
    /// Converts an error of the system about a file.
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

    /// Converts an error of `SQLite`.
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
            // A table or column is missing or contains an impossible value.
            Some(ErrorCode::Unknown) | None => Self::Damaged { path, what: source.to_string() },
            _ => Self::Database { path, source },
        }
    }

    pub(in crate::journal) fn lock(folder: &Path, source: io::Error) -> Self {
        Self::io(&folder.join(LOCK_FILE), Doing::Lock, source)
    }
}

/// Reason why a batch was not appended. Nothing of it was stored, and the caller still has it.
#[derive(Debug, thiserror::Error)]
pub enum Full {
    /// The recorder is full until the next commit.
    #[error("the recorder is full until the next commit")]
    Recorder,
    /// The batch is too large for the recorder, and writing it to a separate file failed. A commit does not help.
    #[error("a large group of events cannot be written")]
    Disk(#[source] JournalError),
}
