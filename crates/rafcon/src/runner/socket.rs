//! The socket of a run that is going on.

use anyhow::{Context as _, Result};
use std::fs::File;
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::path::Path;

/// Its name in the run's folder.
const SOCKET: &str = "socket";

/// Connects to the runner of the run in `folder`. The folder is named by its descriptor: a socket's path may be short only.
pub(crate) fn connect(folder: &Path) -> Result<UnixStream> {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let open = File::open(folder)
        .with_context(|| format!("cannot open the run's folder {}", folder.display()))?;
    let short = Path::new("/proc/self/fd").join(open.as_raw_fd().to_string()).join(SOCKET);
    UnixStream::connect(&short).or_else(|_no_proc| UnixStream::connect(folder.join(SOCKET))).with_context(|| {
        format!(
            "nobody runs {name}: `rafcon history {name}` shows what happened, `rafcon resume {name}` takes it up again if it did not end"
        )
    })
}
