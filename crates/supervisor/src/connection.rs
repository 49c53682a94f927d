//! Connections to runners: the one of the program that starts a run, which sends the launch, and those of programs that join it.

use rafcon_protocol::{FrameError, Hello, Launch, ToRunner, encode};
use rafcon_storage::journal::folder::SOCKET_FILE;
use rafcon_storage::journal::writer_of;
use std::fs::File;
use std::io::{self, Write as _};
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

/// Timeout for a runner to read the launch.
const LAUNCH_TIMEOUT: Duration = Duration::from_mins(1);
/// Interval and number of the attempts to connect to a runner that has just started.
const LOOK_EVERY: Duration = Duration::from_millis(10);
const LOOKS_MAX: u32 = 1_000;

/// The launch was not sent to the runner.
#[derive(Debug, thiserror::Error)]
pub enum BeginError {
    /// The launch cannot be encoded.
    #[error("cannot send the launch to the runner")]
    Launch(#[from] FrameError),
    /// The runner has exited.
    #[error("the runner ended before it read the launch; its output says why")]
    Gone(#[source] io::Error),
    /// The runner does not read.
    #[error("the runner did not read the launch within {} s; its output may say why", LAUNCH_TIMEOUT.as_secs())]
    Silent(#[source] io::Error),
}

/// Sends the hello and the launch. The runner replies over this socket and counts the caller as a viewer of the run. The caller must
/// check the runner's hello, which comes first. It need not read on after `loaded`: the run continues by itself.
pub fn begin(mut control: &UnixStream, launch: Launch) -> Result<(), BeginError> {
    let mut words = encode(&Hello::ours())?;
    words.extend(encode(&ToRunner::Launch(launch))?);
    control.set_write_timeout(Some(LAUNCH_TIMEOUT)).map_err(BeginError::Gone)?;
    control.write_all(&words).map_err(untold)?;
    control.set_write_timeout(None).map_err(BeginError::Gone)
}

fn untold(error: io::Error) -> BeginError {
    match error.kind() {
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => BeginError::Silent(error),
        _ => BeginError::Gone(error),
    }
}

/// The run cannot be joined.
#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    /// Its folder cannot be opened.
    #[error("cannot open the run's folder {}", folder.display())]
    Folder {
        /// Folder of the run.
        folder: PathBuf,
        /// The error of the system call.
        source: io::Error,
    },
    /// No runner listens for connections.
    #[error(
        "{run} is not active: `rafcon history {run}` shows what happened, and `rafcon resume {run}` resumes it if it did \
         not end"
    )]
    Nobody {
        /// Id of the run.
        run: String,
        /// The error of the system call.
        source: io::Error,
    },
}

/// Connects to the runner of the run in `folder`. Uses the folder's descriptor, because a socket's path must be short.
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

/// Connects like [`connect`]. A runner that has just started does not listen yet, so it retries for 10 s while the runner lives.
pub fn connect_once_listening(folder: &Path) -> Result<UnixStream, JoinError> {
    connect_while(folder, || {
        let is_starting = matches!(writer_of(folder), Ok(Some(_)));
        if is_starting {
            thread::park_timeout(LOOK_EVERY);
        }
        is_starting
    })
}

fn connect_while(
    folder: &Path,
    mut is_starting: impl FnMut() -> bool,
) -> Result<UnixStream, JoinError> {
    for _ in 0..LOOKS_MAX {
        match connect(folder) {
            Err(JoinError::Nobody { .. }) if is_starting() => {}
            connected => return connected,
        }
    }
    connect(folder)
}

#[cfg(test)]
mod tests {
    use super::{LOOKS_MAX, begin, connect_once_listening, connect_while};
    use rafcon_protocol::{Hello, Launch, ToRunner, decode};
    use rafcon_storage::journal::folder::SOCKET_FILE;
    use std::io::{BufRead as _, BufReader};
    use std::os::unix::net::UnixListener;
    use std::os::unix::net::UnixStream;

    #[test]
    fn a_runner_is_told_who_speaks_and_then_what_to_run() {
        let (ours, theirs) = UnixStream::pair().unwrap();
        let launch = Launch { listen: true, ..Launch::default() };
        begin(&ours, launch.clone()).unwrap();
        drop(ours);
        let lines: Vec<_> = BufReader::new(theirs).lines().map(Result::unwrap).collect();
        assert_eq!(decode::<Hello>(&lines[0]).unwrap(), Hello::ours());
        assert_eq!(decode::<ToRunner>(&lines[1]).unwrap(), ToRunner::Launch(launch));
        assert_eq!(lines.len(), 2);
    }

    #[test]
    fn a_runner_that_is_gone_is_told_nothing() {
        let (ours, theirs) = UnixStream::pair().unwrap();
        drop(theirs);
        let error = begin(&ours, Launch::default()).unwrap_err().to_string();
        assert_eq!(error, "the runner ended before it read the launch; its output says why");
    }

    #[test]
    fn a_runner_that_has_just_begun_is_awaited() {
        let folder = tempfile::tempdir().unwrap();
        let (mut listener, mut looks) = (None, 0);
        let connected = connect_while(folder.path(), || {
            looks += 1;
            if looks == 3 {
                listener = Some(UnixListener::bind(folder.path().join(SOCKET_FILE)).unwrap());
            }
            true
        });
        assert_eq!((connected.is_ok(), looks), (true, 3));
    }

    #[test]
    fn a_runner_that_never_listens_is_awaited_up_to_the_bound() {
        let folder = tempfile::tempdir().unwrap();
        let mut looks = 0;
        let is_starting = || {
            looks += 1;
            true
        };
        let error = connect_while(folder.path(), is_starting).unwrap_err();
        assert!(error.to_string().contains("is not active"), "{error}");
        assert_eq!(looks, LOOKS_MAX);
    }

    #[test]
    fn a_runner_that_is_gone_is_not_awaited() {
        let folder = tempfile::tempdir().unwrap();
        let error = connect_once_listening(folder.path()).unwrap_err();
        assert!(error.to_string().contains("is not active"), "{error}");
    }
}
