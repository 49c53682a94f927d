//! Errors that end a relay.

use rafcon_link::SealError;
use rafcon_storage::journal::JournalError;
use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Reason why a relay did not start, or ended.
#[derive(Debug, thiserror::Error)]
pub enum RelayError {
    /// Its address is not to be had.
    #[error(
        "cannot receive datagrams at {address}: check that the address is this computer's and that no other program has it"
    )]
    Bind {
        /// The address.
        address: SocketAddr,
        /// Reason of the failure.
        source: io::Error,
    },
    /// Its folder cannot be written.
    #[error("cannot write {}: the number of this start has to be on the disk before anything is sent", path.display())]
    Folder {
        /// The file.
        path: PathBuf,
        /// Reason of the failure.
        source: io::Error,
    },
    /// A file in its folder cannot be parsed.
    #[error("{} is damaged: pair robot and station again, and remove the file", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// The system gives no random numbers.
    #[error("the system gives no random numbers, without which nothing can be sealed")]
    NoRandomness,
    /// A file in its folder cannot be replaced.
    #[error("cannot keep what the link needs after a restart")]
    Kept(#[from] JournalError),
    /// A thread cannot be started.
    #[error(
        "cannot start a thread for the link: end other programs, or raise the limit of threads"
    )]
    Thread {
        /// Reason of the failure.
        source: io::Error,
    },
    /// The session has sealed as many datagrams as one start may.
    #[error(transparent)]
    Seal(#[from] SealError),
}
