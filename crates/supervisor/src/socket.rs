//! The socket of a run that is going on.

use rafcon_storage::journal::folder::SOCKET_FILE;
use std::fs::File;
use std::io;
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

/// Why a run cannot be joined.
#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    /// Its folder cannot be opened.
    #[error("cannot open the run's folder {}", folder.display())]
    Folder {
        /// Which one.
        folder: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// Nobody listens.
    #[error(
        "nobody runs {run}: `rafcon history {run}` shows what happened, `rafcon resume {run}` takes it up again if it did \
         not end"
    )]
    Nobody {
        /// The run's id.
        run: String,
        /// Why not.
        source: io::Error,
    },
}

/// Connects to the runner of the run in `folder`. The folder is named by its descriptor: a socket's path may be short only.
pub fn connect(folder: &Path) -> Result<UnixStream, JoinError> {
    let open = File::open(folder)
        .map_err(|source| JoinError::Folder { folder: folder.to_path_buf(), source })?;
    let short = Path::new("/proc/self/fd").join(open.as_raw_fd().to_string()).join(SOCKET_FILE);
    UnixStream::connect(&short)
        .or_else(|_no_proc| UnixStream::connect(folder.join(SOCKET_FILE)))
        .map_err(|source| {
            let run = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
            JoinError::Nobody { run, source }
        })
}
