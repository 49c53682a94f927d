//! Starts a runner that outlives the server, and waits until its run begins. Knows processes, but not the reason of a start.
//! Slow: call it only on a blocking thread.

use super::leftovers::{OUTPUT_FILE, last_line};
use crate::Settings;
use rafcon_protocol::api::LoadedMachine;
use rafcon_protocol::{FrameError, Hello, Launch, ToViewer, VersionMismatch, decode, read_frame};
use rafcon_storage::journal::{Reader, has_begun};
use rafcon_supervisor::{BeginError, Exit, Process, Start, StartError, begin};
use std::io::{self, BufRead as _, BufReader};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Child;
use std::thread;
use std::time::Duration;
use tokio::sync::oneshot;

/// Timeout for loading a machine.
const LOAD_TIMEOUT: Duration = Duration::from_mins(2);

/// A started runner whose run begins.
#[derive(Debug)]
pub(super) struct Launched {
    /// Facts about its machine, if it sent them.
    pub(super) loaded: Option<LoadedMachine>,
    /// Open connection, which counts as a viewer of the run.
    pub(super) control: UnixStream,
    /// Receives the exit of its process.
    pub(super) exit: oneshot::Receiver<Exit>,
}

/// The run could not be started.
#[derive(Debug, thiserror::Error)]
pub(super) enum LaunchError {
    /// The process was not started.
    #[error(transparent)]
    Start(#[from] StartError),
    /// No thread is available to wait for its exit.
    #[error("cannot start a thread to supervise the runner")]
    Thread(#[source] io::Error),
    /// The request could not be sent to it.
    #[error(transparent)]
    Begin(#[from] BeginError),
    /// The runner could not load the machine.
    #[error("{0}")]
    Load(String),
    /// It exited before the run began.
    #[error("the interpreter ended before the run began ({exit}){}", last(said))]
    Ended {
        /// Exit status of its process.
        exit: String,
        /// Last line of its output.
        said: String,
    },
    /// Its exit status is unknown.
    #[error("the runner ended, and how is not known")]
    Lost,
    /// It sent no message within the timeout.
    #[error("the machine was not loaded within {} s: the runner was ended", LOAD_TIMEOUT.as_secs())]
    Silent(#[source] io::Error),
    /// Its message does not follow the protocol.
    #[error("the runner's words make no sense")]
    Frame(#[from] FrameError),
    /// Its version of the protocol differs.
    #[error(transparent)]
    Version(#[from] VersionMismatch),
}

impl LaunchError {
    /// True if the runner died before its first message. Another attempt may succeed.
    pub(super) fn is_death(&self) -> bool {
        matches!(self, Self::Ended { .. } | Self::Lost | Self::Begin(BeginError::Gone(_)))
    }
}

fn last(said: &str) -> String {
    if said.is_empty() { String::new() } else { format!(": {said}") }
}

/// First message of a runner.
enum FirstMessage {
    Begun(Option<LoadedMachine>),
    Refused(String),
    Gone,
}

/// Starts a runner for the run in `folder`, and waits until it reports the start of the run. If it dies before, but the run has new
/// events, the run counts as started.
pub(super) fn launch(
    settings: &Settings,
    folder: &Path,
    launch: Launch,
) -> Result<Launched, LaunchError> {
    let start = Start::find(settings.python.as_deref(), &settings.environment)?;
    let output = folder.join(OUTPUT_FILE);
    let before = events(folder);
    let process = start.spawn_detached(&output)?;
    let group = process.group();
    let Process { child, control } = process;
    let exit = reap(child).map_err(LaunchError::Thread);
    let exit = exit.inspect_err(|_| group.kill())?;
    begin(&control, launch).inspect_err(|_| group.kill())?;
    let heard = match hear(&control) {
        Ok(FirstMessage::Begun(loaded)) => return Ok(Launched { loaded, control, exit }),
        Ok(FirstMessage::Refused(reason)) => return Err(LaunchError::Load(reason)),
        heard => heard,
    };
    group.kill();
    let Ok(ended) = exit.blocking_recv() else { return Err(LaunchError::Lost) };
    if events(folder) > before {
        return Ok(Launched { loaded: None, control, exit: known(ended) });
    }
    heard?;
    let said = last_line(&output);
    Err(LaunchError::Ended { exit: ended.to_string(), said })
}

/// Number of events in the run in `folder`. `None` if it has not begun.
fn events(folder: &Path) -> Option<u64> {
    let reader = Reader::open(folder).and_then(|reader| reader.last_sequence());
    has_begun(folder).then(|| reader.unwrap_or_default())
}

/// A receiver with a known exit.
fn known(exit: Exit) -> oneshot::Receiver<Exit> {
    let (ended, receiver) = oneshot::channel();
    // The receiver exists.
    ended.send(exit).unwrap_or_default();
    receiver
}

/// Waits for the exit of a process on a thread, so that no zombie remains.
fn reap(mut child: Child) -> io::Result<oneshot::Receiver<Exit>> {
    let (ended, exit) = oneshot::channel();
    let wait = move || {
        let status = child.wait().unwrap_or_default();
        // The receiver may have been dropped.
        ended.send(Exit(status)).unwrap_or_default();
    };
    thread::Builder::new().name("runner".to_owned()).stack_size(64 * 1024).spawn(wait)?;
    Ok(exit)
}

fn hear(control: &UnixStream) -> Result<FirstMessage, LaunchError> {
    control.set_read_timeout(Some(LOAD_TIMEOUT)).map_err(LaunchError::Silent)?;
    let mut runner = BufReader::new(control);
    let mut hello = String::new();
    if heard(runner.read_line(&mut hello))?.is_none_or(|count| count == 0) {
        return Ok(FirstMessage::Gone);
    }
    decode::<Hello>(&hello)?.check()?;
    let mut content = Vec::new();
    if heard(read_frame(&mut runner, &mut content))?.flatten().is_none() {
        return Ok(FirstMessage::Gone);
    }
    match decode(&String::from_utf8_lossy(&content))? {
        ToViewer::LoadFailed { reason } => Ok(FirstMessage::Refused(reason)),
        ToViewer::Loaded { states, problems, .. } => {
            Ok(FirstMessage::Begun(Some(LoadedMachine { states, problems })))
        }
        _other => Ok(FirstMessage::Begun(None)),
    }
}

/// The result of a read. `None` if the connection broke.
fn heard<T>(read: io::Result<T>) -> Result<Option<T>, LaunchError> {
    match read {
        Ok(read) => Ok(Some(read)),
        Err(error) if is_over_time(&error) => Err(LaunchError::Silent(error)),
        Err(_broken) => Ok(None),
    }
}

fn is_over_time(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}
